"""The error of what follows from several packings, by the jackknife."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import expect, expect_function
from .errors import ParameterError


def jackknife(
    values: Sequence[Any] | NDArray[Any], f: Callable[..., ArrayLike] = np.mean
) -> tuple[Any, Any]:
    """f of all values, and its standard error from leaving out one after another.

        error^2 = (n - 1)/n sum (f_k - mean f)^2,    f_k without value k

    It is right for fits too, whose points share their packings. For a mean it is the standard error
    of the mean.

        fit, error = ld.jackknife(packings, lambda some: np.polyfit(x, mean_of(some), 1))

    Args:
        values: independent of each other, such as packings; two or more.
        f: of a list of values; a number or an array.

    Returns:
        f and its error, of the same shape; the error is nan where one of the f_k is.

    Raises:
        ParameterError: there are fewer than two values, or f is no function.

    Source: Efron and Stein, Ann. Stat. 9, 586 (1981).
    """
    expect_function(f, "of a list of values")
    expect("values", values, Sequence, np.ndarray)
    count = len(values) if np.ndim(values) or isinstance(values, Sequence) else 1
    if count < 2:
        raise ParameterError(f"values must be at least 2 for an error, not {count}")
    without = np.array([f([*values[:n], *values[n + 1 :]]) for n in range(count)], float)
    spread = np.sum((without - without.mean(axis=0)) ** 2, axis=0)
    return np.asarray(f(values), float)[()], np.sqrt((count - 1) / count * spread)

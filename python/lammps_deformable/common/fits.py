"""Fits, and errors of what follows from several packings."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from statistics import linear_regression
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ParameterError

T = TypeVar("T")


def power_law(x: Iterable[float], y: Iterable[float]) -> float:
    """n of y ~ x^n: the slope of log |y| over log x by least squares, with equal weights."""
    log_x, log_y = ([math.log(abs(value)) for value in values] for values in (x, y))
    return linear_regression(log_x, log_y).slope


def jackknife(
    value: Callable[[Sequence[T]], ArrayLike], samples: Sequence[T]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A value of all samples, and its standard error from leaving out one after another.

        error^2 = (n - 1)/n sum (v_k - mean v)^2,    v_k without sample k

    It is right for fits too, whose points share their packings. For a mean it is the standard error
    of the mean.

        fit, error = ld.jackknife(lambda some: np.polyfit(x, mean_of(some), 1), packings)

    Args:
        value: of a sequence of samples; a number or an array.
        samples: independent of each other, such as packings; two or more.

    Returns:
        Value and error, of the same shape; the error is nan where one of the v_k is.

    Raises:
        ParameterError: there are fewer than two samples.

    Source: Efron and Stein, Ann. Stat. 9, 586 (1981).
    """
    count = len(samples)
    if count < 2:
        raise ParameterError(f"samples must be at least 2 for an error, not {count}")
    without = np.array([value([*samples[:n], *samples[n + 1 :]]) for n in range(count)], float)
    spread = np.sum((without - without.mean(axis=0)) ** 2, axis=0)
    return np.asarray(value(samples), float), np.sqrt((count - 1) / count * spread)

"""Arguments that are numbers, or one line that says which is none."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ParameterError


def number_or_nan(value: object) -> float:
    """The value as a float; nan if it is no single number that a float can hold."""
    try:
        array = np.asarray(value)
    except ValueError:  # rows of unequal length
        return math.nan
    return float(array) if array.ndim == 0 and array.dtype.kind in "biuf" else math.nan


def finite(name: str, value: float) -> float:
    """The value, if it is a finite number."""
    number = number_or_nan(value)
    if not math.isfinite(number):
        raise ParameterError(f"{name} must be a finite number, not {shown(value)}")
    return number


def whole(name: str, value: int) -> int:
    """The value, if it is a whole number."""
    number = value if isinstance(value, int) else number_or_nan(value)
    if not number % 1 == 0:
        raise ParameterError(f"{name} must be a whole number, not {shown(value)}")
    return int(number)


def numbers(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """The values as an array, if all of them are finite numbers."""
    try:
        array = np.array(values)
    except ValueError:
        array = np.array(None)
    if array.dtype.kind not in "biuf" or not np.isfinite(array).all():
        raise ParameterError(f"{name} must be finite numbers, not {shown(values)}")
    return array.astype(np.float64)


def shown(value: object) -> str:
    """A value as a message can show it: in one line, and short."""
    line = " ".join(str(value).split())
    return line if len(line) <= 200 else line[:200] + "..."

"""Checks of arguments; their errors name the argument and its value in one line."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import fields
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ParameterError

# Of atoms and of steps in LAMMPS.
LARGEST_COUNT = 2**31 - 1

# An object that takes more letters than these is described by its kind.
_LONG = 60


def as_array(value: object) -> NDArray[Any]:
    """The value as an array; that of None, which has no numbers, if rows have unequal lengths."""
    try:
        return np.asarray(value)
    except ValueError:
        return np.asarray(None)


def number_or_nan(value: object) -> float:
    """The value as a float; nan if it is not a single number, nor is True or False."""
    array = as_array(value)
    return float(array) if array.ndim == 0 and array.dtype.kind in "iuf" else math.nan


def finite(name: str, value: float) -> float:
    """The value, if it is a finite number."""
    number = number_or_nan(value)
    if not math.isfinite(number):
        raise ParameterError(f"{name} must be a finite number, not {shown(value)}")
    return number


def positive(name: str, value: float) -> float:
    """The value, if it is a finite number above zero."""
    number = number_or_nan(value)
    if not 0.0 < number < math.inf:
        raise ParameterError(f"{name} must be a positive number, not {shown(value)}")
    return number


def zero_or_more(name: str, value: float) -> float:
    """The value, if it is a finite number not below zero."""
    number = finite(name, value)
    if number < 0.0:
        raise ParameterError(f"{name} must not be negative, not {shown(value)}")
    return number


def count(name: str, value: int) -> int:
    """The value, if it is a whole number from 1 to the largest that LAMMPS counts to."""
    number = whole(name, value)
    if number < 1:
        raise ParameterError(f"{name} must be at least 1, not {shown(value)}")
    if number > LARGEST_COUNT:
        raise ParameterError(
            f"{name} must be at most {LARGEST_COUNT} in LAMMPS, not {shown(value)}"
        )
    return number


def whole(name: str, value: int) -> int:
    """The value, if it is a whole number."""
    exact = isinstance(value, int) and not isinstance(value, bool)
    number = value if exact else number_or_nan(value)
    if not number % 1 == 0:
        raise ParameterError(f"{name} must be a whole number, not {shown(value)}")
    return int(number)


def numbers(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """The values as an array, if all of them are finite numbers; a mask counts as 0 and 1.

    So `species=radius > 0.5` makes two species.
    """
    if np.ma.is_masked(values):
        raise ParameterError(f"{name} has masked values: fill or leave them out, {shown(values)}")
    array = as_array(values)
    if array.dtype == object and all(isinstance(each, Real) for each in array.flat):
        with suppress(OverflowError):  # of a whole number beyond all floats
            array = array.astype(np.float64)  # such as columns of a table that also has words
    if array.dtype.kind not in "biuf" or not np.isfinite(array).all():
        raise ParameterError(f"{name} must be finite numbers, not {shown(values)}")
    return array.astype(np.float64)


def expect(name: str, value: object, *kinds: type) -> None:
    """Raise an error for an object of another kind."""
    if isinstance(value, kinds):
        return
    found = shown(value)
    if isinstance(value, type):
        found = f"the class {value.__name__} itself: call it, {value.__name__}(...)"
    elif len(found) > _LONG:
        found = f"a {type(value).__name__}"
    if isinstance(getattr(value, "packing", ...), kinds):
        found += ": take its `packing`"
    wanted = " or ".join(kind.__name__ for kind in kinds)
    raise ParameterError(f"{name} must be of the kind {wanted}, not {found}")


def expect_function(f: object, of: str) -> None:
    """Raise a ParameterError if `f` is no function."""
    if not callable(f):
        raise ParameterError(f"f must be a function {of}, not {shown(f)}")


def shown(value: object) -> str:
    """A value for a message: its `repr` in one short line."""
    plain = value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
    line = " ".join(repr(plain).split())
    return line if len(line) <= 200 else line[:200] + "..."


def as_call(value: Any, **defaults: object) -> str:
    """The call that makes an object of a dataclass, without what has its default.

    Args:
        value: the object.
        defaults: those that its fields do not tell.
    """
    words = []
    for field in sorted(fields(value), key=lambda field: field.kw_only is True):
        own = getattr(value, field.name)
        if own != defaults.get(field.name, field.default):
            words.append(f"{field.name}={own!r}")
    return f"{type(value).__name__}({', '.join(words)})"

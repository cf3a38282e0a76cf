"""Directions in which particles propel themselves, as angles in a trajectory or a data file."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..core import unit_vectors

_COLUMN = "direction"


def as_columns(directions: NDArray[np.float64] | None) -> dict[str, NDArray[np.float64]]:
    """A column with the angles of unit vectors, shape (N, 2), to the x axis; none without them."""
    return {} if directions is None else {_COLUMN: np.arctan2(directions[:, 1], directions[:, 0])}


def from_columns(columns: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64] | None:
    """The unit vectors of the columns of a trajectory, shape (N, 2); None without directions."""
    return unit_vectors(columns[_COLUMN]) if _COLUMN in columns else None


def direction_lines(directions: NDArray[np.float64] | None) -> str:
    """Comments at the end of a data file, in the order of IDs; none without directions."""
    angles = as_columns(directions).get(_COLUMN)
    return "" if angles is None else "\n" + "".join(f"# {_COLUMN} {a!r}\n" for a in angles.tolist())


def directions_in(text: str, number: int) -> NDArray[np.float64] | None:
    """The unit vectors in the comments of a data file of so many atoms; None without.

    Raises:
        ValueError: they are damaged.
    """
    angles = re.findall(rf"^# {_COLUMN} (.+)$", text, re.MULTILINE)
    if len(angles) not in (0, number):
        raise ValueError(f"it has directions of {len(angles)} of {number} atoms")
    return from_columns({_COLUMN: np.array(angles, np.float64)} if angles else {})

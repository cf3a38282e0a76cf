"""Directions in which particles propel themselves, as angles in a trajectory."""

from __future__ import annotations

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

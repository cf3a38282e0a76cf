"""Settings of pairs of species: a number for all pairs, or a symmetric matrix."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.validate import shown

ByPair = float | Sequence[Sequence[float]]


def by_pair(name: str, given: object) -> float | tuple[tuple[float, ...], ...]:
    """A number as a float, a symmetric matrix as rows of floats.

    Raises:
        ParameterError: it is neither.
    """
    try:
        values = np.asarray(given)
    except ValueError:  # rows of unequal length
        values = np.asarray(None)
    square = values.ndim == 2 and values.size > 0 and values.shape[0] == values.shape[1]
    if values.dtype.kind not in "iuf" or not (values.ndim == 0 or square):
        raise ParameterError(
            f"{name} must be a number, or a matrix with a row and a column for each species, not "
            f"{shown(given)}"
        )
    if values.ndim == 0:
        return float(values)
    if (odd := np.argwhere((values != values.T) & (values == values))).size:
        i, j = odd[0].tolist()
        raise ParameterError(
            f"{name} must be symmetric, but species {i} and {j} have {values[i, j]:g} and "
            f"{values[j, i]:g}"
        )
    return tuple(tuple(map(float, row)) for row in values)


def pair_matrix(name: str, values: ByPair, species: int) -> NDArray[np.float64]:
    """The value of each pair of so many species, from a result of `by_pair`.

    Raises:
        ParameterError: there is another number of species.
    """
    if isinstance(values, float):
        return np.full((species, species), values)
    if len(values) != species:
        raise ParameterError(
            f"there are {species} species, so the matrix of {name} must have as many rows, not "
            f"{len(values)}"
        )
    return np.array(values)

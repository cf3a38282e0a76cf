"""Adhesion of pairs of species, as a setting of a law: a number for all, or a symmetric matrix."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.errors import ParameterError
from ..common.validate import number_or_nan, shown

Adhesion = float | Sequence[Sequence[float]]


def adhesion_of(given: object) -> float | tuple[tuple[float, ...], ...]:
    """A number as a float, a symmetric matrix as rows of floats.

    Raises:
        ParameterError: it is neither, or a value is no adhesion.
    """
    try:
        values = np.asarray(given)
    except ValueError:  # rows of unequal length
        values = np.asarray(None)
    square = values.ndim == 2 and values.size > 0 and values.shape[0] == values.shape[1]
    if values.dtype.kind not in "iuf" or not (values.ndim == 0 or square):
        raise ParameterError(
            "adhesion must be a number, or a matrix with a row and a column for each species, not "
            f"{shown(given)}"
        )
    for value in values.ravel().tolist():
        _refuse(core.invalid_adhesion(value))
    if values.ndim == 0:
        return float(values)
    if (odd := np.argwhere(values != values.T)).size:
        i, j = odd[0].tolist()
        raise ParameterError(
            f"adhesion must be symmetric, but species {i} and {j} have {values[i, j]:g} and "
            f"{values[j, i]:g}"
        )
    return tuple(tuple(map(float, row)) for row in values)


def matrix_of(adhesion: Adhesion, species: int) -> NDArray[np.float64]:
    """Adhesion of each pair of so many species, from a result of `adhesion_of`.

    Raises:
        ParameterError: there is another number of species.
    """
    if isinstance(adhesion, float):
        return np.full((species, species), adhesion)
    if len(adhesion) != species:
        raise ParameterError(
            f"there are {species} species, so the matrix of adhesion must have as many rows, not "
            f"{len(adhesion)}"
        )
    return np.array(adhesion)


def check_adhesion(adhesion: Adhesion, contact: str, *parameters: NDArray[np.float64]) -> None:
    """Refuse an adhesion that these contacts or these species cannot have.

    Args:
        adhesion: a result of `adhesion_of`.
        contact: the contact lines of `Ring`.
        parameters: kA, kP, skin and tension, one number each or one for each species.

    Raises:
        ParameterError: the contacts are not curved, there is another number of species, or one of
            them has a tension that is too small, an infinite kP, or a skin.
    """
    rows = 1 if isinstance(adhesion, float) else len(adhesion)
    sizes = [values.size for values in parameters]
    matrix = matrix_of(adhesion, max(sizes) if max(sizes) > 1 else rows)
    if (matrix > 0.0).any() and contact != "curved":
        raise ParameterError(
            "adhesion needs contact lines that bend, to meet outlines at an angle: use "
            f"contact='curved', not {contact!r}, or adhesion 0"
        )
    for w, *of_species in np.broadcast(matrix.max(axis=1), *parameters):
        _refuse(core.invalid_for_adhesion(w, *of_species))


def wall_adhesion(kind: str, given: object) -> float:
    """The adhesion of a wall of this kind.

    Raises:
        ParameterError: it is no adhesion.
    """
    value = number_or_nan(given)
    if problem := core.invalid_adhesion(value):
        raise ParameterError(f"{problem} (of a {kind})")
    return value


def _refuse(problem: str | None) -> None:
    """Raise the problem that a rule of `deformable.core` has found, if any."""
    if problem is not None:
        raise ParameterError(problem)

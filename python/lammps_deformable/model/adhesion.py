"""Adhesion of pairs of species, as a setting of a law: a number for all, or a symmetric matrix."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.errors import ParameterError
from ..common.validate import number_or_nan
from .by_pair import ByPair, by_pair, pair_matrix


def adhesion_of(given: object) -> float | tuple[tuple[float, ...], ...]:
    """A number as a float, a symmetric matrix as rows of floats.

    Raises:
        ParameterError: it is neither, or a value is no adhesion.
    """
    adhesion = by_pair("adhesion", given)
    for value in np.ravel(adhesion).tolist():
        _refuse(core.invalid_adhesion(value))
    return adhesion


def check_adhesion(adhesion: ByPair, contact: str, *parameters: NDArray[np.float64]) -> None:
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
    matrix = pair_matrix("adhesion", adhesion, max(sizes) if max(sizes) > 1 else rows)
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
    """Raise the problem that a rule of `ld.core` has found, if any."""
    if problem is not None:
        raise ParameterError(problem)

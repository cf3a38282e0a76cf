"""Outlines of rings and sectors, and lines parallel to them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..common.checks import count, numbers
from ..common.errors import ParameterError
from ..particles.laws import Ring, Sector, refuse_adhesion

if TYPE_CHECKING:
    from .state import State

Floats = NDArray[np.float64]


def parallels(state: State, inset: Floats | None, points: int, same_area: bool) -> list[Floats]:
    """See `State._parallels`."""
    packing, law = state.packing, state.law
    assert isinstance(law, Ring | Sector)
    inset = np.zeros(len(packing)) if inset is None else numbers("inset", inset)
    if inset.shape != (len(packing),):
        raise ParameterError(f"inset must have shape ({len(packing)},), not {inset.shape}")
    count("points", points)
    if inset.any():
        why = ", and a line parallel to an outline does not end where a film does"
        refuse_adhesion(law, packing.walls, why)
    lines = ("force", "half_angle", "contact_angle") if law.name == "curved" else ()
    return [
        law.outline(
            kind,
            radius,
            rows["angle"],
            rows["indentation"],
            distance,
            points,
            same_area,
            **{name: rows[name] for name in lines},
        )
        for kind, radius, distance, rows in zip(
            packing.species, packing.radii, inset, state._contacts_of_each, strict=True
        )
    ]

"""The contact laws that stand for bead polygons, and how far two packings are from each other."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .box import cartesian, fractional
from .contacts import without_rattlers
from .laws import Law, Ring, Sector
from .state import PolygonState, State

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .packing import Packing
    from .polygons import PolygonModel, Polygons

# A packing with less than this part of the beads' pressure has lost its rigidity.
_UNJAMMED = 1e-6


def matching_laws(
    model: PolygonModel, polygons: Polygons, rigid: Sequence[bool] = ()
) -> dict[str, Law]:
    """The contact laws for such polygons, by name.

    `radical`, `balanced` and `curved` have the polygons' own stiffness kP = kL/N_v, and their beads
    as a rigid skin. `radical, kP inf` conserves perimeters, as the paper does. `sector`, which has
    a single kA, is left out if the kA of the species differ.

    Args:
        model: of the polygons.
        polygons: the undeformed ones.
        rigid: species whose polygons stand for inextensible ones. If there are any,
            `balanced, kP inf` has kP = inf for them.
    """
    kA, kP, skin = model.kA, polygons.kP.tolist(), polygons.skin.tolist()
    found: dict[str, Law] = {}
    if len(set(polygons.kA)) == 1:
        found["sector"] = Sector(polygons.kA[0])
    found |= {
        "radical, kP inf": Ring(kA, contact="radical"),
        "radical": Ring(kA, kP=kP, skin=skin, contact="radical"),
        "balanced": Ring(kA, kP=kP, skin=skin, contact="balanced"),
        "curved": Ring(kA, kP=kP, skin=skin, contact="curved"),
    }
    if any(rigid):
        kP = np.where(rigid, math.inf, kP).tolist()
        found["balanced, kP inf"] = Ring(kA, kP=kP, skin=skin, contact="balanced")
    return found


def matching(packing: Packing, model: PolygonModel) -> Packing:
    """The packing with other radii, such that the polygons have its own radii as effective ones."""
    radii = packing.radii
    for _ in range(10):  # the roughness hardly depends on the radius: each step gains two digits
        radii = radii + packing.radii - model.polygons(radii).effective_radius
    return replace(packing, radii=radii)


def is_unjammed(own: State | PolygonState, exact: PolygonState) -> bool:
    """Whether a packing has lost its rigidity: it has less than 1e-6 of the polygons' pressure."""
    return own.pressure <= _UNJAMMED * exact.pressure


def finite_ratio(ratio: float) -> float | None:
    """None for a ratio to polygons without load: JSON has no infinity."""
    return ratio if math.isfinite(ratio) else None


def centers_rms(exact: PolygonState, own: State | PolygonState) -> float | None:
    """Root mean square distance of the centers over the mean radius; None if one is unjammed.

    Particles that are rattlers in one of the two do not count. A common drift is subtracted.
    """
    if is_unjammed(own, exact):
        return None
    return _rms(exact.packing, own.packing, _held(exact) & _held(own))


def _held(state: State | PolygonState) -> NDArray[np.bool_]:
    """Particles that are no rattlers."""
    if isinstance(state, State):
        return ~state.rattlers
    i, j = state.contact_table.i, state.contact_table.j
    i, j = np.concatenate([i, j]), np.concatenate([j, i])
    count = len(state.packing)
    return np.bincount(i[without_rattlers(i, j, count)], minlength=count) > 0


def _rms(a: Packing, b: Packing, held: NDArray[np.bool_]) -> float | None:
    if not held.any():
        return None
    apart = fractional((b.positions - a.positions)[held], b.box)
    apart -= apart[0]  # then the nearest image does not depend on the drift
    apart = cartesian(apart - np.rint(apart), b.box)
    apart -= apart.mean(axis=0)
    return float(np.sqrt(np.mean(np.sum(apart**2, axis=1))) / b.radius.mean())

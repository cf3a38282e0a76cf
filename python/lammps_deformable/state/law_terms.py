"""Tables of the parameters of each law, see `terms`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..core import disk_blocks
from ..particles.laws import Ring, SoftContact
from .contacts import by_centers, by_strains
from .droplet_terms import of_droplets
from .hessian import balanced, bearing_soft, lines_of
from .terms import Blocks, Terms, diagonal, sparse, volumes_of_radii, with_places

if TYPE_CHECKING:
    from ..particles.packing import Packing
    from .state import State

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def terms_of(state: State) -> Terms:
    """Of a state at rest, without contacts of rattlers."""
    if isinstance(state.law, SoftContact):
        return _of_soft_contacts(state, state.law)
    return (
        _of_rings(state, state.law) if state.law.dimension == 2 else of_droplets(state, state.law)
    )


# Parameters of a particle as local variables of `core.ring_blocks`, after those of its sides.
_OF_RING = ("radii", "kA", "kP", "skin", "tension", "area")
_OF_SIDE, _SHIFT, _DIRECTION = 5, 2, 3


def _of_rings(state: State, law: Ring) -> Terms:
    """Lines that are balanced to rounding, and parameters of rings.

    Shift and direction of a side move its line at given places: by the shift its derivative is the
    force, by the area A0 of a particle it is the pressure.
    """
    lines = balanced(lines_of(state.packing, law, state.contacts, rattlers=False))
    packing, sides = lines.packing, lines.sides
    number, count, each = len(packing), len(sides.i), np.arange(len(packing))
    blocks = Blocks.of(lines.blocks(parameters=True))
    own = _OF_SIDE * np.cumsum(np.bincount(sides.i, minlength=number)) + len(_OF_RING) * each
    of = {name: own + n for n, name in enumerate(_OF_RING)}
    first = _OF_SIDE * np.arange(count) + len(_OF_RING) * sides.i
    place = (first[:, None] + np.arange(_OF_SIDE)).ravel()
    placed = sparse(1.0, place, np.arange(len(place)), (len(blocks.gradient), len(place)))
    chain, strains = placed @ lines.chain(_OF_SIDE), placed @ by_strains(sides, _OF_SIDE)
    terms = Terms.of(packing, blocks, chain.tocsr(), strains, sides, first)
    g, shift = terms.gradient, first + _SHIFT
    terms.forces = g[shift]

    kA, kP, skin, tension = law.species_parameters(packing.species_radii).of(packing.species)
    for name in ("kA", "kP", "skin", "tension"):
        if name != "tension" or np.isfinite(kP).all():
            terms.parameter(name, (number,), terms.by_local(1.0, of[name], each, number))
    _radii_of_rings(terms, packing, law, of["radii"], shift)

    # with r = R - skin, D = (p - tension/r)/kA and P = 2 pi r + U_tension - D/r the volume is
    # pi r^2 - D + skin P + pi skin^2
    r = packing.radii - skin
    deficit, outer = (g[of["area"]] - tension / r) / kA, 1.0 + skin / r
    by_r = 2.0 * np.pi * packing.radii - outer * tension / (r**2 * kA) + skin * deficit / r**2
    explicit = {
        "radii": by_r,
        "skin": 2.0 * np.pi * packing.radii + g[of["tension"]] - deficit / r - by_r,
        "kA": outer * deficit / kA,
        "tension": outer / (r * kA),
    }
    volume = terms.of_local(-outer / kA, each, of["area"], number)
    volume += terms.of_local(skin, each, of["tension"], number)
    diagonals = {name: diagonal(values) for name, values in explicit.items()}
    terms.quantity("volumes", (number,), volume, explicit=diagonals)
    terms.quantity("pressures", (number,), terms.of_local(1.0, each, of["area"], number))
    force = terms.of_local(1.0, np.arange(count), shift, count)
    return with_places(state, terms, force=(force, None), angles=first[:, None] + _DIRECTION)


def _radii_of_rings(
    terms: Terms, packing: Packing, law: Ring, ring: Integers, shift: Integers
) -> None:
    """Radii change rings, at given indentations, and the indentations by lines at given places.

    These are (R_i + R_j - d)/2, at a wall R - h, and from a radical axis R_i - (d^2 + R_i^2 -
    R_j^2)/(2 d), where the change depends on d.

    Args:
        terms: to which they are added.
        packing: the particles.
        law: of them.
        ring: local variable of each particle, shape (N,).
        shift: of each side, shape (S,).
    """
    sides, number, radius = terms.sides, len(packing), packing.radii
    pair, wall = np.flatnonzero(sides.j >= 0), np.flatnonzero(sides.j < 0)
    i, j, d = sides.i[pair], sides.j[pair], sides.distance[pair]
    of_i: Any = 0.5
    of_j: Any = 0.5
    explicit = None
    if law.contact == "radical":
        of_i, of_j = 1.0 - radius[i] / d, radius[j] / d
        steep = (terms.gradient[shift[pair]] / d**3)[:, None] * sides.vector[pair]
        explicit = sum(
            terms.by_local(r[:, None] * steep, terms.vectors[pair], k[:, None], number)
            for r, k in ((radius[i], i), (-radius[j], j))
        )
    local = terms.by_local(1.0, ring, np.arange(number), number)
    local += terms.by_local(of_i, shift[pair], i, number)
    local += terms.by_local(of_j, shift[pair], j, number)
    local += terms.by_local(1.0, shift[wall], sides.i[wall], number)
    terms.parameter("radii", (number,), local, explicit)


def _of_soft_contacts(state: State, law: SoftContact) -> Terms:
    """k o^2/2 of each contact; the derivative by its length is the force."""
    packing = state.packing
    sides, contact, kept = bearing_soft(packing)
    sides, contact = sides.part(kept), contact[kept]
    number, count, variables = len(packing), len(sides.i), packing.dimension + 1
    unit = disk_blocks(sides.vector, sides.turn, contact, sides.axis)
    first = variables * np.arange(count)
    chain, strains = by_centers(sides, number, variables), by_strains(sides, variables)
    terms = Terms.of(packing, Blocks.of(unit, law.k), chain, strains, sides, first)
    length, pair = first + packing.dimension, np.flatnonzero(sides.j >= 0)
    terms.forces = terms.gradient[length]
    by_radii = terms.by_local(1.0, length, sides.i, number)
    by_radii += terms.by_local(1.0, length[pair], sides.j[pair], number)
    terms.parameter("radii", (number,), by_radii)
    explicit = terms.by_local(unit.gradient, np.arange(len(unit.gradient)), 0, 1)
    terms.parameter("k", (), explicit=explicit, energy=unit.energy)
    volumes_of_radii(packing, terms)
    force = terms.of_local(1.0, np.arange(count), length, count)
    return with_places(state, terms, force=(force, None))

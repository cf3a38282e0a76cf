"""Second derivatives of the energy of a state, by the contacts of its law.

Modes, moduli and Newton's method ask for them, see `Hessian`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .contacts import (
    Sides,
    bearing,
    between,
    by_centers,
    by_lines,
    by_strains,
    other_side,
    soft_sides,
)
from .core import EnergyBlocks, disk_blocks, droplet_blocks
from .errors import ParameterError, UndefinedError
from .hessian import Floats, Hessian, balanced, lines_of, rattler_contacts
from .laws import Droplet, Ring, Sector, SoftContact

if TYPE_CHECKING:
    from .packing import Packing
    from .state import State


# Forces that remain in a state at rest, over the mean contact force. Ten times larger ones still
# change contacts, and with them moduli by several percent of the bulk modulus.
_AT_REST = 1e-3


def check_at_rest(residual: float) -> None:
    """Refuse what has no meaning where forces are left.

    Raises:
        ParameterError: they are above 1e-3 of the mean contact force.
    """
    if residual > _AT_REST:
        raise ParameterError(
            f"the state is not at rest: its largest force is {residual:.2g} of the mean "
            "contact force; relax it first"
        )


def hessian_of(state: State, rattlers: bool = True) -> Hessian:
    """See `State.hessian`."""
    if isinstance(state.law, SoftContact):
        return _of_soft_contacts(state.packing, state.law, rattlers)
    if isinstance(state.law, Droplet):
        return _of_droplets(state, state.law, rattlers)
    if not isinstance(state.law, Ring | Sector):
        raise UndefinedError("polygons have no second derivatives here: take a Ring")
    if state.unsaved:
        raise ParameterError(
            f"second derivatives do not know the {state.unsaved} that were given to lmp"
        )
    if state.friction:
        raise ParameterError("friction has no energy, and so no second derivatives of one")
    return balanced(lines_of(state.packing, state.law, state.contacts, rattlers)).hessian()


def at_rest(state: State) -> Hessian:
    """The matrix without rattlers, of a state at rest."""
    hessian = hessian_of(state, rattlers=False)
    check_at_rest(state.residual)
    return hessian


def open_contacts(state: State) -> tuple[Sides, Floats]:
    """Contacts that `hessian_of` without rattlers leaves out, and lengths by which they open.

    Returns:
        Sides of S contacts, and distances (S,) by which they are to become longer [length].
    """
    if not isinstance(state.law, SoftContact):
        return rattler_contacts(state.packing, state.contacts)
    sides, contact, kept = _bearing(state.packing)
    return sides.part(~kept), (contact - sides.distance)[~kept]


def _bearing(packing: Packing) -> tuple[Sides, Floats, NDArray[np.bool_]]:
    """Soft contacts, the distances at which they open, and whether they bear, all of them once."""
    sides, contact = soft_sides(packing)
    overlap, count = contact - sides.distance, int(np.sum(sides.j >= 0))
    both = np.append(overlap, overlap[:count])
    ends = np.append(sides.i, sides.j[:count]), np.append(sides.j, sides.i[:count])
    kept = bearing(*ends, both, len(packing), packing.dimension)
    return sides, contact, kept[: len(contact)]


class _Scaled:
    """Energy of contacts of stiffness 1, and its derivatives, times a stiffness."""

    def __init__(self, blocks: EnergyBlocks, k: float) -> None:
        self.energy, self.gradient = k * blocks.energy, k * blocks.gradient
        self._blocks, self._k = blocks, k

    def hessian(self) -> tuple[NDArray[np.int32], NDArray[np.int32], Floats]:
        row, column, value = self._blocks.hessian()
        return row, column, self._k * value


def _of_soft_contacts(packing: Packing, law: SoftContact, rattlers: bool) -> Hessian:
    """Each contact adds k (n n^T - (o/d) (1 - n n^T)) for its direction n and overlap o."""
    sides, contact, kept = _bearing(packing)
    if not rattlers:
        sides, contact = sides.part(kept), contact[kept]
    if np.isnan(sides.turn).any():
        raise ParameterError(
            "second derivatives of soft spheres do not know cylinders, cones and posts: take "
            "other walls, or a state in which none touches one"
        )
    blocks: Any = _Scaled(disk_blocks(sides.vector, sides.turn, contact), law.k)
    return Hessian(packing, blocks, by_centers(sides, len(packing)), by_strains(sides))


# Local variables of a side of a droplet, the vector and the shift of its facet; how the shift is
# seen from the other side; and the part of a change of the distance that a facet takes.
_VARIABLES, _OTHER_SIDE, _SHARE = 4, (-1.0,), 0.5


def _of_droplets(state: State, law: Droplet, rattlers: bool) -> Hessian:
    packing, table = state.packing, state.contacts
    if (table["j"] < 0).any():
        raise ParameterError(
            "second derivatives of droplets do not know walls: take a state of a periodic box "
            "without them"
        )
    if not rattlers:
        force = table["force"]
        kept = bearing(table["i"], table["j"], force, len(packing), packing.dimension)
        table = table[kept | kept[other_side(table)]]
    sides = between(table["i"], table["j"], table["distance"][:, None] * table["normal"])
    tension = law.species_parameters(packing._species_radii).of(packing.species).tension
    number = np.bincount(sides.i, minlength=len(packing))
    droplets = np.column_stack([number, packing.radii, tension])
    rows = [sides.vector, sides.turn, np.full(len(table), _SHARE), table["force"]]
    try:
        blocks = droplet_blocks(droplets, np.column_stack(rows))
    except ValueError as error:
        raise ParameterError(str(error)) from None
    from scipy.sparse import hstack

    facets = by_lines(other_side(table), _VARIABLES, _OTHER_SIDE)
    chain = hstack([by_centers(sides, len(packing), _VARIABLES), *facets], format="csr")
    return Hessian(packing, blocks, chain, by_strains(sides, _VARIABLES))

"""Second derivatives of the energy of a state, and the linear systems that follow from them.

`hessian_of` makes them from the contacts of the law of a state. Rings have the places of their
contact lines as further variables. Modes, moduli and Newton's method ask for them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.errors import ParameterError, UndefinedError
from ..core import (
    EnergyBlocks,
    RingBlocks,
    curved_blocks,
    disk_blocks,
    ring_blocks,
)
from ..particles.laws import (
    Droplet,
    Law,
    Ring,
    Sector,
    SoftContact,
    refuse_adhesion,
)
from ..particles.walls import SurfaceWall
from .contacts import (
    ContactTable,
    Sides,
    bearing,
    bears,
    between,
    by_centers,
    by_lines,
    by_strains,
    joined,
    other_side,
    soft_sides,
    with_walls,
)
from .droplet_hessian import contacts_of_droplets
from .hessian_matrix import Hessian, factored

if TYPE_CHECKING:
    from ..particles.packing import Packing
    from .state import State


Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Local variables of a side: the vector, then shift, direction and curvature of its line.
_VARIABLES = {"radical": 2, "balanced": 3, "curved": 5}

# How those of the other side of a contact change.
_OTHER_SIDE = (-1.0, 1.0, -1.0)

# Lines are balanced once the forces of their sides agree to this part of the largest force, or to
# the second one if rounding does not let them come closer. A state of LAMMPS comes with 1e-8, so
# that Newton's method needs two steps.
_BALANCED, _ROUNDING, _STEPS = 1e-14, 1e-9, 20
_TINY = float(np.finfo(float).tiny)

# How close to its largest tilt or half angle a line counts as held there [rad].
_CLOSE = 1e-6


@dataclass
class Lines:
    """Contacts of a packing of rings, and the places of their lines.

    Attributes:
        packing: the particles.
        law: a ring law.
        sides: both sides of each contact, sorted by particle.
        other: the other side of each, -1 for walls, shape (S,).
        shift: of each side's line, shape (S,) [length].
        direction: of each side's line, shape (S,) [rad].
        half_angle: of each side's line, shape (S,) [rad].
        force: of each side, shape (S,) [energy/length].
    """

    packing: Packing
    law: Ring
    sides: Sides
    other: Integers
    shift: Floats
    direction: Floats
    half_angle: Floats
    force: Floats

    @property
    def first(self) -> Integers:
        """One side of each contact between particles, shape (M,)."""
        return np.flatnonzero(self.other > np.arange(len(self.other)))

    def blocks(self, parameters: bool = False) -> RingBlocks:
        """Energy and derivatives by the local variables of the sides, and by parameters."""
        packing, radius = self.packing, self.packing.radii
        number = np.bincount(self.sides.i, minlength=len(packing))
        material = self.law.species_parameters(packing.species_radii).of(packing.species)
        particles = np.column_stack([number, radius, *material])
        partner = np.where(self.sides.j < 0, 0.0, radius[np.maximum(self.sides.j, 0)])
        sides = [self.sides.vector, self.sides.turn, partner]
        if self.law.contact == "curved":
            sides += [self.force, self.direction, self.half_angle]
            return curved_blocks(particles, np.column_stack(sides), parameters)
        sides = [*sides, self.shift]
        return ring_blocks(self.law.contact, particles, np.column_stack(sides), parameters)

    @property
    def variables(self) -> int:
        """Number of local variables of a side."""
        return _VARIABLES[self.law.contact]

    def chain(self, variables: int | None = None) -> Any:
        """Derivatives of the local variables by centers and places of lines, sparse.

        Args:
            variables: number of local variables of a side, `variables` if not given.
        """
        from scipy.sparse import hstack

        variables = variables or self.variables
        centers = by_centers(self.sides, len(self.packing), variables)
        lines = by_lines(self.other, variables, _OTHER_SIDE[: self.variables - 2])
        return hstack([centers, *lines], format="csr")

    def part(self, kept: NDArray[np.bool_]) -> Lines:
        """Some of the sides, both or none of a contact."""
        place = np.cumsum(kept) - 1
        other = np.where(self.other < 0, -1, place[self.other])[kept]
        return Lines(
            self.packing,
            self.law,
            self.sides.part(kept),
            other,
            self.shift[kept],
            self.direction[kept],
            self.half_angle[kept],
            self.force[kept],
        )

    def hessian(self) -> Hessian:
        """At these places of the lines."""
        strains = by_strains(self.sides, self.variables)
        return Hessian(self.packing, self.blocks(), self.chain(), strains)


def lines_of(packing: Packing, law: Law, table: ContactTable, rattlers: bool = True) -> Lines:
    """The active contacts of a state, and the walls that its outlines may reach.

    Args:
        packing: of the state.
        law: of the state.
        table: its contacts.
        rattlers: False leaves out the contacts of rattlers, see `State.hessian`.

    Raises:
        ParameterError: the law is `Sector`, particles stick, or a line is held at the largest tilt
            or curvature.
    """
    refuse_adhesion(law, packing.walls, ", and second derivatives of curved films are not known")
    if not isinstance(law, Ring):
        raise ParameterError(
            "second derivatives need a ring law: the energy of the law sector jumps where contacts "
            "appear"
        )
    if not rattlers:
        table = table[bears(packing, table)]
    pairs = table[table["j"] >= 0]
    x = packing.positions
    vector = x[pairs["j"]] + pairs["image"] @ packing.box - x[pairs["i"]]
    walls = with_walls(packing, law.reach)
    if not rattlers:
        touching = np.isin(walls.i, table["i"][table["j"] < 0])
        walls = walls.part(touching)
    sides = joined(between(pairs["i"], pairs["j"], vector), walls)
    count, radius = len(pairs), packing.radii
    other = np.full(len(sides.i), -1)
    other[:count] = other_side(pairs)
    tilt, bend = pairs["tilt"], pairs["half_angle"]
    held = np.abs(tilt) > core.largest_tilt - _CLOSE
    held |= np.abs(bend) > core.largest_half_angle - _CLOSE
    if held.any():
        i = int(pairs["i"][held][0])
        raise ParameterError(
            f"a contact line of particle {i} is held at the largest tilt, {core.largest_tilt:g} "
            "rad, or the largest half angle, pi/6, where the energy has no second derivatives"
        )
    middle = radius[pairs["i"]] + radius[pairs["j"]] - np.hypot(*vector.T) * np.cos(tilt)
    shift, direction, half_angle, force = np.zeros((4, len(sides.i)))
    moved = pairs["indentation"] - 0.5 * middle
    if law.contact != "radical":  # whose lines are where they are
        shift[:count] = 0.5 * (moved - moved[other[:count]])
    direction[:count] = np.arctan2(*vector.T[::-1]) + tilt
    half_angle[:count], force[:count] = bend, pairs["force"]
    force[count:] = _wall_forces(table, sides.part(np.arange(count, len(sides.i))))
    order = np.argsort(sides.i, kind="stable")
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    other = np.where(other < 0, -1, place[other])[order]
    places = (values[order] for values in (shift, direction, half_angle, force))
    return Lines(packing, law, sides.part(order), other, *places)


def balanced(lines: Lines) -> Lines:
    """The same contacts with lines where the forces of their sides agree to rounding.

    LAMMPS balances them to a tolerance. Contacts that bear nothing there are left out. Curved lines
    stay as they are.

    Raises:
        ParameterError: the lines do not come to rest.
    """
    from scipy.sparse import csr_matrix

    if lines.law.contact == "curved":
        return lines
    before = np.inf
    for _ in range(_STEPS):
        blocks = lines.blocks()
        force = np.array(blocks.force)
        bears = (lines.sides.j < 0) | (force > 0.0)
        if lines.variables > 2:
            bears &= bears[lines.other] | (lines.other < 0)
        else:
            bears |= bears[lines.other] & (lines.other >= 0)
        if not bears.all():
            lines, before = lines.part(bears), np.inf
            continue
        chain = lines.chain()[:, 2 * len(lines.packing) :]
        gradient = chain.T @ blocks.gradient
        largest = np.abs(gradient).max(initial=0.0) / max(force.max(initial=0.0), _TINY)
        if largest <= _BALANCED or _ROUNDING > largest >= 0.5 * before:
            return lines
        before = largest
        row, column, value = blocks.hessian()
        local = csr_matrix((value, (row, column)), shape=(chain.shape[0], chain.shape[0]))
        step, first = factored(chain.T @ local @ chain)(gradient), lines.first
        lines.shift[first] -= step
        lines.shift[lines.other[first]] += step
    raise ParameterError("the contact lines of this state do not balance: relax it first")


def rattler_contacts(packing: Packing, table: ContactTable) -> tuple[Sides, Floats]:
    """Contacts of rattlers, and lengths by which they open, see `open_contacts`.

    A contact of the length L indents its outline by G(0) L at most, see `core.ring`.
    """
    table = table[~bears(packing, table)]
    out = np.column_stack([np.cos(table["angle"]), np.sin(table["angle"])])
    length = table["length"].copy()
    pair = np.flatnonzero(table["j"] >= 0)
    length[pair] += length[pair[other_side(table[pair])]]
    return between(
        table["i"], table["j"], out * table["distance"][:, None]
    ), core.green_at_zero * length


def _wall_forces(table: ContactTable, walls: Sides) -> Floats:
    """The force of each side with a wall, 0 where the table has no contact."""
    rows = table[table["j"] < 0]
    force = np.zeros(len(walls.i))
    angle = np.arctan2(*walls.vector.T[::-1])
    for row in rows:
        at = np.flatnonzero(walls.i == row["i"])
        turned = np.remainder(angle[at] - row["angle"] + np.pi, 2.0 * np.pi) - np.pi
        farther = walls.distance[at] / row["distance"] - 1.0
        force[at[np.argmin(np.hypot(turned, farther))]] = row["force"]
    return force


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


def check_smooth(state: State) -> None:
    """Refuse states whose energy has no second derivatives.

    Raises:
        UndefinedError: of polygons.
        ParameterError: they rub, have a `SurfaceWall`, or commands to `lmp` act on contacts.
    """
    if not isinstance(state.law, SoftContact | Ring | Sector | Droplet):
        raise UndefinedError("polygons have no second derivatives here: take a Ring")
    if state.unsaved:
        raise ParameterError(
            f"second derivatives do not know the {state.unsaved} that were given to lmp"
        )
    surfaces = [isinstance(wall, SurfaceWall) for wall in state.packing.walls]
    if any(surfaces):
        raise ParameterError(
            f"wall {surfaces.index(True) + 1} is a SurfaceWall, of which second derivatives are "
            "not known: take planes, polygons or round walls"
        )
    if state.friction:
        raise ParameterError("friction has no energy, and so no second derivatives of one")


def hessian_of(state: State, rattlers: bool = True) -> Hessian:
    """See `State.hessian`."""
    check_smooth(state)
    if isinstance(state.law, SoftContact):
        return _of_soft_contacts(state.packing, state.law, rattlers)
    if isinstance(state.law, Droplet):
        return contacts_of_droplets(state, state.law, rattlers).hessian()
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
    sides, contact, kept = bearing_soft(state.packing)
    return sides.part(~kept), (contact - sides.distance)[~kept]


def bearing_soft(packing: Packing) -> tuple[Sides, Floats, NDArray[np.bool_]]:
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
    """Each contact adds k (n n^T - o dn/dv) for its direction n, vector v and overlap o."""
    sides, contact, kept = bearing_soft(packing)
    if not rattlers:
        sides, contact = sides.part(kept), contact[kept]
    blocks = _Scaled(disk_blocks(sides.vector, sides.turn, contact, sides.axis), law.k)
    variables = packing.dimension + 1
    chain = by_centers(sides, len(packing), variables)
    return Hessian(packing, blocks, chain, by_strains(sides, variables))

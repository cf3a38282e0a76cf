"""Contacts of a state of the ring laws, with the places of their lines as variables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.factored import factored
from ..core import RingBlocks, curved_blocks, ring_blocks
from ..model.laws import Law, Ring
from ..model.packing import Packing
from ..model.sticking import refuse_adhesion
from .contact_table import ContactTable
from .hessian import Hessian
from .sides import (
    Sides,
    bearing,
    between,
    by_centers,
    by_lines,
    by_strains,
    joined,
    other_sides,
    with_walls,
)

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

# G(0), the indentation over the length of a contact alone.
_GREEN = 0.75 / np.pi

# Largest tilt and half angle of a line, and how close to them a line counts as held there [rad].
_LARGEST_TILT, _LARGEST_HALF_ANGLE, _CLOSE = 0.3, np.pi / 6.0, 1e-6


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

    def blocks(self) -> RingBlocks:
        """Energy and derivatives by the local variables of the sides."""
        packing, radius = self.packing, self.packing.radius
        number = np.bincount(self.sides.i, minlength=len(packing))
        material = self.law.species_parameters(packing.radii).of(packing.species)
        particles = np.column_stack(
            [number, radius, material.kA, material.kP, material.skin, material.tension]
        )
        partner = np.where(self.sides.j < 0, 0.0, radius[self.sides.j])
        sides = [self.sides.vector, self.sides.turn, partner]
        if self.law.contact == "curved":
            sides += [self.force, self.direction, self.half_angle]
            return curved_blocks(particles, np.column_stack(sides))
        return ring_blocks(self.law.contact, particles, np.column_stack([*sides, self.shift]))

    @property
    def variables(self) -> int:
        """Number of local variables of a side."""
        return _VARIABLES[self.law.contact]

    def chain(self) -> Any:
        """Derivatives of the local variables by centers and places of lines, sparse."""
        from scipy.sparse import hstack

        variables = self.variables
        centers = by_centers(self.sides, len(self.packing), variables)
        lines = by_lines(self.other, variables, _OTHER_SIDE[: variables - 2])
        return hstack([centers, *lines], format="csr")

    def move(self, step: Floats) -> None:
        """Move the lines by a step of shifts."""
        first = self.first
        self.shift[first] += step
        self.shift[self.other[first]] -= step

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
        rattlers: False leaves out the contacts of rattlers, see `SoftResponse.hessian`.

    Raises:
        ParameterError: the law is `Sector`, particles stick, or a line is held at the largest tilt
            or curvature.
    """
    refuse_adhesion(law, packing.walls, ", and second derivatives of films are not known")
    if not isinstance(law, Ring):
        raise ParameterError(
            "second derivatives need a ring law: the energy of the law sector jumps where contacts "
            "appear"
        )
    if not rattlers:
        table = table[_bearing(packing, table)]
    pairs = table[table["j"] >= 0]
    x = packing.positions
    vector = x[pairs["j"]] + pairs["image"] @ packing.box - x[pairs["i"]]
    walls = with_walls(packing, law.reach)
    if not rattlers:
        touching = np.isin(walls.i, table["i"][table["j"] < 0])
        walls = walls.part(touching)
    sides = joined(between(pairs["i"], pairs["j"], vector), walls)
    count, radius = len(pairs), packing.radius
    other = np.full(len(sides.i), -1)
    other[:count] = other_sides(pairs)
    tilt, bend = pairs["tilt"], pairs["half_angle"]
    held = (np.abs(tilt) > _LARGEST_TILT - _CLOSE) | (np.abs(bend) > _LARGEST_HALF_ANGLE - _CLOSE)
    if held.any():
        i = int(pairs["i"][held][0])
        raise ParameterError(
            f"a contact line of particle {i} is held at the largest tilt, {_LARGEST_TILT} rad, or "
            "the largest half angle, pi/6, where the energy has no second derivatives"
        )
    middle = radius[pairs["i"]] + radius[pairs["j"]] - np.hypot(*vector.T) * np.cos(tilt)
    shift, direction, half_angle, force = np.zeros((4, len(sides.i)))
    moved = pairs["indentation"] - 0.5 * middle
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
        lines.move(-factored(chain.T @ local @ chain)(gradient))
    raise ParameterError("the contact lines of this state do not balance: relax it first")


def rattler_contacts(packing: Packing, table: ContactTable) -> tuple[Sides, Floats]:
    """See `RingResponse.rattler_contacts`.

    A contact of the length L indents its outline by G(0) L at most, see `core.ring`.
    """
    table = table[~_bearing(packing, table)]
    out = np.column_stack([np.cos(table["angle"]), np.sin(table["angle"])])
    length = table["length"].copy()
    pair = np.flatnonzero(table["j"] >= 0)
    length[pair] += length[pair[other_sides(table[pair])]]
    return between(table["i"], table["j"], out * table["distance"][:, None]), _GREEN * length


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


def _bearing(packing: Packing, table: ContactTable) -> NDArray[np.bool_]:
    """See `bearing`; both sides of a contact do, if one does."""
    kept = bearing(table["i"], table["j"], table["force"], len(packing))
    pair = np.flatnonzero(table["j"] >= 0)
    kept[pair] |= kept[pair[other_sides(table[pair])]]
    return kept

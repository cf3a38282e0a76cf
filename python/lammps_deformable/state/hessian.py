"""Second derivatives of the energy of a state, and the linear systems that follow from them.

`hessian_of` makes them from the contacts of the law of a state. Rings have the places of their
contact lines as further variables. Modes, moduli and Newton's method ask for them. Factors of
sparse matrices have the same last digits on every processor.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import core
from ..common.checks import numbers
from ..common.errors import ParameterError, UndefinedError
from ..core import (
    EnergyBlocks,
    RingBlocks,
    cap_blocks,
    curved_blocks,
    disk_blocks,
    droplet_blocks,
    droplet_facets,
    film_angles,
    ring_blocks,
    stretch_blocks,
)
from ..particles.containers import free_room
from ..particles.laws import (
    Droplet,
    Law,
    Ring,
    Sector,
    SoftContact,
    pair_matrix,
    refuse_adhesion,
)
from .contacts import (
    ContactTable,
    Sides,
    at_walls,
    bearing,
    between,
    by_centers,
    by_lines,
    by_strains,
    joined,
    motions,
    other_side,
    soft_sides,
    with_walls,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..particles.packing import Packing
    from .state import State


Floats = NDArray[np.float64]


def factored(matrix: Any) -> Callable[[Floats], Floats]:
    """Product with the inverse of a sparse symmetric matrix, by QDLDL.

    It adds in one order everywhere. SuperLU does not: it calls the kernels of linear algebra that
    are made for each processor.

    Args:
        matrix: of `scipy.sparse`, shape (n, n).

    Returns:
        A function of right sides, shape (n,) or (n, k).

    Raises:
        RuntimeError: a pivot is zero: the matrix is singular, or needs exchanges of rows.
    """
    import qdldl
    from scipy.sparse import triu

    solve: Callable[[Floats], Floats] = qdldl.Solver(triu(matrix, format="csc"), upper=True).solve

    def product(right: Floats) -> Floats:
        if right.ndim == 1:
            return solve(right)
        return np.stack([solve(column) for column in right.T], axis=1)

    return product


# Stiffness that is added to all centers before a factorization, in mean diagonal entries: motions
# without a stiffness would make the matrix singular. Corrections remove its effect.
_SHIFT = 1e-9

# Corrections of a solution, and the part of the forces that may remain.
_CORRECTIONS, _REMAINDER = 20, 1e-13


class Hessian:
    """Second derivatives of the energy of a packing by the coordinates of its centers.

    The lines of `balanced` and `curved` contacts follow the centers, and so do the forces of
    droplets in three dimensions, which are called lines here too. The energy is stationary in
    them, and they are variables of their own here: the matrix stays sparse, and that of the
    centers alone is its Schur complement,

        H = M_cc - M_cl M_ll^-1 M_lc

    with the centers c and the lines l. `reduced`, `operator` and `solve` are those of H. There are
    d N coordinates of the centers, in two or three dimensions d.

    Attributes:
        packing: the particles.
        matrix: M, sparse and symmetric, shape (dN + lines, dN + lines) [energy/length^2]. Rows
            are x_0, y_0, x_1, y_1, ... of the centers, with z in three dimensions, then the shift
            of each line [length], of droplets the force of each contact [energy/length], then for
            `curved` the direction [rad] and the curvature [1/length] of each line, and for each
            droplet with films that stick the stretch L and the pressure P of
            `core.stretch_blocks`. Soft disks, spheres and `radical` have no such lines: M is H.
        energy: [energy].
        gradient: of the energy, shape (dN + lines,); minus the forces, and what is left of the
            balance of lines.
        by_strain: second derivatives by the rows of `matrix` and by the components xx, xy, ... of
            a displacement gradient, shape (dN + lines, d^2). Walls do not follow the strain.
        strain: second derivatives by the displacement gradient alone, shape (d^2, d^2) [energy].
        room: area, in three dimensions volume, of the packing [length^d].
        stress: pressure tensor of the contacts between particles, shape (d, d) [energy/length^d].
        free: particles without contacts in the matrix, shape (N,).
        scale: mean diagonal entry of the centers that have contacts [energy/length^2].
    """

    def __init__(self, packing: Packing, blocks: EnergyBlocks, chain: Any, strains: Floats) -> None:
        """Chain the derivatives by local variables to the global ones.

        Args:
            packing: the particles.
            blocks: energy and its derivatives by V local variables.
            chain: their derivatives by centers and lines, sparse, shape (V, dN + lines).
            strains: their derivatives by a displacement gradient, shape (V, d^2).
        """
        from scipy.sparse import csc_matrix, csr_matrix

        row, column, value = blocks.hessian()
        local = csr_matrix((value, (row, column)), shape=(len(strains), len(strains)))
        strained = local @ strains
        self.packing, self.energy = packing, blocks.energy
        self.matrix = csc_matrix(chain.T @ local @ chain)
        self.gradient = chain.T @ blocks.gradient
        self.by_strain, self.strain = chain.T @ strained, strains.T @ strained
        dimension = packing.dimension
        self.room = free_room(packing.walls, packing.box)
        self.stress = -(strains.T @ blocks.gradient).reshape(dimension, dimension) / self.room
        diagonal = self.matrix.diagonal()[: self.size].reshape(-1, dimension)
        self.free = ~diagonal.any(axis=1)
        self.scale = (
            float(np.abs(diagonal).mean(where=~self.free[:, None])) if diagonal.any() else 1.0
        )

    def __repr__(self) -> str:
        lines = self.matrix.shape[0] - self.size
        return f"<Hessian: {len(self.packing)} particles, {lines} variables of contact lines>"

    @property
    def size(self) -> int:
        """Number of coordinates dN."""
        return self.packing.dimension * len(self.packing)

    @cached_property
    def motions(self) -> Floats:
        """Motions of all particles with contacts together that no wall resists.

        Orthonormal, shape (dN, m): d translations in a periodic box, one along a channel, a
        rotation in a round container.
        """
        found = np.where(
            self.free[:, None], 0.0, motions(self.packing.walls, self.packing.positions)
        )
        if self.free.all() or not len(found):
            return np.empty((self.size, 0))
        return np.linalg.qr(found.reshape(len(found), -1).T)[0]

    @property
    def zero_modes(self) -> int:
        """Number of motions without a stiffness: `motions`, and d of each free particle."""
        return self.motions.shape[1] + self.packing.dimension * int(self.free.sum())

    @property
    def held(self) -> NDArray[np.bool_]:
        """Coordinates of particles that are not free, shape (dN,)."""
        return np.repeat(~self.free, self.packing.dimension)

    def project(self, vectors: Floats) -> Floats:
        """The part of vectors, shape (dN, ...), that contains no motion without a stiffness."""
        kept = np.where(self.held.reshape(-1, *[1] * (vectors.ndim - 1)), vectors, 0.0)
        return kept - self.motions @ (self.motions.T @ kept)

    @cached_property
    def operator(self) -> Any:
        """H as a `scipy.sparse.linalg.LinearOperator`, shape (dN, dN)."""
        from scipy.sparse.linalg import LinearOperator

        n, centers, response = self.size, self.matrix[: self.size, : self.size], self._lines

        def product(vector: Floats) -> Floats:
            if response is None:
                return np.asarray(centers @ vector)
            coupled = self.matrix[n:, :n] @ vector
            return np.asarray(centers @ vector - self.matrix[:n, n:] @ response(coupled))

        return LinearOperator((n, n), matvec=product, rmatvec=product, matmat=product, dtype=float)

    def reduced(self) -> Floats:
        """H as a dense array, shape (dN, dN) [energy/length^2]."""
        dense: Floats = self.matrix[: self.size, : self.size].toarray()
        if self._lines is not None:
            coupling = self.matrix[self.size :, : self.size].toarray()
            dense -= self.matrix[: self.size, self.size :] @ self._lines(coupling)
        return dense

    def solve(self, forces: ArrayLike) -> Floats:
        """Displacements u with H u = f, without motions that have no stiffness.

        Args:
            forces: f, shape (dN,) or (dN, k) [energy/length]. Their parts along motions without a
                stiffness are left out.

        Returns:
            u, of the same shape [length].

        Raises:
            ParameterError: wrong shape; or another motion has no stiffness, so that nothing holds
                against the forces.
        """
        given = numbers("forces", forces)
        if given.ndim not in (1, 2) or len(given) != self.size:
            raise ParameterError(
                f"forces must have shape ({self.size},) or ({self.size}, k), not {given.shape}"
            )
        padded = np.zeros((len(self.gradient), *given.shape[1:]))
        padded[: self.size] = given
        return self.response(padded)[: self.size]

    def response(self, right: Floats) -> Floats:
        """Change z of centers and lines with M z = b, see `solve`; shape (dN + lines, ...)."""
        right = right.copy()
        right[: self.size] = self.project(right[: self.size])
        solution, remainder = np.zeros_like(right), right
        size = before = float(np.abs(right).max(initial=0.0))
        inverse = self.factored(_SHIFT * self.scale)
        for _ in range(_CORRECTIONS):
            if before <= _REMAINDER * size:
                return solution
            solution = solution + inverse(remainder)
            solution[: self.size] = self.project(solution[: self.size])
            remainder = right - self.matrix @ solution
            remainder[: self.size] = self.project(remainder[: self.size])
            now = float(np.abs(remainder).max())
            if not now < 0.5 * before:
                break
            before = now
        if not before <= 1e-6 * size:
            raise ParameterError(
                "the packing does not resist these forces: a motion that moves its particles "
                "against each other has no stiffness, as below jamming"
            )
        return solution

    def factored(self, shift: float) -> Callable[[Floats], Floats]:
        """Product with the inverse of M, after a stiffness is added to all centers.

        Args:
            shift: this stiffness [energy/length^2].
        """
        from scipy.sparse import diags

        added = np.zeros(len(self.gradient))
        added[: self.size] = shift
        return factored(self.matrix + diags(added))

    def line_response(self, right: Floats) -> Floats:
        """Change y of lines with M_ll y = b while centers stay, shape (lines, ...)."""
        return right if self._lines is None else self._lines(right)

    @cached_property
    def _lines(self) -> Callable[[Floats], Floats] | None:
        """Product with M_ll^-1; None without lines."""
        lines = self.matrix[self.size :, self.size :]
        return factored(lines) if lines.shape[0] else None


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

    def blocks(self) -> RingBlocks:
        """Energy and derivatives by the local variables of the sides."""
        packing, radius = self.packing, self.packing.radii
        number = np.bincount(self.sides.i, minlength=len(packing))
        material = self.law.species_parameters(packing.species_radii).of(packing.species)
        particles = np.column_stack([number, radius, *material])
        partner = np.where(self.sides.j < 0, 0.0, radius[np.maximum(self.sides.j, 0)])
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
        table = table[_bearing(packing, table)]
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
    table = table[~_bearing(packing, table)]
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


def _bearing(packing: Packing, table: ContactTable) -> NDArray[np.bool_]:
    """See `bearing`; both sides of a contact do, if one does."""
    kept = bearing(table["i"], table["j"], table["force"], len(packing), packing.dimension)
    pair = np.flatnonzero(table["j"] >= 0)
    kept[pair] |= kept[pair[other_side(table[pair])]]
    return kept


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
    if not isinstance(state.law, Ring | Sector | Droplet):
        raise UndefinedError("polygons have no second derivatives here: take a Ring")
    if state.unsaved:
        raise ParameterError(
            f"second derivatives do not know the {state.unsaved} that were given to lmp"
        )
    if state.friction:
        raise ParameterError("friction has no energy, and so no second derivatives of one")
    if isinstance(state.law, Droplet):
        return _of_droplets(state, state.law, rattlers)
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
    sides, contact, kept = _bearing_soft(state.packing)
    return sides.part(~kept), (contact - sides.distance)[~kept]


def _bearing_soft(packing: Packing) -> tuple[Sides, Floats, NDArray[np.bool_]]:
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
    sides, contact, kept = _bearing_soft(packing)
    if not rattlers:
        sides, contact = sides.part(kept), contact[kept]
    blocks: Any = _Scaled(disk_blocks(sides.vector, sides.turn, contact, sides.axis), law.k)
    return Hessian(packing, blocks, by_centers(sides, len(packing)), by_strains(sides))


# Local variables of a side of a droplet, the vector and the force, which is the same from both
# sides; of a facet that turns, its force, the way w = (R t)_i - (R t)_j, and the logarithm of
# D_i D_j; of a film that is a cap, its force, and the pressures of both sides.
_SIDE_VARIABLES, _TURN_VARIABLES, _CAP_VARIABLES = 4, 5, 3


class _Sum:
    """Energy of several kinds of blocks, whose local variables follow each other."""

    def __init__(self, *parts: Any) -> None:
        self.energy = sum(part.energy for part in parts)
        self.gradient = np.concatenate([part.gradient for part in parts])
        self._parts = parts

    def hessian(self) -> tuple[NDArray[np.int32], NDArray[np.int32], Floats]:
        first, found = 0, []
        for part in self._parts:
            row, column, value = part.hessian()
            found.append((row + first, column + first, value))
            first += len(part.gradient)
        row, column, value = map(np.concatenate, zip(*found, strict=True))
        return row, column, value


class _Turns:
    """Minus the energy of facets that turn, F |w|^2 D_i D_j/(2 (R_i + R_j)), by their variables."""

    def __init__(self, force: Floats, way: Floats, damping: Floats, radii: Floats) -> None:
        part, square = damping / radii, (way**2).sum(axis=1)
        turned = 0.5 * part * square
        self.energy = -float(force @ turned)
        of_way = (part * force)[:, None] * way
        columns = [turned[:, None], of_way, (force * turned)[:, None]]
        self.gradient = -np.concatenate(columns, axis=1).ravel()
        block = np.zeros((len(force), _TURN_VARIABLES, _TURN_VARIABLES))
        block[:, 0, 1:4] = part[:, None] * way
        block[:, 0, 4] = turned
        block[:, 1:4, 4] = of_way
        block += block.transpose(0, 2, 1)
        block[:, [1, 2, 3], [1, 2, 3]] = (part * force)[:, None]
        block[:, 4, 4] = force * turned
        self._block = -block

    def hessian(self) -> tuple[NDArray[np.int32], NDArray[np.int32], Floats]:
        count = np.arange(len(self.gradient), dtype=np.int32).reshape(-1, _TURN_VARIABLES)
        row, column = np.broadcast_arrays(count[:, :, None], count[:, None, :])
        return row.ravel(), column.ravel(), self._block.ravel()


class _Stretches:
    """What films that stick add to the energy, by the forces, and by L and P of their droplets.

    The energy is stationary in L and P, as it is in the forces.

    Attributes:
        chain: derivatives of the local variables of the blocks by the forces of C contacts, and by
            L and P of n droplets, sparse, shape (V, C + 2n).
    """

    def __init__(
        self,
        sides: Sides,
        droplets: Floats,
        other: Integers,
        forces: Floats,
        films: Floats,
        contact: Integers,
    ) -> None:
        """Of all contacts of droplets that have films.

        Args:
            sides: all of them, S.
            droplets: number of sides, radius and tension, shape (N, 3).
            other: the other side of each, a wall's own, shape (S,).
            forces: of each side, shape (S,) [energy/length].
            films: contact angle of each side [rad], 0 without a film, and lambda, shape (S, 2).
            contact: of each side, 0 to C - 1, shape (S,).
        """
        from scipy.sparse import csr_matrix

        films_of = np.bincount(sides.i, films[:, 0] > 0.0, len(droplets))
        wet = np.flatnonzero(films_of)
        place = np.cumsum(films_of > 0) - 1
        kept = np.flatnonzero(films_of[sides.i])
        of_droplet, size = place[sides.i[kept]], int(contact.max(initial=-1)) + 1
        self._first = size
        radius, tension = droplets[:, 1:].T[:, sides.i]
        self._cap = np.flatnonzero(
            (films[:, 0] > 0.0)
            & (other > np.arange(len(other)))
            & (radius != radius[other])
            & (tension == tension[other])
        )
        there = other[self._cap]
        self._ends = place[np.stack([sides.i[self._cap], sides.i[there]], axis=1)]
        self._droplets = np.column_stack([droplets[wet], np.tile((1.0, 2.0), (len(wet), 1))])
        self._sides = np.column_stack([forces[kept], films[kept]])
        at = self._cap
        pair = np.column_stack([radius[at], radius[there], tension[at], films[at, 0]])
        self._caps = np.column_stack([forces[at], np.zeros_like(self._ends, float), pair])

        # local variables: of each droplet the forces, L and P, then of each cap the force, P and P
        row = np.arange(len(kept)) + 2 * of_droplet
        own = np.cumsum(droplets[wet, 0].astype(int) + 2)
        end, columns = int(own.max(initial=0)), size + 2 * np.arange(len(wet))
        cap = end + _CAP_VARIABLES * np.arange(len(at))
        rows = [row, own - 2, own - 1, cap, cap + 1, cap + 2]
        pressures = size + 2 * self._ends.T + 1
        of = [contact[kept], columns, columns + 1, contact[at], *pressures]
        entries = np.concatenate(rows), np.concatenate(of)
        self.chain = csr_matrix(
            (np.ones(len(entries[0])), entries),
            shape=(end + _CAP_VARIABLES * len(at), size + 2 * len(wet)),
        )
        self._settle()

    def blocks(self) -> _Sum:
        """At the present L and P."""
        self._caps[:, 1:3] = self._droplets[:, 4][self._ends]
        return _Sum(stretch_blocks(self._droplets, self._sides), cap_blocks(self._caps))

    def _settle(self) -> None:
        """Newton's method for L and P, from those of a sphere."""
        from scipy.sparse import csr_matrix

        chain = self.chain[:, self._first :]
        for _ in range(_STEPS):
            blocks = self.blocks()
            row, column, value = blocks.hessian()
            local = csr_matrix((value, (row, column)), shape=(chain.shape[0], chain.shape[0]))
            step = factored(chain.T @ local @ chain)(chain.T @ blocks.gradient).reshape(-1, 2)
            self._droplets[:, 3:] -= step
            if not np.abs(step).max() > _SETTLED:
                return
        raise ParameterError("the films of this state do not come to rest: relax it first")


# Step of L and P after which their error, about its square, is that of rounding.
_SETTLED = 1e-8


def _films_of(
    state: State, law: Droplet, table: ContactTable, other: Integers, droplets: Floats
) -> Floats:
    """Contact angle and lambda of each side, 0 and 1 without a film, shape (S, 2)."""
    films = np.column_stack([table["contact_angle"], np.ones(len(table))])
    species = state.packing.species
    adhesion = pair_matrix("adhesion", law.adhesion, int(species.max(initial=0)) + 1)
    for n in np.flatnonzero((films[:, 0] > 0.0) & (other != np.arange(len(table)))):
        i, j = table["i"][[n, other[n]]]
        (_, radius, tension), (_, its_radius, its_tension) = droplets[[i, j]]
        w = adhesion[species[i], species[j]]
        films[n, 1] = film_angles(radius, tension, its_radius, its_tension, w)[2]
    return films


def _of_droplets(state: State, law: Droplet, rattlers: bool) -> Hessian:
    """The dual energy is stationary in the forces, which take the place of lines here.

    A wall does not move, and its contact has one side. So its other side is itself here: the film
    is flat, and does not turn.
    """
    from scipy.sparse import csr_matrix, hstack, vstack

    packing, table = state.packing, state.contacts
    if not rattlers:
        table = table[_bearing(packing, table) | table["attached"]]
    count, is_wall = len(table), table["j"] < 0
    pair, wall, other = np.flatnonzero(~is_wall), np.flatnonzero(is_wall), np.arange(count)
    met = table[pair]
    other[pair] = pair[other_side(met)]
    sides = joined(
        between(met["i"], met["j"], met["distance"][:, None] * met["normal"]),
        at_walls(packing, table["i"][wall], -1 - table["j"][wall]),
    ).part(np.argsort(np.append(pair, wall)))
    force, part = 0.5 * (table["force"] + table["force"][other]), np.where(is_wall, 1.0, 0.5)
    tension = law.species_parameters(packing.species_radii).of(packing.species).tension
    radius, gamma = packing.radii[sides.i], tension[sides.i]
    radii = radius + radius[other]
    overlap = np.where(is_wall, radius, radii) - sides.distance
    film = np.log(gamma[other] * radii / (radius[other] * (gamma + gamma[other])))
    number = np.bincount(sides.i, minlength=len(packing))
    droplets = np.column_stack([number, packing.radii, tension])
    columns = [sides.vector, sides.turn, sides.axis, overlap, part, film, force]
    stuck = _films_of(state, law, table, other, droplets)
    rows = np.column_stack([*columns, stuck[:, 0], np.zeros((count, 3))])
    facets = droplet_facets(droplets, rows)
    way, damping = facets[:, :3] - facets[other, :3], facets[:, 3] * facets[other, 3]
    rows[:, -3:] = (force / (gamma * radius) * damping / radii)[:, None] * way
    blocks, (row, column, value) = droplet_blocks(droplets, rows)

    first = np.flatnonzero(other > np.arange(count))
    turns = _Turns(force[first], way[first], damping[first], radii[first])
    size, variable = _SIDE_VARIABLES * count, _SIDE_VARIABLES * np.arange(count)
    places = csr_matrix((value, (row, column)), shape=(3 * count, size))
    on = [places[3 * first + axis] - places[3 * other[first] + axis] for axis in range(3)]
    one = csr_matrix((np.ones(count), (np.arange(count), variable + 3)), shape=(count, size))
    sums = csr_matrix((np.ones(count), (sides.i, np.arange(count))), shape=(len(packing), count))
    damped = sums.T @ csr_matrix(
        (-core.droplet_decay / 4.0 / (8.0 * np.pi) / (gamma * radius), (sides.i, variable + 3)),
        shape=(len(packing), size),
    )
    local = vstack([one[first], *on, damped[first] + damped[other[first]]], format="csr")
    order = np.arange(_TURN_VARIABLES * len(first)).reshape(_TURN_VARIABLES, -1).T.ravel()
    of_turns = local[order]

    _, contact = np.unique(np.minimum(other, np.arange(count)), return_inverse=True)
    forces = csr_matrix((np.ones(count), (variable + 3, contact)), shape=(size, count - len(first)))
    chain = hstack([by_centers(sides, len(packing), _SIDE_VARIABLES), forces], format="csr")
    strains = by_strains(sides, _SIDE_VARIABLES)
    chain, strains = vstack([chain, of_turns @ chain]), np.vstack([strains, of_turns @ strains])
    parts: list[Any] = [blocks, turns]
    if stuck[:, 0].any():
        stretches = _Stretches(sides, droplets, other, force, stuck, contact)
        further = stretches.chain
        before = csr_matrix((further.shape[0], 3 * len(packing)))
        none = csr_matrix((chain.shape[0], further.shape[1] - (count - len(first))))
        chain = vstack([hstack([chain, none]), hstack([before, further])])
        strains = np.vstack([strains, np.zeros((further.shape[0], strains.shape[1]))])
        parts.append(stretches.blocks())
    energies: Any = _Sum(*parts)
    return Hessian(packing, energies, chain.tocsr(), strains)

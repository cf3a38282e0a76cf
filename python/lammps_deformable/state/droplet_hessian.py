"""The energy of droplets in space by centers and forces, to second order.

The dual energy is stationary in the forces, in the facets that turn, and where films stick in the
stretch and the pressure of their droplets.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.errors import ParameterError
from ..core import (
    cap_blocks,
    cap_parameters,
    droplet_blocks,
    droplet_facets,
    film_angles,
    stretch_blocks,
    stretch_parameters,
)
from ..particles.laws import Droplet, pair_matrix
from .contacts import (
    ContactTable,
    Sides,
    at_walls,
    bears,
    between,
    by_centers,
    by_strains,
    joined,
    other_side,
)
from .hessian_matrix import Hessian, factored

if TYPE_CHECKING:
    from ..particles.packing import Packing
    from .state import State

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Parameters = tuple[Floats, tuple[NDArray[np.int32], NDArray[np.int32], Floats]]

# Step of L and P after which their error, about its square, is that of rounding, and steps at most.
_SETTLED, _STEPS = 1e-8, 20

# Local variables of a side of a droplet, the vector and the force, which is the same from both
# sides; of one that turns, three angles too; of a facet that turns, its force, the way w = (R t)_i
# - (R t)_j, and the logarithm of D_i D_j; of a film that is a cap, its force, and the pressures of
# both sides.
SIDE_VARIABLES, TURNING_VARIABLES, TURN_VARIABLES, CAP_VARIABLES = 4, 7, 5, 3

# ln D of a droplet over the sum of its forces over R and tension.
DAMPING = -core.droplet_decay / 4.0 / (8.0 * np.pi)


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
        block = np.zeros((len(force), TURN_VARIABLES, TURN_VARIABLES))
        block[:, 0, 1:4] = part[:, None] * way
        block[:, 0, 4] = turned
        block[:, 1:4, 4] = of_way
        block += block.transpose(0, 2, 1)
        block[:, [1, 2, 3], [1, 2, 3]] = (part * force)[:, None]
        block[:, 4, 4] = force * turned
        self._block = -block

    def hessian(self) -> tuple[NDArray[np.int32], NDArray[np.int32], Floats]:
        count = np.arange(len(self.gradient), dtype=np.int32).reshape(-1, TURN_VARIABLES)
        row, column = np.broadcast_arrays(count[:, :, None], count[:, None, :])
        return row.ravel(), column.ravel(), self._block.ravel()


class _Stretches:
    """What films that stick add to the energy, by the forces, and by L and P of their droplets.

    The energy is stationary in L and P, as it is in the forces.

    Attributes:
        chain: derivatives of the local variables of the blocks by the forces of C contacts, and by
            L and P of n droplets, sparse, shape (V, C + 2n).
        wet: the droplets with films, shape (n,).
        kept: the sides of these, shape (K,).
        caps: one side of each film that is a cap, shape (M,).
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
        self.wet = wet = np.flatnonzero(films_of)
        place = np.cumsum(films_of > 0) - 1
        self.kept = kept = np.flatnonzero(films_of[sides.i])
        of_droplet, size = place[sides.i[kept]], int(contact.max(initial=-1)) + 1
        self._first = size
        radius, tension = droplets[:, 1:].T[:, sides.i]
        self.caps = np.flatnonzero(
            (films[:, 0] > 0.0)
            & (other > np.arange(len(other)))
            & (radius != radius[other])
            & (tension == tension[other])
        )
        there = other[self.caps]
        self._ends = place[np.stack([sides.i[self.caps], sides.i[there]], axis=1)]
        self._droplets = np.column_stack([droplets[wet], np.tile((1.0, 2.0), (len(wet), 1))])
        self._sides = np.column_stack([forces[kept], films[kept]])
        at = self.caps
        pair = np.column_stack([radius[at], radius[there], tension[at], films[at, 0]])
        self._caps = np.column_stack([forces[at], np.zeros_like(self._ends, float), pair])

        # local variables: of each droplet the forces, L and P, then of each cap the force, P and P
        row = np.arange(len(kept)) + 2 * of_droplet
        own = np.cumsum(droplets[wet, 0].astype(int) + 2)
        end, columns = int(own.max(initial=0)), size + 2 * np.arange(len(wet))
        cap = end + CAP_VARIABLES * np.arange(len(at))
        rows = [row, own - 2, own - 1, cap, cap + 1, cap + 2]
        pressures = size + 2 * self._ends.T + 1
        of = [contact[kept], columns, columns + 1, contact[at], *pressures]
        entries = np.concatenate(rows), np.concatenate(of)
        self.chain = csr_matrix(
            (np.ones(len(entries[0])), entries),
            shape=(end + CAP_VARIABLES * len(at), size + 2 * len(wet)),
        )
        self._settle()

    def blocks(self) -> _Sum:
        """At the present L and P."""
        self._caps[:, 1:3] = self._droplets[:, 4][self._ends]
        return _Sum(stretch_blocks(self._droplets, self._sides), cap_blocks(self._caps))

    def parameters(self) -> tuple[Parameters, Parameters]:
        """Of both kinds of blocks, see `core.stretch_parameters` and `core.cap_parameters`."""
        films = stretch_parameters(self._droplets, self._sides)
        return films, cap_parameters(self._caps)

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


@dataclass
class DropletContacts:
    """Contacts of droplets, and the energy by their local variables, one kind after the other.

    Attributes:
        packing: the droplets.
        variables: number of local variables of a side.
        droplets: number of sides, radius and tension, shape (N, 3).
        sides: both sides of each contact between droplets, one of a contact with a wall, S.
        other: the other side of each, a wall's own, shape (S,).
        rows: of `core.droplet_blocks`, shape (S, 15).
        first: one side of each contact between droplets, shape (M,).
        facets: place R t of the facet of each side, and D of its droplet, shape (S, 4).
        places: derivatives of R t by the local variables of the sides, sparse, (3S, variables S).
        turns: the blocks of the M facets that turn.
        of_turns: their local variables by those of the sides, sparse, (5M, variables S).
        stuck: contact angle and lambda of the film of each side, 0 and 1 without, shape (S, 2).
        stretches: what these films add; None without.
        blocks: of all.
        chain: derivatives of all local variables by centers, forces, L and P.
        strains: by a displacement gradient.
    """

    packing: Packing
    variables: int
    droplets: Floats
    sides: Sides
    other: Integers
    rows: Floats
    first: Integers
    facets: Floats
    places: Any
    turns: _Turns
    of_turns: Any
    stuck: Floats
    stretches: _Stretches | None
    blocks: _Sum
    chain: Any
    strains: Floats

    @property
    def films(self) -> int:
        """The first local variable of `core.stretch_blocks`."""
        return self.variables * len(self.sides.i) + TURN_VARIABLES * len(self.first)

    @property
    def caps(self) -> int:
        """The first local variable of `core.cap_blocks`."""
        assert self.stretches is not None
        return self.films + len(self.stretches.kept) + 2 * len(self.stretches.wet)

    def hessian(self) -> Hessian:
        """By centers, forces, L and P."""
        return Hessian(self.packing, self.blocks, self.chain, self.strains)


def contacts_of_droplets(
    state: State, law: Droplet, rattlers: bool, turning: bool = False
) -> DropletContacts:
    """The dual energy is stationary in the forces, which take the place of lines here.

    A wall does not move, and its contact has one side. So its other side is itself here: the film
    is flat, and does not turn.

    Args:
        state: with the contacts.
        law: its law.
        rattlers: whether their contacts count.
        turning: whether turns of sides are local variables, see `core.droplet_blocks`.
    """
    from scipy.sparse import csr_matrix, hstack, vstack

    packing, table = state.packing, state.contacts
    if not rattlers:
        table = table[bears(packing, table) | table["attached"]]
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
    blocks, (row, column, value) = droplet_blocks(droplets, rows, turning)

    first = np.flatnonzero(other > np.arange(count))
    turns = _Turns(force[first], way[first], damping[first], radii[first])
    variables = TURNING_VARIABLES if turning else SIDE_VARIABLES
    size, variable = variables * count, variables * np.arange(count)
    places = csr_matrix((value, (row, column)), shape=(3 * count, size))
    on = [places[3 * first + axis] - places[3 * other[first] + axis] for axis in range(3)]
    one = csr_matrix((np.ones(count), (np.arange(count), variable + 3)), shape=(count, size))
    sums = csr_matrix((np.ones(count), (sides.i, np.arange(count))), shape=(len(packing), count))
    damped = sums.T @ csr_matrix(
        (DAMPING / (gamma * radius), (sides.i, variable + 3)),
        shape=(len(packing), size),
    )
    local = vstack([one[first], *on, damped[first] + damped[other[first]]], format="csr")
    order = np.arange(TURN_VARIABLES * len(first)).reshape(TURN_VARIABLES, -1).T.ravel()
    of_turns = local[order]

    _, contact = np.unique(np.minimum(other, np.arange(count)), return_inverse=True)
    forces = csr_matrix((np.ones(count), (variable + 3, contact)), shape=(size, count - len(first)))
    chain = hstack([by_centers(sides, len(packing), variables), forces], format="csr")
    strains = by_strains(sides, variables)
    chain, strains = vstack([chain, of_turns @ chain]), np.vstack([strains, of_turns @ strains])
    parts: list[Any] = [blocks, turns]
    stretches = None
    if stuck[:, 0].any():
        stretches = _Stretches(sides, droplets, other, force, stuck, contact)
        further = stretches.chain
        before = csr_matrix((further.shape[0], 3 * len(packing)))
        none = csr_matrix((chain.shape[0], further.shape[1] - (count - len(first))))
        chain = vstack([hstack([chain, none]), hstack([before, further])])
        strains = np.vstack([strains, np.zeros((further.shape[0], strains.shape[1]))])
        parts.append(stretches.blocks())
    return DropletContacts(
        packing,
        variables,
        droplets,
        sides,
        other,
        rows,
        first,
        facets,
        places,
        turns,
        of_turns,
        stuck,
        stretches,
        _Sum(*parts),
        chain.tocsr(),
        strains,
    )

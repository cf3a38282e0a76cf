"""Vectors from particles to their neighbors and walls, and how they follow from the centers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..model.packing import Packing
from ..model.room import Distances
from .contact_network import without_rattlers

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Contacts of rattlers count as open below this part of the mean contact force: a relaxation leaves
# rattlers where they are once the forces on them are small.
_OPEN = 1e-3


class Sides(NamedTuple):
    """Sides of contacts: of one particle with a neighbor or a wall.

    Attributes:
        i: the particle, shape (S,).
        j: its neighbor, -1 for a wall, shape (S,).
        vector: from its center to that of the neighbor, or to the nearest point of the wall, shape
            (S, 2) [length].
        turn: angle by which the direction of the vector turns for a step of it sideways, shape (S,)
            [1/length].
    """

    i: Integers
    j: Integers
    vector: Floats
    turn: Floats

    def part(self, kept: NDArray[Any]) -> Sides:
        """Some of the sides."""
        return Sides(*(values[kept] for values in self))

    @property
    def distance(self) -> Floats:
        """Lengths of the vectors, shape (S,) [length]."""
        return np.hypot(*self.vector.T)


def between(i: Integers, j: Integers, vector: Floats) -> Sides:
    """Sides of contacts between particles."""
    return Sides(i, j, vector, 1.0 / np.hypot(*vector.T))


def with_walls(packing: Packing, reach: float) -> Sides:
    """Sides with each wall nearer than (1 + reach) R, sorted by particle and wall.

    Raises:
        ParameterError: a particle is at the center of a circle that it reaches.
    """
    if not packing.walls:
        return between(np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 2)))
    distances = Distances(packing.walls, packing.box)
    out, height = distances(packing.positions)
    near = (height < (1.0 + reach) * packing.radius).T
    vector = np.swapaxes(height[..., None] * out, 0, 1)[near]
    (i, wall), turn = np.nonzero(near), distances.turns(packing.positions).T[near]
    if (centered := np.flatnonzero(np.isinf(turn))).size:
        k, m = int(i[centered[0]]), int(wall[centered[0]])
        raise ParameterError(
            f"particle {k} is at the center of {packing.walls[m].kind} {m + 1} and reaches it in "
            "all directions: its energy has no second derivatives there"
        )
    return Sides(i, np.full_like(i, -1), vector, turn)


def joined(*parts: Sides) -> Sides:
    """All sides, one part after the other."""
    return Sides(*map(np.concatenate, zip(*parts, strict=True)))


def bearing(i: Integers, j: Integers, force: Floats, number: int) -> NDArray[np.bool_]:
    """Whether contacts are of the network, or bear a force worth mentioning, shape (S,).

    Args:
        i: particle of each side, both of a contact, shape (S,).
        j: its partner, -1 for a wall, shape (S,).
        force: of the contact, shape (S,) [energy/length].
        number: of particles.
    """
    mean = float(force[force > 0.0].mean()) if (force > 0.0).any() else 0.0
    return without_rattlers(i, j, number) | (force > _OPEN * mean)


def by_centers(sides: Sides, number: int, variables: int = 2) -> Any:
    """d(local variables)/d(centers): vectors are r_j - r_i, those to a wall -r_i.

    Args:
        sides: their vectors are the first two of the local variables.
        number: of particles N.
        variables: number of local variables of a side.

    Returns:
        Sparse matrix, shape (S variables, 2N); columns x_0, y_0, x_1, ...
    """
    from scipy.sparse import csr_matrix

    row = variables * np.arange(len(sides.i))
    pair = sides.j >= 0
    entries = [
        (sign * np.ones(len(rows)), rows + axis, 2 * particle + axis)
        for sign, rows, particle in ((-1.0, row, sides.i), (1.0, row[pair], sides.j[pair]))
        for axis in (0, 1)
    ]
    values, rows, columns = map(np.concatenate, zip(*entries, strict=True))
    return csr_matrix((values, (rows, columns)), shape=(variables * len(row), 2 * number))


def by_strains(sides: Sides, variables: int = 2) -> Floats:
    """d(local variables)/d(strain), shape (S variables, 4).

    Columns are the components xx, xy, yx, yy of a displacement gradient e: vectors between
    particles change by e v. Walls stay where they are.
    """
    found = np.zeros((len(sides.i), variables, 2, 2))
    moving = np.where((sides.j >= 0)[:, None], sides.vector, 0.0)
    for axis in (0, 1):
        found[:, axis, axis] = moving
    return found.reshape(-1, 4)

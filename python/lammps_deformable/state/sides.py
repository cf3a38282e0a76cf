"""Vectors from particles to their neighbors and walls, and how they follow from the centers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..model.distances import Distances
from ..model.lattice import lengths
from ..model.packing import Packing
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
            (S, d) in d dimensions [length].
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
        return lengths(self.vector)


def between(i: Integers, j: Integers, vector: Floats) -> Sides:
    """Sides of contacts between particles."""
    return Sides(i, j, vector, 1.0 / lengths(vector))


def with_walls(packing: Packing, reach: float) -> Sides:
    """Sides with each wall nearer than (1 + reach) R, sorted by particle and wall.

    Raises:
        ParameterError: a particle is at the center of a circle that it reaches.
    """
    if not packing.walls:
        none = np.empty(0, np.int64)
        return between(none, none, np.empty((0, packing.dimension)))
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


def bearing(
    i: Integers, j: Integers, force: Floats, number: int, of_rattlers: int = 2
) -> NDArray[np.bool_]:
    """Whether contacts are of the network, or bear a force worth mentioning, shape (S,).

    Args:
        i: particle of each side, both of a contact, shape (S,).
        j: its partner, -1 for a wall, shape (S,).
        force: of the contact, shape (S,) [energy/length].
        number: of particles.
        of_rattlers: contacts of a rattler at most.
    """
    mean = float(force[force > 0.0].mean()) if (force > 0.0).any() else 0.0
    return without_rattlers(i, j, number, of_rattlers) | (force > _OPEN * mean)


def other_sides(pairs: NDArray[np.void]) -> Integers:
    """The row of the other side of each contact between particles, shape (S,).

    Args:
        pairs: rows with i, j and image, both sides of each contact, sorted by these.
    """
    other = np.empty(len(pairs), np.int64)
    # in this order the other sides come in the order of their own
    order = np.lexsort((*-pairs["image"].T[::-1], pairs["i"], pairs["j"]))
    other[order] = np.arange(len(pairs))
    return other


def by_centers(sides: Sides, number: int, variables: int | None = None) -> Any:
    """d(local variables)/d(centers): vectors are r_j - r_i, those to a wall -r_i.

    Args:
        sides: their vectors are the first of the local variables.
        number: of particles N.
        variables: number of local variables of a side; the vector alone if not given.

    Returns:
        Sparse matrix, shape (S variables, d N); columns x_0, y_0, x_1, ...
    """
    from scipy.sparse import csr_matrix

    dimension = sides.vector.shape[1]
    variables = variables or dimension
    row = variables * np.arange(len(sides.i))
    pair = sides.j >= 0
    entries = [
        (sign * np.ones(len(rows)), rows + axis, dimension * particle + axis)
        for sign, rows, particle in ((-1.0, row, sides.i), (1.0, row[pair], sides.j[pair]))
        for axis in range(dimension)
    ]
    values, rows, columns = map(np.concatenate, zip(*entries, strict=True))
    shape = (variables * len(row), dimension * number)
    return csr_matrix((values, (rows, columns)), shape=shape)


def by_lines(other: Integers, variables: int, signs: Sequence[float]) -> list[Any]:
    """d(local variables)/d(places of lines), one variable of all contacts after the other.

    Args:
        other: the other side of each, -1 for walls, shape (S,).
        variables: number of local variables of a side; those of its line are the last.
        signs: of each variable of a line, as the other side sees it.

    Returns:
        Sparse matrices, shape (S variables, contacts between particles).
    """
    from scipy.sparse import csr_matrix

    first = np.flatnonzero(other > np.arange(len(other)))
    count, ends = len(first), np.concatenate([first, other[first]])
    contact, shape = np.tile(np.arange(count), 2), (variables * len(other), count)
    return [
        csr_matrix((np.repeat([1.0, sign], count), (variables * ends + n, contact)), shape=shape)
        for n, sign in enumerate(signs, start=variables - len(signs))
    ]


def by_strains(sides: Sides, variables: int | None = None) -> Floats:
    """d(local variables)/d(strain), shape (S variables, d^2).

    Columns are the components xx, xy, ... of a displacement gradient e: vectors between particles
    change by e v. Walls stay where they are.
    """
    dimension = sides.vector.shape[1]
    found = np.zeros((len(sides.i), variables or dimension, dimension, dimension))
    moving = np.where((sides.j >= 0)[:, None], sides.vector, 0.0)
    for axis in range(dimension):
        found[:, axis, axis] = moving
    return found.reshape(-1, dimension**2)

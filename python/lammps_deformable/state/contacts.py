"""Contacts of a state: tables by law, forces, and the network without rattlers.

Tables of rings and droplets come from compute deformable/contact, those of soft contacts from the
centers. Second derivatives know contacts by their sides: vectors from particles to their neighbors
and walls, and how these follow from the centers. The isostatic number of contacts also depends on
the motions of all particles together that no wall resists.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.box import fractional, lengths
from ..common.checks import zero_or_more
from ..common.errors import ParameterError
from ..common.versions import optional
from ..core import unit_vectors
from ..particles.containers import Distances, closed
from ..particles.laws import SoftContact
from ..particles.neighbors import forward, near_pairs
from ..particles.walls import Cone, Cylinder, Plane, Sphere, SurfaceWall, Wall

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..particles.packing import Packing
    from .state import State

Floats = NDArray[np.float64]

# Parts of a motion that are rounding.
_ROUNDING = 1e-9


def free_motions(walls: Sequence[Wall], dimension: int = 2) -> int:
    """Number of motions of all particles together that no wall resists."""
    return len(_free(walls, dimension))


def motions(walls: Sequence[Wall], positions: Floats) -> Floats:
    """These motions, of particles at N positions, shape (`free_motions`, N, d)."""
    dimension = positions.shape[1]
    found = _free(walls, dimension)
    turns = _turned(positions)
    return found[:, None, :dimension] + np.einsum("mk,nak->mna", found[:, dimension:], turns)


def _free(walls: Sequence[Wall], dimension: int) -> Floats:
    """Motions as rows: a translation, and a turn in each plane of two axes.

    A motion moves all particles from x to x + t + W x, with an antisymmetric matrix W. What walls
    and periodic images forbid is linear in t and W.
    """
    parts = np.eye(dimension + dimension * (dimension - 1) // 2)
    if not walls:
        return parts[:dimension]
    periodic = np.eye(dimension)[~np.array(closed(walls, dimension))]
    forbidden = [_turns(axis) for axis in periodic]
    for wall in walls:
        forbidden += _forbidden(wall)
    rows = np.concatenate(forbidden)
    _, sizes, directions = np.linalg.svd(rows)
    found: Floats = directions[int(np.sum(sizes > _ROUNDING * sizes.max())) :]
    return found


def _forbidden(wall: Wall) -> list[Floats]:
    """Rows that vanish for a motion that moves a wall within itself."""
    if isinstance(wall, Plane):
        normal = np.array(wall.normal) / np.linalg.norm(wall.normal)
        return [_turns(normal), normal[None] @ _moves(np.array(wall.origin))]
    if isinstance(wall, Cylinder):
        return [_turns(np.array(wall._direction)), _moves(wall._middle)[list(wall._round_axes)]]
    if isinstance(wall, Cone):
        return [_turns(np.array(wall._direction)), _moves(wall._middle)]
    if isinstance(wall, Sphere):
        return [_moves(wall._middle)]
    return [np.eye(3 if wall.dimension == 2 else 6)]  # of one with corners


def _turned(x: Floats) -> Floats:
    """W x for a turn in each plane, shape (..., d, turns)."""
    dimension = x.shape[-1]
    found = [np.zeros_like(x) for _ in combinations(range(dimension), 2)]
    for each, (a, b) in zip(found, combinations(range(dimension), 2), strict=True):
        each[..., a], each[..., b] = -x[..., b], x[..., a]
    return np.stack(found, axis=-1)


def _turns(direction: Floats) -> Floats:
    """Change of a direction by each part of a motion, shape (d, parts)."""
    return np.hstack([np.zeros((len(direction),) * 2), _turned(direction)])


def _moves(place: Floats) -> Floats:
    """Change of a place by each part of a motion, shape (d, parts)."""
    return np.hstack([np.eye(len(place)), _turned(place)])


Integers = NDArray[np.int64]

# Contacts of rattlers count as open below this part of the mean contact force: a relaxation leaves
# rattlers where they are once the forces on them are small.
_OPEN = 1e-3


class Sides(NamedTuple):
    """Sides of contacts: of one particle with a neighbor or a wall.

    Attributes:
        i: the particle, shape (S,).
        j: its neighbor, -1 - k for wall k, shape (S,).
        vector: from its center to that of the neighbor, or to the nearest point of the wall, shape
            (S, d) in d dimensions [length].
        turn: angle by which the direction of the vector turns for a step of it sideways, at a
            cylinder or cone around the axis, shape (S,) [1/length].
        axis: of a cylinder or cone, unit vectors, 0 for all others, shape (S, d).
    """

    i: Integers
    j: Integers
    vector: Floats
    turn: Floats
    axis: Floats

    def part(self, kept: NDArray[Any]) -> Sides:
        """Some of the sides."""
        return Sides(*(values[kept] for values in self))

    @property
    def distance(self) -> Floats:
        """Lengths of the vectors, shape (S,) [length]."""
        return lengths(self.vector)


def between(i: Integers, j: Integers, vector: Floats) -> Sides:
    """Sides of contacts between particles."""
    return Sides(i, j, vector, 1.0 / lengths(vector), np.zeros_like(vector))


def with_walls(packing: Packing, reach: float) -> Sides:
    """Sides with each wall nearer than (1 + reach) R, sorted by particle and wall.

    Raises:
        ParameterError: a particle is at the center of a circle that it reaches.
    """
    reached = (1.0 + reach) * packing.radii
    is_surface = np.array([isinstance(wall, SurfaceWall) for wall in packing.walls], dtype=bool)
    _, height = Distances(packing.walls, packing.box)(packing.positions)
    found = at_walls(packing, *np.nonzero(((height < reached) & ~is_surface[:, None]).T))
    if not is_surface.any():
        return found
    surfaces = [wall for wall in packing.walls if isinstance(wall, SurfaceWall)]
    distances = Distances(surfaces, packing.box)
    i, k, out, apart = distances.contacts(packing.positions, float(reached.max()))
    vector = apart[:, None] * out
    more = Sides(i, -1 - np.flatnonzero(is_surface)[k], vector, np.zeros(len(i)), 0.0 * vector)
    both = joined(found, more.part(apart < reached[i]))
    return both.part(np.lexsort((-both.j, both.i)))


def at_walls(packing: Packing, i: Integers, wall: Integers) -> Sides:
    """Sides of particles i with these walls, shape (S,) each.

    Raises:
        ParameterError: a particle is at the center of a circle.
    """
    if not len(i):
        return between(i, wall, np.empty((0, packing.dimension)))
    distances = Distances(packing.walls, packing.box)
    out, height = distances(packing.positions)
    turn = distances.turns(packing.positions)[wall, i]
    if (centered := np.flatnonzero(np.isinf(turn))).size:
        k, m = int(i[centered[0]]), int(wall[centered[0]])
        raise ParameterError(
            f"particle {k} is at the center of {packing.walls[m]._kind} {m + 1} and reaches it in "
            "all directions: its energy has no second derivatives there"
        )
    none = (0.0,) * packing.dimension
    axes = [w._direction if isinstance(w, Cylinder | Cone) else none for w in packing.walls]
    vector = height[wall, i, None] * out[wall, i]
    return Sides(i, -1 - wall, vector, turn, np.array(axes)[wall])


def joined(*parts: Sides) -> Sides:
    """All sides, one part after the other."""
    return Sides(*map(np.concatenate, zip(*parts, strict=True)))


def soft_sides(packing: Packing) -> tuple[Sides, Floats]:
    """Soft particles and walls that overlap, each contact once, first those of pairs.

    Returns:
        Sides, and the distances at which they open, shape (S,) [length].
    """
    radius = packing.radii
    i, j, shift = near_pairs(packing, 0.0)
    pairs = between(i, j, packing.positions[j] + shift - packing.positions[i])
    sides = joined(pairs, with_walls(packing, 0.0))
    return sides, radius[sides.i] + np.where(sides.j < 0, 0.0, radius[np.maximum(sides.j, 0)])


def bearing(
    i: Integers, j: Integers, force: Floats, number: int, of_rattlers: int = 2
) -> NDArray[np.bool_]:
    """Whether contacts are of the network, or bear a force worth mentioning, shape (S,).

    Args:
        i: particle of each side, both of a contact, shape (S,).
        j: its partner, negative for a wall, shape (S,).
        force: of the contact, shape (S,) [energy/length].
        number: of particles.
        of_rattlers: contacts of a rattler at most.
    """
    size = np.abs(force)  # films may pull
    mean = float(size[size > 0.0].mean()) if size.any() else 0.0
    return without_rattlers(i, j, number, of_rattlers) | (size > _OPEN * mean)


def bears(packing: Packing, table: NDArray[np.void]) -> NDArray[np.bool_]:
    """See `bearing`; both sides of a contact do, if one does."""
    kept = bearing(table["i"], table["j"], table["force"], len(packing), packing.dimension)
    pair = np.flatnonzero(table["j"] >= 0)
    kept[pair] |= kept[pair[other_side(table[pair])]]
    return kept


def other_side(pairs: NDArray[np.void]) -> Integers:
    """The row of the other side of each contact between particles, shape (S,).

    Args:
        pairs: rows with i, j and image, both sides of each contact, sorted by these.
    """
    # in this order the other sides come in the order of their own
    return _order(pairs["j"], pairs["i"], -pairs["image"])


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
        variables: number of local variables of a side; those of its line follow the vector.
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
        for n, sign in enumerate(signs, start=2)
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


# Of rings and sectors in the plane, of droplets in space. Each contact has two rows, one for each
# side; a contact with wall k has one row, with j = -1 - k.
COLUMNS = {
    2: np.dtype(
        [
            ("i", np.int64),
            ("j", np.int64),
            ("image", np.int64, 2),  # periodic image of j in the contact, in lattice vectors
            ("angle", float),  # direction from i to the contact line, normal to it [rad]
            ("distance", float),  # of the centers, or of i from the wall [length]
            ("indentation", float),  # of i [length]
            ("length", float),  # of the contact on i [length]
            ("force", float),  # of this side, dU_i/da [energy/length]
            ("position", float, 2),  # of the contact line's point nearest to i [length]
            ("tilt", float),  # of the line: angle less the direction from i to j [rad]
            ("half_angle", float),  # of the line, an arc: positive where it is convex for i [rad]
            ("force_vector", float, 2),  # on i by the contact; their sum is the force on i
            ("contact_angle", float),  # at which the outline of i meets the film, 0 without [rad]
            ("attached", bool),  # whether it sticks: its force may be negative
        ]
    ),
    3: np.dtype(
        [
            ("i", np.int64),
            ("j", np.int64),
            ("image", np.int64, 3),  # periodic image of j in the contact, in lattice vectors
            ("distance", float),  # of the centers, or of i from the wall [length]
            ("indentation", float),  # of i [length]
            ("facet_radius", float),  # of the facet on i, see `State.contacts` [length]
            ("force", float),  # F, the same from both sides [energy/length]
            ("position", float, 3),  # of the middle of the facet [length]
            ("normal", float, 3),  # of the facet, from i to j
            ("force_vector", float, 3),  # on i by the contact; their sum is the force on i
            ("tilt", float, 3),  # of the film: its normal is normal + tilt
            ("curvature", float),  # of the film, positive where it is convex for i [1/length]
            ("contact_angle", float),  # at which the surface of i meets the film, 0 without [rad]
            ("attached", bool),  # whether it sticks: its force may be negative
        ]
    ),
}

# Those of compute deformable/contact. Its force vector is that of the energy of i alone.
ROWS = {
    2: (
        *("i", "j", "indentation", "length", "force", "x", "y"),
        *("angle", "distance", "tilt", "half_angle", "fx", "fy"),
        *("contact_angle", "attached"),
    ),
    3: (
        *("i", "j", "indentation", "facet_radius", "force"),
        *("x", "y", "z", "nx", "ny", "nz", "distance", "fx", "fy", "fz"),
        *("turn_x", "turn_y", "turn_z", "curvature", "contact_angle", "attached"),
    ),
}
_VECTORS: dict[int, dict[str, Sequence[str]]] = {
    2: {"position": "xy", "force_vector": ("fx", "fy")},
    3: {
        "position": "xyz",
        "normal": ("nx", "ny", "nz"),
        "force_vector": ("fx", "fy", "fz"),
        "tilt": ("turn_x", "turn_y", "turn_z"),
    },
}

ContactTable = NDArray[np.void]


def contact_table(rows: NDArray[np.float64], packing: Packing) -> ContactTable:
    """All contacts, sorted by (i, j, image), with the forces on the particles.

    Arguments as of `sides_of`.
    """
    table = sides_of(rows, packing)
    react(table)
    return table


@dataclass(frozen=True, eq=False)
class Later:
    """The table of contacts, made when it is asked for: most states of a run are never asked.

    Attributes:
        rows: of compute deformable/contact on all ranks, shape (M, len(ROWS[d])).
        packing: centers and box at the same time.
        one_force: whether both sides of a contact have the same one, so that both have rows.
    """

    rows: Floats
    packing: Packing
    one_force: bool

    @cached_property
    def table(self) -> ContactTable:
        """See `contact_table`."""
        table = contact_table(self.rows, self.packing)
        table.setflags(write=False)
        return table

    @property
    def ends(self) -> tuple[Integers, Integers] | None:
        """Its i and j in any order; None where rows lack sides, or may do: ask the table."""
        if not self.one_force:
            return None
        i, j = self.rows[:, :2].T.astype(np.int64)
        i, j, pair = i - 1, np.where(j > 0, j - 1, j), j > 0
        number = len(self.packing)
        here = np.sort(number * i[pair] + j[pair])
        there = np.sort(number * j[pair] + i[pair])
        return (i, j) if np.array_equal(here, there) else None


def sides_of(rows: NDArray[np.float64], packing: Packing) -> ContactTable:
    """Both sides of all contacts, each with the force vector of its own energy.

    Args:
        rows: of compute deformable/contact on all ranks, shape (M, len(ROWS[d])).
        packing: centers and box at the same time, in d dimensions.

    Returns:
        Structured array of `COLUMNS`, with both sides of each pair. In the plane a side without
        force has no row in LAMMPS; here it has one with length and force 0, and the rest of the
        overlap.
    """
    dimension = packing.dimension
    told = dict(zip(ROWS[dimension], rows.T, strict=True))
    table = np.zeros(len(rows), COLUMNS[dimension])
    vectors = _VECTORS[dimension]
    for name in told.keys() & set(table.dtype.names or ()) - vectors.keys():
        table[name] = told[name]
    for name, columns in vectors.items():
        table[name] = np.column_stack([told[column] for column in columns])
    # IDs count from 1; wall k is -1 - k
    table["i"] -= 1
    pair = table["j"] > 0
    table["j"][pair] -= 1
    # an exact integer, equal for both sides in spite of rounding
    i, j = table["i"][pair], table["j"][pair]
    to_j = table["distance"][pair, None] * to_partner(table[pair])
    apart = packing.positions[i] + to_j - packing.positions[j]
    table["image"][pair] = np.rint(fractional(apart, packing.box)).astype(np.int64)
    if dimension == 2:
        table = np.concatenate([table, _missing_sides(table[pair], packing)])
    return in_order(table)


def to_partner(sides: ContactTable) -> Floats:
    """Directions from i to the center of j, or to the wall, shape (S, d)."""
    if "normal" in (sides.dtype.names or ()):
        return sides["normal"]
    return unit_vectors(sides["angle"] - sides["tilt"])


def react(table: ContactTable) -> None:
    """Add to the force vector of each side the opposite of that of the other side."""
    pair = table["j"] >= 0
    both = table["force_vector"][pair]
    table["force_vector"][pair] -= both[other_side(table[pair])]


def attached(rows: NDArray[np.float64], dimension: int) -> NDArray[np.int64]:
    """The contacts that stick, sorted, see `State.films`; a wall has its code for an ID."""
    told = dict(zip(ROWS[dimension], rows.astype(np.int64).T, strict=True))
    partner = np.where(told["attached"] < 0, told["attached"], told["j"])
    first = (told["attached"] < 0) | (told["attached"] > 0) & (told["i"] <= told["j"])
    pairs = np.column_stack([told["i"], partner])[first]
    found, count = np.unique(pairs, axis=0, return_counts=True)
    i, j = found.T
    # of a film with its own image a particle has both sides
    return np.repeat(found, np.where(j < 0, 1, np.where(i == j, count // 2, count)), axis=0)


def in_order(table: ContactTable) -> ContactTable:
    """The sides sorted by (i, j, image)."""
    return table[_order(table["i"], table["j"], table["image"])]


def _order(i: Integers, j: Integers, image: Integers) -> Integers:
    """Indices that sort sides by (i, j, image)."""
    return np.lexsort((*image.T[::-1], j, i))


def _missing_sides(pairs: ContactTable, packing: Packing) -> ContactTable:
    """The other side of each contact with a force on one side only."""
    here, there, image = pairs["i"], pairs["j"], pairs["image"]
    # each side, and the one that it looks for; equal ones follow each other in this order
    i, j = np.concatenate([here, there]), np.concatenate([there, here])
    images = np.concatenate([image, -image])
    order = _order(i, j, images)
    sorted_keys = np.column_stack([i, j, images])[order]
    number = np.zeros(len(order), np.int64)
    number[order[1:]] = np.cumsum((sorted_keys[1:] != sorted_keys[:-1]).any(axis=1))
    sides = pairs[~np.isin(number[len(pairs) :], number[: len(pairs)])]
    overlap = packing.radii[sides["i"]] + packing.radii[sides["j"]] - sides["distance"]
    sides["i"], sides["j"] = sides["j"].copy(), sides["i"].copy()
    sides["image"] *= -1
    sides["angle"] += np.where(sides["angle"] > 0.0, -np.pi, np.pi)
    sides["indentation"] = overlap - sides["indentation"]
    sides["position"] += sides["image"] @ packing.box
    sides["length"] = sides["force"] = sides["force_vector"] = 0.0
    return sides


def soft_columns(dimension: int) -> np.dtype[np.void]:
    """Columns of the table of soft contacts, with both sides of each; wall k has j = -1 - k."""
    return np.dtype(
        [
            ("i", np.int64),
            ("j", np.int64),
            ("image", np.int64, dimension),  # periodic image of j, in lattice vectors
            ("distance", float),  # of the centers, or of i from the wall [length]
            ("indentation", float),  # of i, half of the overlap with a particle [length]
            ("force", float),  # k times the overlap [energy/length]
            ("position", float, dimension),  # the middle of the overlap [length]
            ("normal", float, dimension),  # from i to j
            ("force_vector", float, dimension),  # on i by the contact
        ]
    )


# Both sides of each contact of two polygons.
POLYGON_COLUMNS = np.dtype(
    [
        ("i", np.int64),
        ("j", np.int64),
        ("image", np.int64, 2),  # periodic image of j in the contact, in lattice vectors
        ("force", float),  # [energy/length]
        ("force_vector", float, 2),  # on i by the contact; their sum is the force on i
    ]
)


def soft_table(packing: Packing, k: float) -> ContactTable:
    """Overlaps of soft particles of this stiffness with each other and walls."""
    sides, contact = soft_sides(packing)
    pair = sides.j >= 0
    i = np.append(sides.i, sides.j[pair])
    table = np.zeros(len(i), soft_columns(packing.dimension))
    table["i"], table["j"] = i, np.append(sides.j, sides.i[pair])
    vector = np.concatenate([sides.vector, -sides.vector[pair]])
    table["distance"] = distance = lengths(vector)
    overlap = np.append(contact, contact[pair]) - distance
    table["indentation"] = np.where(table["j"] < 0, overlap, 0.5 * overlap)
    table["force"] = k * overlap
    table["normal"] = vector / distance[:, None]
    within = packing.radii[i] - table["indentation"]
    table["position"] = packing.positions[i] + within[:, None] * table["normal"]
    table["force_vector"] = -table["force"][:, None] * table["normal"]
    both = table["j"] >= 0
    apart = packing.positions[i[both]] + vector[both] - packing.positions[table["j"][both]]
    table["image"][both] = np.rint(fractional(apart, packing.box)).astype(np.int64)
    return in_order(table)


# Columns of the table where contacts rub, which edges of the graph have too.
_OF_EDGES = ("friction", "sliding")


class ContactForces(NamedTuple):
    """All active contacts, each once.

    Attributes:
        i: a particle, shape (M,).
        j: the other one, not below i; -1 for a wall, shape (M,).
        vector: from the center of i to that of j, or to the point of the wall, shape (M, d)
            [length].
        part: of the vector that is within i: up to the contact line, 1 for a wall, shape (M,).
        force: on i, shape (M, d) [energy/length].
        rubbing: `friction` and `sliding` of each by name, see `friction.rubbing_columns`; of
            contacts that slip freely none.
    """

    i: Integers
    j: Integers
    vector: Floats
    part: Floats
    force: Floats
    rubbing: Mapping[str, NDArray[Any]] = {}

    @property
    def distance(self) -> Floats:
        """Of the centers, or of the center from the wall, shape (M,) [length]."""
        return lengths(self.vector)

    @property
    def push(self) -> Floats:
        """Force along the line of centers, positive where it pushes, (M,) [energy/length]."""
        return -np.sum(self.force * self.vector, axis=1) / self.distance


def forces_of(state: State) -> ContactForces:
    """The forces of all active contacts of a state."""
    if isinstance(state.law, SoftContact):
        return soft_forces(state.packing, state.law.k)
    if state.polygons is not None:
        return polygon_forces(state.packing, state.contacts)
    return forces_of_table(state.packing, state.contacts)


def soft_forces(packing: Packing, k: float) -> ContactForces:
    """Those of soft contacts of this stiffness."""
    sides, contact = soft_sides(packing)
    distance = sides.distance
    overlap, wall = contact - distance, sides.j < 0
    part = np.where(wall, 1.0, (packing.radii[sides.i] - 0.5 * overlap) / distance)
    force = -k * (overlap / distance)[:, None] * sides.vector
    return ContactForces(sides.i, np.maximum(sides.j, -1), sides.vector, part, force)


def polygon_forces(packing: Packing, table: ContactTable) -> ContactForces:
    """Those of polygons: between the centers, half of the distance within each."""
    rows = table[table["i"] < table["j"]]
    i, j = rows["i"], rows["j"]
    vector = packing.positions[j] + rows["image"] @ packing.box - packing.positions[i]
    return ContactForces(i, j, vector, np.full(len(i), 0.5), rows["force_vector"])


def forces_of_table(packing: Packing, table: ContactTable) -> ContactForces:
    """Those of rings, sectors and droplets."""
    i, j = table["i"], table["j"]
    rows = table[(i < j) | (j < 0) | ((i == j) & forward(table["image"]))]
    within, distance = packing.radii[rows["i"]] - rows["indentation"], rows["distance"]
    if packing.dimension == 2:
        within /= np.cos(rows["tilt"])
    return ContactForces(
        i=rows["i"],
        j=np.maximum(rows["j"], -1),
        vector=distance[:, None] * to_partner(rows),
        part=np.where(rows["j"] < 0, 1.0, within / distance),
        force=rows["force_vector"],
        rubbing={name: rows[name] for name in _OF_EDGES if name in (table.dtype.names or ())},
    )


def particle_stress(contacts: ContactForces, area: Floats) -> Floats:
    """See `State.particle_stress`.

    Args:
        contacts: of the state.
        area: of each particle, or its volume, shape (N,) [length^d].
    """
    moment = -contacts.vector[:, :, None] * contacts.force[:, None, :]
    moment = 0.5 * (moment + np.swapaxes(moment, 1, 2))
    pair, part = contacts.j >= 0, contacts.part[:, None, None]
    total = np.zeros((len(area), *moment.shape[1:]))
    np.add.at(total, contacts.i, part * moment)
    np.add.at(total, contacts.j[pair], ((1.0 - part) * moment)[pair])
    return total / area[:, None, None]


def graph(packing: Packing, contacts: ContactForces, rattlers: NDArray[np.bool_]) -> Any:
    """See `State.graph`."""
    networkx = optional("networkx", "networkx")
    found = networkx.MultiGraph()
    axes = "xyz"[: packing.dimension]
    names = (*axes, "radius", "species", "rattler")
    columns = (*packing.positions.T, packing.radii, packing.species, rattlers)
    for n, values in enumerate(zip(*(column.tolist() for column in columns), strict=True)):
        found.add_node(n, **dict(zip(names, values, strict=True)))
    steps = {f"d{axis}": step for axis, step in zip(axes, contacts.vector.T, strict=True)}
    of_edges = {"force": contacts.push, "distance": contacts.distance, **steps, **contacts.rubbing}
    ends = (contacts.i, contacts.j)
    for i, j, *edge in zip(*(row.tolist() for row in (*ends, *of_edges.values())), strict=True):
        found.add_edge(i, j, **dict(zip(of_edges, edge, strict=True)))
    return found


def halves(packing: Packing, contacts: ContactForces) -> list[tuple[Floats, Floats]]:
    """For each disk, where its contacts are in the middle of their overlaps, and their forces."""
    disk, _, vector, part = _sides(contacts)
    push = np.hypot(*contacts.force.T)
    ends = packing.positions[disk] + part[:, None] * vector
    forces = np.append(push, push[contacts.j >= 0])
    number = len(packing)
    return list(zip(_of_each(disk, number, ends), _of_each(disk, number, forces), strict=True))


def chords(packing: Packing, contacts: ContactForces) -> list[list[Floats]]:
    """For each disk, the lines on which its circle crosses those of others, and walls.

    At the distance d of the centers it is (d^2 + R^2 - R'^2)/(2 d) from the center of R.
    """
    disk, other, vector, _ = _sides(contacts)
    radius, d = packing.radii, np.hypot(*vector.T)
    r = radius[disk]
    height = np.where(other < 0, d, (d**2 + r**2 - radius[np.maximum(other, 0)] ** 2) / (2.0 * d))
    out = vector / d[:, None]
    along = np.sqrt(np.maximum(r**2 - height**2, 0.0))[:, None] * (out[:, ::-1] * [-1.0, 1.0])
    middle = packing.positions[disk] + height[:, None] * out
    lines = np.stack([middle - along, middle + along], axis=1)
    return [list(each) for each in _of_each(disk, len(packing), lines)]


# Points of an outline closer to the chord of a contact than this, over R, are its ends: forces are
# balanced to 1e-8, and an arc has left the line within 1e-4 R.
_ON_LINE = 1e-7


def flats_of(
    outlines: Sequence[Floats], radii: Floats, contacts: Sequence[ContactTable]
) -> list[list[Floats]]:
    """The part of each outline at its contacts, a straight line or an arc, arrays (m, 2)."""
    flats: list[list[Floats]] = []
    for outline, radius, table in zip(outlines, radii, contacts, strict=True):
        table = table[table["length"] > 0.0]
        out = np.column_stack([np.cos(table["angle"]), np.sin(table["angle"])])
        half = 0.5 * table["length"] * np.sinc(table["half_angle"] / np.pi)  # of the chord
        height = np.sum(table["position"] * out, axis=1) - half * np.tan(0.5 * table["half_angle"])
        inward = height - outline @ out.T
        along = outline @ (out[:, ::-1] * [-1.0, 1.0]).T
        flats.append([])
        for off, place in zip(np.abs(inward).T, along.T, strict=True):
            if (on := np.flatnonzero(off <= _ON_LINE * radius)).size:
                begin, end = on[place[on].argmin()], on[place[on].argmax()]
                flats[-1].append(np.roll(outline, -begin, 0)[: (end - begin) % len(outline) + 1])
    return flats


def _sides(contacts: ContactForces) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats, Floats]:
    """Disk, other one, vector and part of both sides of contacts, see `ContactForces`."""
    i, j, vector, part, *_ = contacts
    pair = j >= 0
    return (
        np.append(i, j[pair]),
        np.append(j, i[pair]),
        np.concatenate([vector, -vector[pair]]),
        np.append(part, 1.0 - part[pair]),
    )


def _of_each(disk: NDArray[np.int64], number: int, values: Floats) -> list[NDArray[Any]]:
    """The values of the sides of each disk."""
    order = np.argsort(disk, kind="stable")
    return np.split(values[order], np.searchsorted(disk[order], np.arange(1, number)))


def without_rattlers(
    i: NDArray[np.int64], j: NDArray[np.int64], number: int, at_most: int = 2
) -> NDArray[np.bool_]:
    """Whether contacts remain after rattlers are removed one after another, shape (M,).

    Args:
        i: particle of each side of a contact, shape (M,).
        j: its partner, negative for a wall, shape (M,).
        number: of particles.
        at_most: contacts of a rattler.
    """
    remaining = np.ones(len(i), dtype=bool)
    while True:
        z = np.bincount(i[remaining], minlength=number)
        rigid = np.append(z > at_most, True)  # the last one is for walls
        kept = remaining & rigid[i] & rigid[np.maximum(j, -1)]
        if (kept == remaining).all():
            return kept
        remaining = kept


def isostatic(rigid: int, walls: Sequence[Wall], dimension: int, rubs: bool) -> int:
    """See `State.isostatic_contacts`, of so many particles that are no rattlers."""
    if rubs:
        free = 0 if walls else dimension
        motions = 3 if dimension == 2 else 6
        return (motions * rigid + dimension - free) // dimension if rigid else 0
    return max(dimension * rigid + 1 - free_motions(walls, dimension), 0) if rigid else 0


def excess_coordination(
    packing: Packing, contacts: ContactForces, of_rattlers: int, rubs: bool, threshold: float
) -> float:
    """See `State.excess_coordination`."""
    size = len(packing), of_rattlers
    i, j, strength = contacts.i, contacts.j, lengths(contacts.force)
    kept = _network(i, j, *size)
    if zero_or_more("threshold", threshold) > 0.0 and kept.any():
        counts = strength >= threshold * strength[kept].mean()
        i, j = i[counts], j[counts]
        kept = _network(i, j, *size)
    i, j = i[kept], j[kept]
    rigid = len(np.unique(np.append(i, j[j >= 0])))
    if not rigid:
        return 0.0
    return 2.0 * (len(i) - isostatic(rigid, packing.walls, packing.dimension, rubs)) / rigid


def _network(
    i: NDArray[np.int64], j: NDArray[np.int64], number: int, at_most: int
) -> NDArray[np.bool_]:
    """As `without_rattlers`, of contacts that are listed once."""
    pair = j >= 0
    sides = np.append(i, j[pair]), np.append(j, i[pair])
    return without_rattlers(*sides, number, at_most)[: len(i)]

"""What the energy of a packing at rest depends on: its blocks, and tables of parameters.

The energy E(z, t) is a sum over local variables q(z, t) of contacts and particles, in the blocks of
the `Hessian`, where z are the centers and the lines or forces of contacts, and t parameters:

    g = E_q,    E_t = g q_t,    E_zt = q_z^T (E_qq q_t + g_t)

with the explicit dependence g_t of the blocks on t. So a parameter is a table of q_t and g_t, a
quantity one of what multiplies changes of g and of q, and a law is such tables.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.box import fractional
from ..particles.containers import box_between, closed, free_room
from ..particles.laws import volumes
from ..particles.walls import Cone, Cylinder, Wall
from .contacts import Sides
from .hessian_matrix import Hessian

if TYPE_CHECKING:
    from ..particles.packing import Packing
    from .state import State

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class Parameter(NamedTuple):
    """How k numbers enter.

    Attributes:
        shape: of the numbers.
        local: q_t, sparse, shape (V, k).
        explicit: g_t, sparse, shape (V, k).
        energy: dE/dt where z and q stay, shape (k,).
        on_centers: dE_z/dt where z and q stay, sparse, shape (Z, k).
    """

    shape: tuple[int, ...]
    local: Any
    explicit: Any
    energy: Floats
    on_centers: Any


class Quantity(NamedTuple):
    """Numbers that change by by_gradient dg + by_local dq + by_variables dz + explicit[t] dt.

    Attributes:
        shape: of the m numbers.
        by_gradient: sparse, shape (m, V).
        by_local: sparse, shape (m, V).
        by_variables: sparse, shape (m, Z).
        explicit: by name of the parameter, sparse, shape (m, k), or a function that returns it.
    """

    shape: tuple[int, ...]
    by_gradient: Any
    by_local: Any
    by_variables: Any
    explicit: Mapping[str, Any]


class Blocks(NamedTuple):
    """Energy, gradient, and rows, columns and values of second derivatives, by local variables."""

    energy: float
    gradient: Floats
    entries: tuple[Any, Any, Any]

    @classmethod
    def of(cls, blocks: Any, factor: float = 1.0) -> Blocks:
        """Those of `core`, times a factor."""
        row, column, value = blocks.hessian()
        entries = row, column, factor * value
        return cls(factor * blocks.energy, factor * blocks.gradient, entries)

    def hessian(self) -> tuple[Any, Any, Any]:
        """As of `core.EnergyBlocks`."""
        return self.entries


@dataclass
class Terms:
    """The blocks of a packing at rest, and what depends on which parameters.

    Attributes:
        hessian: M, and E_z.
        local: E_qq, sparse, shape (V, V).
        gradient: g, shape (V,).
        chain: q_z, sparse, shape (V, Z).
        sides: of the contacts, S.
        vectors: local variables that are the vectors of the sides, shape (S, d).
        parameters: by name.
        forces: of the sides, shape (S,) [energy/length].
        follow: how all local variables follow those of the sides; None if they do not.
        quantities: by name.
    """

    hessian: Hessian
    local: Any
    gradient: Floats
    chain: Any
    sides: Sides
    vectors: Integers
    forces: Floats
    follow: Any = None
    parameters: dict[str, Parameter] = field(default_factory=dict)
    quantities: dict[str, Quantity] = field(default_factory=dict)

    @classmethod
    def of(
        cls, packing: Packing, blocks: Blocks, chain: Any, strains: Floats, sides: Sides, first: Any
    ) -> Terms:
        """See `Hessian`; `first` are the first of the local variables `vectors`, shape (S,).

        Forces come later.
        """
        hessian = Hessian(packing, blocks, chain, strains)
        row, column, value = blocks.entries
        local = sparse(value, row, column, (len(strains),) * 2)
        vectors = first[:, None] + np.arange(packing.dimension)
        return cls(hessian, local, blocks.gradient, chain, sides, vectors, np.empty(0))

    def by_local(self, values: Any, rows: Any, columns: Any, width: int) -> Any:
        """A sparse matrix with a row for each local variable."""
        return sparse(values, rows, columns, (len(self.gradient), width))

    def by_vectors(self, values: Any, rows: Any, columns: Any, width: int) -> Any:
        """The same for changes of `vectors`, which other local variables may follow."""
        moved = self.by_local(values, rows, columns, width)
        return moved if self.follow is None else self.follow @ moved

    @property
    def pull(self) -> Floats:
        """Derivatives of the energy by local variables that others follow, shape (V,)."""
        return self.gradient if self.follow is None else self.follow.T @ self.gradient

    def of_local(self, values: Any, rows: Any, columns: Any, size: int) -> Any:
        """A sparse matrix with a column for each local variable."""
        return sparse(values, rows, columns, (size, len(self.gradient)))

    def parameter(
        self,
        name: str,
        shape: tuple[int, ...],
        local: Any = None,
        explicit: Any = None,
        energy: Any = 0.0,
        on_centers: Any = None,
    ) -> None:
        """Add one; what is not given is 0."""
        count, (V, Z) = int(np.prod(shape)), self.chain.shape
        local, explicit = _or_zero(local, (V, count)), _or_zero(explicit, (V, count))
        energy = np.broadcast_to(np.asarray(energy, float), count)
        self.parameters[name] = Parameter(
            shape, local, explicit, energy, _or_zero(on_centers, (Z, count))
        )

    def quantity(
        self,
        name: str,
        shape: tuple[int, ...],
        by_gradient: Any = None,
        by_local: Any = None,
        by_variables: Any = None,
        explicit: Mapping[str, Any] | None = None,
    ) -> None:
        """Add one; what is not given is 0."""
        count, (V, Z) = int(np.prod(shape)), self.chain.shape
        self.quantities[name] = Quantity(
            shape,
            _or_zero(by_gradient, (count, V)),
            _or_zero(by_local, (count, V)),
            _or_zero(by_variables, (count, Z)),
            explicit or {},
        )


def sparse(values: Any, rows: Any, columns: Any, shape: tuple[int, int]) -> Any:
    from scipy.sparse import csr_matrix

    values, rows, columns = (each.ravel() for each in np.broadcast_arrays(values, rows, columns))
    return csr_matrix((values.astype(float), (rows, columns)), shape=shape)


def _or_zero(given: Any, shape: tuple[int, int]) -> Any:
    from scipy.sparse import csr_matrix

    return csr_matrix(shape) if given is None else given.tocsr()


def diagonal(values: Floats) -> Any:
    from scipy.sparse import diags

    return diags(values).tocsr()


def volumes_of_radii(packing: Packing, terms: Terms) -> None:
    """Add volumes that do not change but with the radii."""
    surface = packing.dimension * volumes(packing.radii, packing.dimension) / packing.radii
    terms.quantity("volumes", (len(packing),), explicit={"radii": diagonal(surface)})


def with_places(
    state: State, terms: Terms, force: tuple[Any, Any], angles: Integers | None = None
) -> Terms:
    """Add walls, box and gravity; energy, positions, forces and pressure.

    Args:
        state: at rest.
        terms: to which they are added.
        force: of each side, by changes of g and q, sparse, shape (S, V) each.
        angles: local variables that are angles of the normal of a side, about each of the axes
            about which a wall turns, shape (S, axes).
    """
    packing, sides, rows = state.packing, terms.sides, terms.vectors
    number, dimension, walls = len(packing), packing.dimension, len(packing.walls)
    axes, size = np.arange(dimension), dimension * number
    image, g = _images(packing, sides), terms.pull[terms.vectors]
    turns = _turns(dimension)
    spins = len(turns)

    wall = np.flatnonzero(sides.j < 0)
    of_wall = -1 - sides.j[wall]
    columns = dimension * of_wall[:, None] + axes
    moved = terms.by_vectors(1.0, rows[wall], columns, dimension * walls)
    terms.parameter("walls", (walls, dimension), moved)

    def turned(vectors: Floats) -> tuple[Any, Any, Any, int]:
        """W u for each wall side's u, by the angles of the walls."""
        entries = np.einsum("kab,sb->sak", turns, vectors)
        columns = spins * of_wall[:, None, None] + np.arange(spins)
        return entries, rows[wall][:, :, None], columns, spins * walls

    # a wall that turns about its middle is, seen from the wall, a particle that turns back
    out = packing.positions[sides.i[wall]] - image[wall] @ packing.box - _middles(packing)[of_wall]
    local = terms.by_vectors(*turned(out))
    if angles is not None and len(wall):
        columns = spins * of_wall[:, None] + np.arange(spins)
        local += terms.by_vectors(1.0, angles[wall], columns, spins * walls)
    shape = (walls,) if dimension == 2 else (walls, spins)
    # planes along which the box is periodic cannot turn, nor cylinders and cones
    enclosed = all(closed(packing.walls, dimension)) or not any(w.inside for w in packing.walls)
    upright = any(isinstance(wall, Cylinder | Cone) for wall in packing.walls)
    if enclosed and not upright:
        terms.parameter("wall_angles", shape, local, terms.by_local(*turned(g[wall])))

    columns = dimension * axes[:, None] + axes
    steps = image[:, :, None] * (axes[:, None] >= axes)  # the box has no others
    boxed = terms.by_vectors(steps, rows[:, None, :], columns, dimension**2)
    terms.parameter("box", (dimension, dimension), boxed)

    gravity = state.gravity if state.gravity is not None else np.zeros(dimension)
    kind = packing.species if gravity.ndim == 2 else np.zeros(number, int)
    of_gravity = dimension * kind[:, None] + axes
    of_weight = terms.chain.shape[1], gravity.size
    weight = sparse(-1.0, np.arange(size), of_gravity.ravel(), of_weight)
    place = packing.positions + (0.0 if state.images is None else state.images @ packing.box)
    terms.parameter(
        "gravity", gravity.shape, energy=weight[:size].T @ place.ravel(), on_centers=weight
    )

    terms.quantity("energy", ())
    own = np.arange(size)
    centers = sparse(1.0, own, own, (size, terms.chain.shape[1]))
    terms.quantity("positions", (number, dimension), by_variables=centers)
    row = _rows(state, sides, image)
    of_row = (None if each is None else row @ each for each in force)
    terms.quantity("forces", (len(state.contacts),), *of_row)

    _add_pressure(packing, terms, angles)
    return terms


def _add_pressure(packing: Packing, terms: Terms, angles: Integers | None) -> None:
    """Add the pressure and its tensor, minus the derivative by a strain e of particles and walls.

    Vectors v to neighbors change by e v. A wall at the distance h, with the normal n toward it, is
    shifted and turns: for its side v changes by e v + h (1 - n n) e^T n, and n turns by -(1 - n n)
    e^T n.
    """
    sides, number, dimension = terms.sides, len(terms.sides.i), packing.dimension
    room, unit, turns = packing.volume, np.eye(dimension), _turns(dimension)
    walls, spins, wall = len(packing.walls), len(turns), terms.sides.j < 0
    g, h = terms.pull[terms.vectors], sides.distance[:, None, None]
    n = sides.vector / h[:, 0]
    torque = np.zeros((number, spins))
    if angles is not None and walls:
        torque = np.where(wall[:, None], terms.pull[angles], 0.0)

    def both(part: str, *given: Floats) -> Floats:
        """Symmetric in a and b, (S, ab, ...)."""
        found = np.einsum(part, *given)
        found = 0.5 * (found + found.swapaxes(1, 2))
        return found.reshape(number, dimension**2, *found.shape[3:])

    on_wall = wall[:, None, None]
    by_g = both("sa,bc->sabc", sides.vector, unit)
    more = by_g - both("sa,sb,sc->sabc", sides.vector, n, n)
    by_g += np.where(on_wall, more, 0.0)
    by_torque = np.where(on_wall, -both("sa,kbc,sc->sabk", n, turns, n), 0.0)

    along, near = np.sum(n * g, axis=1), _to_nearest(sides)
    by_normal = 2.0 * (both("sb,ac->sabc", g, unit) - both("s,sb,ac->sabc", along, n, unit))
    by_normal = h * (by_normal - both("sa,sb,sc->sabc", n, n, g))
    by_normal -= both("sk,kbd,sd,ac->sabc", torque, turns, n, unit)
    by_normal -= both("sk,sa,kbc->sabc", torque, n, turns)
    by_height = 2.0 * both("sa,sb->sab", n, g) - both("s,sa,sb->sab", along, n, n)
    turn = (near - n[:, :, None] * n[:, None, :]) / h
    to_wall = by_normal @ turn + by_height[:, :, None] * n[:, None, :]
    by_v = np.where(on_wall, to_wall, both("sb,sac->sabc", g, near))

    row, count = np.arange(dimension**2)[:, None], dimension**2
    by_gradient = terms.of_local(by_g / -room, row, terms.vectors[:, None], count)
    by_vector = terms.of_local(by_v / -room, row, terms.vectors[:, None], count)
    if angles is not None and walls:
        by_gradient += terms.of_local(by_torque / -room, row, angles[:, None], count)
        if spins > 1:  # a torque is by turns after those that are variables
            after = 0.5 * np.einsum("smk,lkn,sn->sml", by_torque, turns, torque)
            by_vector += terms.of_local(after / -room, row, angles[:, None], count)
    if terms.follow is not None:
        by_gradient = by_gradient @ terms.follow.T
    stress = by_gradient @ terms.gradient

    turning = np.zeros((walls, count, spins))
    spun = np.einsum("smc,kcd,sd->smk", by_normal, turns, n)
    np.add.at(turning, -1 - sides.j[wall], spun[wall])
    turned_walls = turning.transpose(1, 0, 2).reshape(count, -1)

    def by_room(name: str, weights: Any) -> Callable[[], Any]:
        def found() -> Any:
            change = np.outer(stress, _room_change(packing, name))
            if name == "wall_angles":
                change += turned_walls
            return weights @ _csr(change / -room)

        return found

    def add(name: str, shape: tuple[int, ...], weights: Any) -> None:
        explicit = {by: by_room(by, weights) for by in ("walls", "wall_angles", "box")}
        terms.quantity(name, shape, weights @ by_gradient, weights @ by_vector, explicit=explicit)

    add("pressure_tensor", unit.shape, sparse(1.0, row, row, (count, count)))
    add("pressure", (), sparse(unit.ravel() / dimension, 0, row[:, 0], (1, count)))


def _to_nearest(sides: Sides) -> Floats:
    """Change of each vector by its local variables, shape (S, d, d).

    These are steps of a particle, with which the nearest point of a wall moves along it.
    """
    distance, unit = sides.distance[:, None], np.eye(sides.vector.shape[1])
    n = sides.vector / distance
    out = n - np.sum(n * sides.axis, axis=1)[:, None] * sides.axis  # across the axis
    size = np.linalg.norm(out, axis=1)[:, None]
    out = np.divide(out, size, out=np.zeros_like(out), where=size > 0.0)
    turns = unit - sum(a[:, :, None] * a[:, None, :] for a in (sides.axis, out))
    lever = (sides.turn[:, None] * distance)[:, :, None]
    moved: Floats = n[:, :, None] * n[:, None, :] + lever * turns
    return moved


def _csr(values: Floats) -> Any:
    from scipy.sparse import csr_matrix

    return csr_matrix(values)


def _turns(dimension: int) -> Floats:
    """W of a turn about each axis, W x = axis x x in space, shape (axes, d, d)."""
    if dimension == 2:
        return np.array([[[0.0, -1.0], [1.0, 0.0]]])
    return np.cross(np.eye(3)[:, None], np.eye(3)).transpose(0, 2, 1)


def _middles(packing: Packing) -> Floats:
    """Points about which walls turn, shape (number of walls, d) [length]."""
    found = [wall._middle for wall in packing.walls]
    return np.array(found).reshape(-1, packing.dimension)


def _images(packing: Packing, sides: Sides) -> Floats:
    """Image of the neighbor of each side, or of a wall that repeats, in lattice vectors, (S, d)."""
    wall = sides.j < 0
    there = np.zeros_like(sides.vector)
    there[~wall] = packing.positions[sides.j[~wall]]
    there[wall] = _middles(packing)[-1 - sides.j[wall]]
    apart = packing.positions[sides.i] - there + np.where(wall[:, None], 0.0, sides.vector)
    shut = np.array(closed(packing.walls, packing.dimension))
    found: Floats = np.where(shut, 0.0, np.rint(fractional(apart, packing.box)))
    return found


def _rows(state: State, sides: Sides, image: Floats) -> Any:
    """Which row of `State.contacts` each side is, sparse, shape (rows, S).

    A contact that has one side here has two rows, of a wall one.
    """
    table, pair = state.contacts, sides.j >= 0
    here = np.column_stack([sides.i, sides.j, np.where(pair[:, None], image, 0)])
    there = np.column_stack([sides.j, sides.i, -image])[pair]
    rows = np.column_stack([table["i"], table["j"], table["image"]])
    rows[table["j"] < 0, 2:] = 0
    keys = np.concatenate([rows, here, there]).astype(np.int64)
    _, key = np.unique(keys, axis=0, return_inverse=True)
    row = np.full(len(keys), -1)
    row[key.ravel()[: len(rows)]] = np.arange(len(rows))
    side = np.append(np.arange(len(sides.i)), np.flatnonzero(pair))
    found = row[key.ravel()[len(rows) :]]
    _, once = np.unique(np.append(found, -1), return_index=True)  # a row that both ends are
    once = once[once < len(found)]
    once = once[found[once] >= 0]
    return sparse(1.0, found[once], side[once], (len(rows), len(sides.i)))


# Step of differences of the room between walls, in lengths of the box. Their error is of the fourth
# order: they are exact between flat walls that move.
_STEP = 1e-2


def _room_change(packing: Packing, name: str) -> Floats:
    """Derivatives of the area or volume that walls leave, by `walls`, `wall_angles` or `box`."""
    walls, box, dimension = packing.walls, packing.box, packing.dimension
    size, still = float(box.diagonal().min()), np.eye(dimension)
    shut = closed(walls, dimension)

    def with_wall(k: int, turn: Floats, shift: Floats) -> float:
        new = (*walls[:k], _moved(walls[k], turn, shift), *walls[k + 1 :])
        return free_room(new, box_between(new, box))

    def stretched(axis: int, step: float) -> float:
        return free_room(walls, box + step * np.diag(still[axis]))

    rooms: list[Callable[[float], float]] = []
    if name == "walls":
        for k, axis in product(range(len(walls)), still):
            rooms.append(partial(lambda k, axis, s: with_wall(k, still, s * axis), k, axis))
    elif name == "wall_angles":
        from scipy.linalg import expm

        for k, turn in product(range(len(walls)), _turns(dimension)):
            rooms.append(partial(lambda k, w, s: with_wall(k, expm(s * w), 0.0 * w[0]), k, turn))
    else:
        for a, b in product(range(dimension), repeat=2):
            moves = a == b and not shut[a]
            rooms.append(partial(stretched, a) if moves else lambda _: 0.0)
    h = _STEP if name == "wall_angles" else _STEP * size
    changes = []
    for room in rooms:
        near, far = ((room(s) - room(-s)) / (2.0 * s) for s in (h, 2.0 * h))
        changes.append((4.0 * near - far) / 3.0)
    return np.array(changes)


# Attributes of walls that are points.
_POINTS = ("origin", "tip", "a", "b", "corners")


def _moved(wall: Wall, turn: Floats, shift: Floats) -> Wall:
    """The wall after a turn about its middle, and a shift."""
    middle = wall._middle
    changes: dict[str, Any] = {}
    for each in fields(wall):
        value = getattr(wall, each.name)
        if each.name in _POINTS:
            points = np.broadcast_to(value, np.shape(value) or middle.shape)
            moved = (points - middle) @ turn.T + middle + shift
            changes[each.name] = tuple(map(tuple, moved)) if moved.ndim == 2 else tuple(moved)
        elif each.name == "normal":
            changes[each.name] = tuple(turn @ np.array(value))
    return replace(wall, **changes)

"""The exact shapes of droplets by finite elements: of one between planes, and of whole packings.

A droplet of tension 1 and volume V about its center, with r = exp(rho) in the direction u, has the
least area A behind its films,

    A = sum |x_i x x_j + x_j x x_k + x_k x x_i|/2,    V = sum x_i.(x_j x x_k)/6

over the flat triangles between nodes x = exp(rho) u. The film of a pair is one surface for both
droplets, a graph over the plane across the line of centers n: with x = z n + y from a center,

    z <= h + b.y + y.S y/2        height h, tilt b and curvature S: six numbers q

Planes are given. Films between droplets are found, so that neither droplet nor film is unbalanced.

1. `_Drop.settle`, behind films that are given: Newton's method finds rho, the pressure p, and which
   nodes lie on films (a primal-dual active set: Hintermueller, Ito, Kunisch, SIAM J. Optim. 13, 865
   (2002)). Films push by -dA/dq; what pushes h is their force F.
2. `_relax`: Newton's method finds the films of all droplets together. Each droplet adds d2A/dq2 of
   its films, in which the nodes follow.
3. `_solve`: meshes are fine at the rims of facets. Each level halves all edges, and what levels
   tell is extrapolated, as errors fall with the square of the edges.
"""

from __future__ import annotations

import math
import time
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import bmat, csc_matrix, csr_matrix
from scipy.sparse.linalg import splu
from scipy.spatial import ConvexHull

from ..common.box import fractional, lengths
from ..particles.laws import Droplet
from ..particles.neighbors import near_pairs
from ..state.state import State
from . import exact_films
from .exact_films import VOLUME, extrapolated, spiral

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]

# Nodes of the first mesh of a droplet, and how often it is refined at the rims of facets: of one
# alone, and of each in a packing; then at small facets. After that all edges are halved twice.
ALONE, PACKED, SMALL, HALVED = (1500, 2), (400, 1), 4, 2

# What is left of an energy after the square falls with the third power of the edges at rims and the
# fourth elsewhere: of what the last level changes, between 1/7 and 1/15.
LEFT, LEFT_ERROR = (1.0 / 7.0 + 1.0 / 15.0) / 2.0, (1.0 / 7.0 - 1.0 / 15.0) / 2.0

# Stiffness against shifts of a droplet that its films allow, and of films that nothing touches: in
# steps alone, not in what is solved.
_HOLD, _HOLD_FILM = 1e-4, 1e-7

# Pairs may get a film while their gap is below this part of the largest diameter.
_NEAR = 0.1

# Least cosine between a node and the line of centers of its film.
_ASIDE = 0.25

_ITERATIONS, _LARGEST_STEP, _SMALLEST_STEP = 100, 0.3, 1e-7

# Of films: what the last step gains, and the largest change of their numbers.
_FILM_ITERATIONS, _LEAST_GAIN, _LARGEST_CHANGE = 30, 1e-8, 0.1

# Facets with fewer nodes are small; films with fewer move, and do not turn or bend.
_FEW, _FEW_TO_BEND = 20, 60

# Numbers of a film: h, b1, b2, S11, S12, S22.
_SIX = 6


class Shape(NamedTuple):
    """A droplet between planes.

    Attributes:
        energy: area above that of the sphere.
        pressure: inside.
        forces: of each plane, shape (C,).
        energy_error, pressure_error, force_error: what the last extrapolation is uncertain by; of
            forces the largest one.
        nodes: of the finest mesh.
    """

    energy: float
    pressure: float
    forces: Floats
    energy_error: float
    pressure_error: float
    force_error: float
    nodes: int


def shape(normals: ArrayLike, indentations: ArrayLike) -> Shape:
    """The droplet of radius 1 and tension 1 between planes n_c.x <= 1 - a_c.

    Args:
        normals: unit vectors n_c, shape (C, 3).
        indentations: a_c, shape (C,).

    Raises:
        ValueError: an indentation is 1 or more.
        ArithmeticError: Newton's method fails, as for droplets squeezed beyond their volume.
    """
    largest = np.max(indentations, initial=0.0)
    if not largest < 1.0:
        raise ValueError(f"planes must be beyond the origin, indentations below 1, not {largest}")
    heights = 1.0 - np.asarray(indentations, dtype=float)
    i, none = np.zeros(len(heights), dtype=np.int64), np.full(len(heights), -1)
    films = _Films(i, none, np.asarray(normals, dtype=float), heights, 2.0 * heights)
    found = _extrapolated(_solve(np.ones(1), films, *ALONE))
    return Shape(
        float(found.energies[0]),
        float(found.pressures[0]),
        found.forces,
        found.energy_error,
        found.pressure_error,
        found.force_error,
        found.nodes,
    )


class Level(NamedTuple):
    """What meshes of one size tell of a packing, or what is extrapolated from all.

    Attributes:
        energies, pressures: area above that of the sphere, and pressure inside, of each droplet,
            shape (N,).
        forces: of the films, shape (M,).
        nodes: of all meshes.
        seconds: processor time up to here.
        energy_error, pressure_error, force_error: what an extrapolation is uncertain by, of the sum
            of the energies, and the largest of a pressure inside and of a force; nan of a level.
    """

    energies: Floats
    pressures: Floats
    forces: Floats
    nodes: int
    seconds: float
    energy_error: float = math.nan
    pressure_error: float = math.nan
    force_error: float = math.nan


class ExactPacking(NamedTuple):
    """A packing of droplets at rest, with the box and the radii of a state of the law.

    Attributes:
        i, j, image: near pairs, and the periodic image of j, in lattice vectors.
        found: its energies, pressures and forces, extrapolated.
        levels: on the meshes that it is extrapolated from.
    """

    i: Integers
    j: Integers
    image: Integers
    found: Level
    levels: list[Level]


def exact_packing(state: State) -> ExactPacking:
    """The exact shapes of a packing of droplets.

    Args:
        state: of the law `Droplet` at rest, with one tension, without walls. Shapes are seen from
            its centers, and begin behind its films; droplets and films move as they must. If
            droplets stick, films are those of the state.

    Raises:
        ValueError: there are walls, tensions differ, or some droplets stick and others press each
            other without a film.
        ArithmeticError: Newton's method fails, as for packings that nothing holds.
    """
    packing = state.packing
    tensions = np.unique(state.law.tension if isinstance(state.law, Droplet) else [])
    if len(tensions) != 1 or packing.walls:
        raise ValueError("a packing must have droplets of one tension, and no walls")
    if state.law.sticks:
        return _sticking(state)
    i, j, lattice = near_pairs(packing, 2.0 * _NEAR * float(packing.radii.max()))
    apart = packing.positions[j] + lattice - packing.positions[i]
    distance, part = lengths(apart), packing.radii[i] / (packing.radii[i] + packing.radii[j])
    films = _Films(i, j, apart / distance[:, None], part * distance, distance)
    image = np.rint(fractional(lattice, packing.box)).astype(np.int64)
    contacts = {(row["i"], row["j"], *row["image"]): row for row in state.contacts}
    for k, (a, b, turn) in enumerate(zip(i, j, image, strict=True)):
        row, back = (contacts.get(key) for key in ((a, b, *turn), (b, a, *-turn)))
        if row is not None and back is not None:
            at_a, at_b = packing.radii[[a, b]] - (row["indentation"], back["indentation"])
            tilt, bend = films.axes[k, 1:] @ row["tilt"], row["curvature"]
            films.numbers[k] = (at_a + distance[k] - at_b) / 2.0, *-tilt, -bend, 0.0, -bend
            films.awake[k] = True
    levels = [_times(level, float(tensions[0])) for level in _solve(packing.radii, films, *PACKED)]
    return ExactPacking(i, j, image, _extrapolated(levels), levels)


def _sticking(state: State) -> ExactPacking:
    """Of droplets that stick."""
    cluster = exact_films.cluster_of(state)
    (i, j), axes = cluster.ends(), cluster.axes()
    lattice = np.array([film.lattice for film in cluster.films]).reshape(-1, 3)
    levels = [
        Level(
            each.energies,
            each.pressures,
            np.einsum("mj,mj->m", each.forces, axes),
            each.nodes,
            each.seconds,
        )
        for each in exact_films.solve(cluster)
    ]
    image = np.rint(fractional(lattice, state.packing.box)).astype(np.int64)
    return ExactPacking(i, j, image, _extrapolated(levels), levels)


def osmotic(state: State, level: Level) -> float:
    """Pressure P of a packing, by 3 V P = sum 3 p v - 2 A of its droplets."""
    radii, tension = state.packing.radii, float(np.max(state.law.tension))
    surface = 4.0 * math.pi * tension * radii**2 + level.energies
    inside = VOLUME * radii**3 * level.pressures
    return float(np.sum(inside - 2.0 / 3.0 * surface) / np.linalg.det(state.packing.box))


def _times(level: Level, tension: float) -> Level:
    energies, pressures, forces = (tension * values for values in level[:3])
    return Level(energies, pressures, forces, level.nodes, level.seconds)


def _solve(radii: Floats, films: _Films, nodes: int, graded: int) -> list[Level]:
    """The shapes on meshes whose edges are halved from one to the next."""
    began = time.process_time()
    first = _Mesh.of(spiral(nodes))
    drops = [_Drop(first, radius) for radius in radii]
    levels = []
    _relax(drops, films, free=False)
    for step in range(graded + SMALL):
        for drop in drops:
            drop.refine(drop.at_rims() if step < graded else drop.at_small_facets())
        _relax(drops, films, free=False)
    for level in range(HALVED + 1):
        for drop in drops if level > 0 else ():
            drop.halve()
        _relax(drops, films, free=True)
        spheres = np.array([drop.mesh.sphere(drop.volume) for drop in drops])
        energies = np.array([drop.area for drop in drops]) - spheres
        flat = 2.0 / 3.0 * spheres / (VOLUME * radii**3)  # of a sphere, 2/R but for its mesh
        pressures = np.array([drop.pressure for drop in drops]) - flat + 2.0 / radii
        size, seconds = sum(len(drop.rho) for drop in drops), time.process_time() - began
        levels.append(Level(energies, pressures, _forces(drops, films), size, seconds))
    return levels


def _extrapolated(levels: list[Level]) -> Level:
    names = ("energies", "pressures", "forces")
    (energies, change), (pressures, of_pressure), (forces, of_force) = (
        extrapolated(*(getattr(level, name) for level in levels[-3:])) for name in names
    )
    fine = levels[-1]
    return Level(
        energies + LEFT * change,
        pressures,
        forces,
        fine.nodes,
        fine.seconds,
        LEFT_ERROR * abs(float(change.sum())),
        float(np.abs(of_pressure).max()),
        float(np.abs(of_force).max(initial=0.0)),
    )


# Films


class _Films:
    """Films between droplets i and j, and planes, for which j is -1.

    Attributes:
        i, j: shape (M,).
        axes: of each film, n from i to j, and two across it, shape (M, 3, 3).
        distance: of the centers, shape (M,); of planes none is needed.
        numbers: h, b and S as i sees them, shape (M, 6). For j, on the other side, they are
            d - h, -b and -S.
        awake: whether droplets know of it, shape (M,).
    """

    def __init__(
        self, i: Integers, j: Integers, normals: Floats, heights: Floats, distance: Floats
    ) -> None:
        self.i, self.j, self.distance = i, j, distance
        least = np.eye(3)[np.abs(normals).argmin(axis=1)]
        first = np.cross(normals, least)
        first /= lengths(first)[:, None]
        self.axes = np.stack([normals, first, np.cross(normals, first)], axis=1)
        self.numbers = np.zeros((len(i), _SIX))
        self.numbers[:, 0] = heights
        self.awake = j < 0

    def of(self, drop: int) -> tuple[Integers, Floats]:
        """Films of a droplet, and 1 where it is their i, else -1."""
        at_i, at_j = (np.flatnonzero(self.awake & (ends == drop)) for ends in (self.i, self.j))
        return np.concatenate([at_i, at_j]), np.repeat([1.0, -1.0], [len(at_i), len(at_j)])

    def seen(self, which: Integers, side: Floats) -> tuple[Floats, Floats]:
        """Axes and numbers of films as a droplet sees them."""
        axes, numbers = self.axes[which], side[:, None] * self.numbers[which]
        axes[:, 0] *= side[:, None]
        numbers[:, 0] += np.where(side < 0.0, self.distance[which], 0.0)
        return axes, numbers

    def shifts(self) -> Floats:
        """Change of all numbers by a shift of all films, shape (6 M, 3)."""
        found = np.zeros((len(self.i), _SIX, 3))
        normal, first, second = self.axes.transpose(1, 0, 2)
        _, b1, b2, s11, s12, s22 = self.numbers.T[:, :, None]
        found[:, 0] = normal - b1 * first - b2 * second
        found[:, 1] = -s11 * first - s12 * second
        found[:, 2] = -s12 * first - s22 * second
        return np.where(self.awake[:, None, None], found, 0.0).reshape(-1, 3)

    def wake(self, drops: list[_Drop]) -> bool:
        """Whether droplets pass each other, which from now on have a film."""
        before = self.awake.copy()
        for k in np.flatnonzero(~before):
            normal = self.axes[k, 0]
            reach = drops[self.i[k]].reach(normal) + drops[self.j[k]].reach(-normal)
            self.awake[k] = reach > self.distance[k]
        return bool((self.awake & ~before).any())


def _bounds(u: Floats, axes: Floats, numbers: Floats) -> Floats:
    """Largest rho of nodes in the directions u behind each film, shape (nodes, films).

    c r = h + b.s r + s.S s r^2/2 with c = u.n and s = u across n:
    r = 2 h/(a + sqrt(a^2 - 2 h s.S s)) with a = c - b.s.
    """
    c, s1, s2 = (u @ axes[:, k].T for k in range(3))
    h, b1, b2, s11, s12, s22 = numbers.T
    a, bend = c - b1 * s1 - b2 * s2, s11 * s1 * s1 + 2.0 * s12 * s1 * s2 + s22 * s2 * s2
    root = a * a - 2.0 * h * bend
    there = (c > _ASIDE) & (root > 0.0) & (a > 0.0)
    below = np.where(there, a + np.sqrt(np.where(there, root, 0.0)), 1.0)
    return np.where(there, np.log(2.0 * h / below), np.inf)


def _slopes(u: Floats, rho: Floats, axes: Floats, numbers: Floats) -> tuple[Floats, Floats]:
    """First and second derivatives of rho on a film by its numbers, (nodes, 6) and (nodes, 6, 6).

    With the factors g = (1, y1, y2, y1^2/2, y1 y2, y2^2/2) of the numbers, y = r s, and
    D = c - b.s - s.S s r:  dr = g/D,  dD = -g' - s.S s dr.
    """
    r = np.exp(rho)[:, None]
    c, s1, s2 = np.einsum("nkj,nj->kn", axes, u)[:, :, None]
    _, b1, b2, s11, s12, s22 = numbers.T[:, :, None]
    bend = s11 * s1 * s1 + 2.0 * s12 * s1 * s2 + s22 * s2 * s2
    D = c - b1 * s1 - b2 * s2 - bend * r
    y1, y2, one = r * s1, r * s2, np.ones_like(r)
    g = np.hstack([one, y1, y2, y1 * y1 / 2.0, y1 * y2, y2 * y2 / 2.0])
    of_r = np.hstack([0.0 * one, s1, s2, y1 * s1, 2.0 * y1 * s2, y2 * s2])
    first = g / D
    mixed = of_r[:, :, None] * first[:, None]
    second = (mixed + mixed.transpose(0, 2, 1)) / D[:, :, None]
    second += (bend / D)[:, :, None] * first[:, :, None] * first[:, None]
    first = first / r
    return first, second / r[:, :, None] - first[:, :, None] * first[:, None]


def _relax(drops: list[_Drop], films: _Films, free: bool) -> None:
    """Bring all droplets, and films between them if they are free, into balance."""
    while True:
        _settle(drops, films)
        if films.wake(drops):
            continue
        if not (free and (films.j >= 0).any()):
            return
        for _ in range(_FILM_ITERATIONS):
            if _step(drops, films) < _LEAST_GAIN:
                break
        else:
            raise ArithmeticError(f"no films were found in {_FILM_ITERATIONS} iterations")
        if not films.wake(drops):
            return


def _settle(drops: list[_Drop], films: _Films) -> None:
    for k, drop in enumerate(drops):
        drop.settle(*films.seen(*films.of(k)))


def _step(drops: list[_Drop], films: _Films) -> float:
    """A step of Newton's method for all films, and how much energy it should gain.

    A shift of all films together gains nothing: they make none.
    """
    count = films.numbers.size
    push, matrix, places = np.zeros(count), _HOLD_FILM * np.eye(count), []
    stiff = np.zeros((len(films.i), _SIX), dtype=bool)
    for k, drop in enumerate(drops):
        which, side = films.of(k)
        place, sign = (_SIX * which[:, None] + np.arange(_SIX)).ravel(), np.repeat(side, _SIX)
        # a film between a droplet and its own image has two places
        np.add.at(push, place, sign * drop.forces())
        np.add.at(matrix, np.ix_(place, place), sign[:, None] * drop.stiffness() * sign)
        places.append((place, sign))
        stiff[which[drop.nodes_on_films() < _FEW_TO_BEND], 1:] = True
    shifts, fixed = films.shifts(), stiff.ravel()
    push[fixed], shifts[fixed], matrix[fixed], matrix[:, fixed] = 0.0, 0.0, 0.0, 0.0
    matrix[fixed, fixed] = 1.0
    system = np.block([[matrix, shifts], [shifts.T, np.zeros((3, 3))]])
    change = np.linalg.solve(system, np.concatenate([push, np.zeros(3)]))[:count]
    gain = 0.5 * float(push @ change)
    change *= min(1.0, _LARGEST_CHANGE / np.abs(change).max())
    numbers, shapes = films.numbers, [drop.now() for drop in drops]
    area = math.fsum(drop.area for drop in drops)
    for part in (1.0, 0.3, 0.1):
        films.numbers = numbers + part * change.reshape(-1, _SIX)
        for drop, now, (place, sign) in zip(drops, shapes, places, strict=True):
            drop.follow(now, part * sign * change[place])
        _settle(drops, films)
        if math.fsum(drop.area for drop in drops) < area + _LEAST_GAIN:
            break
    return abs(gain)


def _forces(drops: list[_Drop], films: _Films) -> Floats:
    """F of each film, the mean of both sides, which differ by what a shift of all makes."""
    found = np.zeros(len(films.i))
    for k, drop in enumerate(drops):
        np.add.at(found, films.of(k)[0], drop.forces()[::_SIX])
    return found / np.where(films.j >= 0, 2.0, 1.0)


# Droplets


class _Drop:
    """One droplet.

    Attributes:
        mesh, rho, pressure: its shape.
        held: nodes on films.
        area: of its surface.
    """

    def __init__(self, mesh: _Mesh, radius: float) -> None:
        self.mesh, self.rho = mesh, np.full(len(mesh.u), math.log(radius))
        self.volume, self.pressure, self.area = VOLUME * radius**3, 2.0 / radius, 0.0
        self.held = np.zeros(len(mesh.u), dtype=bool)

    def at_rims(self) -> Flags:
        """Nodes of triangles at the rims of facets, and of their neighbors."""
        held = self.held[self.mesh.triangles]
        return self._around(np.asarray(held.any(axis=1) & ~held.all(axis=1)))

    def at_small_facets(self) -> Flags:
        """Nodes of small facets, and of their neighbors."""
        few = self.nodes_on_films() < _FEW
        chosen = np.zeros(len(self.rho), dtype=bool)
        chosen[self._on[few[self._film]]] = True
        chosen[(self.mesh.u @ self._axes[few, 0].T).argmax(axis=0)] = True
        return self._around(np.asarray(chosen[self.mesh.triangles].any(axis=1)))

    def _around(self, triangles: Flags) -> Flags:
        near = np.zeros(len(self.rho), dtype=bool)
        near[self.mesh.triangles[triangles]] = True
        near[self.mesh.triangles[near[self.mesh.triangles].any(axis=1)]] = True
        return near

    def refine(self, near: Flags) -> None:
        """Add nodes in the middle of edges between those that are `near`."""
        if near.any():
            self.mesh, both = self.mesh.refined(near, np.column_stack([self.rho, self.held]))
            self.rho, self.held = both[:, 0], both[:, 1] == 1.0

    def halve(self) -> None:
        """Halve all edges."""
        self.mesh, both = self.mesh.halved(np.column_stack([self.rho, self.held]))
        self.rho, self.held = both[:, 0], both[:, 1] == 1.0

    def reach(self, direction: Floats) -> float:
        """How far it goes in a direction, from its center."""
        return float((np.exp(self.rho) * (self.mesh.u @ direction)).max())

    def settle(self, axes: Floats, numbers: Floats) -> None:
        """Find the shape behind films that are given."""
        mesh = self.mesh
        bounds = np.full((len(mesh.u), max(len(axes), 1)), np.inf)  # of a loose droplet: nothing
        bounds[:, : len(axes)] = _bounds(mesh.u, axes, numbers)
        film, bound = bounds.argmin(axis=1), bounds.min(axis=1)
        held = (self.held & np.isfinite(bound)) | (self.rho > bound)
        rho, pressure = np.where(held, bound, self.rho), self.pressure
        loose = len(axes) < 3 or np.linalg.matrix_rank(axes[:, 0]) < 3
        for _ in range(_ITERATIONS):
            _, slope, curvature = mesh.area(rho)
            volume, growth, each = mesh.volume(rho)
            hessian = mesh.matrix(curvature - pressure * each[:, None, None])
            step, free = np.where(held, bound - rho, 0.0), ~held
            rest = pressure * growth - slope - hessian @ step
            side = growth[free, None]
            moves = side * mesh.u[free] if loose else 0.0 * mesh.u[free]  # by a shift
            system = bmat(
                [
                    [hessian[free][:, free], -side, moves],
                    [-side.T, None, None],
                    [moves.T, None, -np.eye(3) / _HOLD],
                ]
            )
            solve = splu(csc_matrix(system)).solve
            missing = self.volume - volume - growth @ step
            solved = solve(np.concatenate([rest[free], [-missing], np.zeros(3)]))
            step[free], change = solved[: len(side)], solved[len(side)]
            part = min(1.0, _LARGEST_STEP / np.abs(step).max())
            rho, pressure = rho + part * step, pressure + part * change
            push = pressure * growth - slope - part * (hessian @ step)
            then, held = held, np.where(held, push > 0.0, rho > bound)
            if np.abs(step).max() < _SMALLEST_STEP and np.array_equal(held, then):
                break
        else:
            raise ArithmeticError(f"no shape was found in {_ITERATIONS} iterations")
        self.rho, self.pressure, self.held = rho, pressure, held
        self.area, slope, _ = mesh.area(rho)
        self._growth = mesh.volume(rho)[1]
        self._solve, self._hessian = solve, hessian
        self._on, self._film, self._axes = np.flatnonzero(held), film[held], axes
        self._push = (pressure * self._growth - slope)[held]
        first, self._second = _slopes(
            mesh.u[held], rho[held], axes[self._film], numbers[self._film]
        )
        rows = np.repeat(self._on, _SIX)
        columns = (_SIX * self._film[:, None] + np.arange(_SIX)).ravel()
        size = len(rho), _SIX * len(axes)
        self._by_film = csr_matrix((first.ravel(), (rows, columns)), size)  # drho/dq

    def forces(self) -> Floats:
        """How it pushes its films, -dA/dq, shape (6 films,)."""
        return np.asarray(self._by_film[self._on].T @ self._push)

    def nodes_on_films(self) -> Integers:
        """How many of its nodes each film holds."""
        return np.bincount(self._film, minlength=self._by_film.shape[1] // _SIX)

    def stiffness(self) -> Floats:
        """d2A/dq2 of its films, in which nodes follow."""
        coupled = self._hessian @ self._by_film
        border, count = -(self._by_film.T @ self._growth)[None], coupled.shape[1]
        coupling = np.vstack([coupled[~self.held].toarray(), border, np.zeros((3, count))])
        self._follow = -self._solve(coupling)
        found = (self._by_film.T @ coupled).toarray() + coupling.T @ self._follow
        for k in range(count // _SIX):
            own, these = slice(_SIX * k, _SIX * (k + 1)), self._film == k
            found[own, own] -= np.tensordot(self._push[these], self._second[these], axes=1)
        return found

    def now(self) -> tuple[Floats, float, Flags]:
        """The nodes and what holds them."""
        return self.rho, self.pressure, self.held

    def follow(self, now: tuple[Floats, float, Flags], change: Floats) -> None:
        """Move nodes that no film holds as the films move, to first order."""
        rho, pressure, self.held = now
        moved, free = self._follow @ change, ~self.held
        self.rho = rho.copy()
        self.rho[free] += moved[: free.sum()]
        self.pressure = pressure + float(moved[free.sum()])


# Meshes


class _Mesh:
    """Triangles between directions u, counterclockwise from outside."""

    def __init__(self, u: Floats, triangles: Integers) -> None:
        self.u, self.triangles = u, triangles
        a, b, c = (u[triangles[:, k]] for k in range(3))
        self.opposite = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
        self.sixfold = np.einsum("tj,tj->t", a, self.opposite[:, 0])

    @classmethod
    def of(cls, u: Floats) -> _Mesh:
        """Delaunay triangles."""
        triangles = ConvexHull(u).simplices
        a, b, c = (u[triangles[:, k]] for k in range(3))
        inwards = np.einsum("tj,tj->t", np.cross(b - a, c - a), a) < 0.0
        triangles[inwards] = triangles[inwards, ::-1]
        return cls(u, triangles)

    def refined(self, near: Flags, values: Floats) -> tuple[_Mesh, Floats]:
        """Delaunay triangles with further nodes in the middle of edges between those `near`.

        Args:
            near: of each node.
            values: at the nodes, shape (nodes, k).

        Returns:
            The mesh, and the values at its nodes.
        """
        sides = self._sides()
        edges = np.unique(np.sort(sides[near[sides].all(axis=1)], axis=1), axis=0)
        u, values = self._with_middles(edges, values)
        return _Mesh.of(u), values

    def halved(self, values: Floats) -> tuple[_Mesh, Floats]:
        """Four triangles for each, otherwise as `refined`."""
        edges, which = np.unique(np.sort(self._sides(), axis=1), axis=0, return_inverse=True)
        a, b, c = self.triangles.T
        ab, bc, ca = len(self.u) + which.reshape(3, -1)
        corners = (a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)
        u, values = self._with_middles(edges, values)
        return _Mesh(u, np.concatenate([np.column_stack(each) for each in corners])), values

    def _sides(self) -> Integers:
        """ab, then bc, then ca of all triangles."""
        return np.concatenate([self.triangles[:, [k, (k + 1) % 3]] for k in range(3)])

    def _with_middles(self, edges: Integers, values: Floats) -> tuple[Floats, Floats]:
        middle = self.u[edges].sum(axis=1)
        middle /= lengths(middle)[:, None]
        more = values[edges].mean(axis=1)
        return np.concatenate([self.u, middle]), np.concatenate([values, more])

    def area(self, rho: Floats) -> tuple[float, Floats, Floats]:
        """A, its gradient, and its Hessian in each triangle, shape (T, 3, 3).

        c = sum of the three products x_i x x_j has derivatives that are sums of them again.
        """
        r = np.exp(rho)[self.triangles]
        products = np.roll(r, -1, axis=1) * np.roll(r, 1, axis=1)
        parts = products[:, :, None] * self.opposite
        c = parts.sum(axis=1)
        size = np.sqrt(np.einsum("tj,tj->t", c, c))
        first = c[:, None] - parts  # dc/drho_k: all but what has no x_k
        along = np.einsum("tj,tkj->tk", c, first)
        second = np.einsum("tkj,tlj->tkl", first, first)
        across = np.einsum("tj,tkj->tk", c, parts)
        for k in range(3):
            for m in range(3):
                second[:, k, m] += along[:, k] if k == m else across[:, 3 - k - m]
        second /= 2.0 * size[:, None, None]
        second -= along[:, :, None] * along[:, None] / (2.0 * size**3)[:, None, None]
        return 0.5 * float(size.sum()), self._sums(0.5 * along / size[:, None]), second

    def volume(self, rho: Floats) -> tuple[float, Floats, Floats]:
        """V, its gradient, and that of each triangle, which is each element of its Hessian, too."""
        each = np.exp(rho[self.triangles].sum(axis=1)) * self.sixfold / 6.0
        return float(each.sum()), self._sums(np.repeat(each[:, None], 3, axis=1)), each

    def matrix(self, blocks: Floats) -> csr_matrix:
        rows, columns = np.repeat(self.triangles, 3, axis=1), np.tile(self.triangles, 3)
        number = len(self.u)
        return csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), (number, number))

    def _sums(self, corners: Floats) -> Floats:
        return np.asarray(np.bincount(self.triangles.ravel(), corners.ravel(), len(self.u)), float)

    def sphere(self, volume: float) -> float:
        """Area of the polyhedron of this volume with all nodes at one distance."""
        zero = np.zeros(len(self.u))
        return self.area(zero)[0] * (volume / self.volume(zero)[0]) ** (2.0 / 3.0)

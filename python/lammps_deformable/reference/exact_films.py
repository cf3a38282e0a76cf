"""The exact shapes of droplets that stick, by finite elements: whole clusters and packings.

All surfaces are flat triangles between nodes. A film is one sheet between two droplets, and its rim
is a line that it shares with both free surfaces. With the tension g_i of droplet i and the film's
g_i + g_j - w, of which each droplet has a side,

    E = sum_i [g_i A_i + sum over its films (g_i - w/2) A_f],    V_i = sum x_a.(x_b x x_c)/6

is stationary at given volumes; the multipliers are the pressures p_i. So Neumann's triangle comes
by itself, and films turn and bend as they must. Nodes move along fixed directions: those of free
surfaces along the ray from the center, those of films along the line of centers, and those of rims
also away from it.

An outer force b_i has the energy -b_i.X_i. It acts on the volume evenly, X_i being the centroid, or
as in the law on the center of the sphere that goes on behind the films,

    X_i = centroid + sum over films n A_f^2/(4 pi V_i)

because A_f^2/(4 pi) is the first moment of a cap with a base of the area A_f. Then a film has the
tension g_i + g_j - w - 2 c A_f, where c = n.(b_i/V_i - b_j/V_j)/(4 pi).

Newton's method finds all unknowns of all droplets in one sparse system. Rims of the law are where a
mesh begins; where they move far it is made again. Then all edges are halved, and the errors of what
levels tell fall with the square of the edges.
"""

from __future__ import annotations

import math
import time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bmat, coo_matrix, csc_matrix
from scipy.sparse.linalg import splu
from scipy.spatial import ConvexHull, Delaunay, cKDTree

from ..particles.laws import pair_matrix
from ..state.state import State

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

VOLUME = 4.0 * math.pi / 3.0

# Nodes of the first mesh of a droplet, those of a rim at least, and how often edges are halved.
NODES, RIM, HALVED = 300, 24, 2

# Rings of nodes around a rim.
_RINGS = 6

# A mesh is made again while a rim moves by more than this part of its radius.
_MOVED, _REMADE = 0.05, 15

# Steps of Newton's method: how many; the largest of a rim over its radius, and of a free surface
# over that of the droplet; and the last.
_ITERATIONS, _LARGEST_MOVE, _LARGEST_STEP, _SMALLEST_STEP = 50, 0.15, 0.2, 1e-5

# Distance of the first free nodes from the center, over the radius.
_SWOLLEN = 1.02

# Harmonics of a rim that a new mesh keeps.
_HARMONICS = 4

# A rigid motion counts that moves nodes along their ways by this part of what it moves them.
_NO_MOVE = 1e-2

# Kinds of nodes.
_FREE, _FILM, _RIM = 0, 1, 2


class Film(NamedTuple):
    """A film between droplets as the law has it, where a mesh begins.

    Attributes:
        i, j: the droplets.
        lattice: to be added to the center of j.
        center: the middle of the film.
        radius: of its rim.
        adhesion: w.
    """

    i: int
    j: int
    lattice: Floats
    center: Floats
    radius: float
    adhesion: float


class Cluster(NamedTuple):
    """Droplets, and the films that hold them together.

    Attributes:
        centers: from which free surfaces are seen, shape (N, 3).
        radii, tensions: of each.
        films: between them. Droplets without any are balls.
        outer: forces on the droplets, shape (N, 3). Their sum and torque are 0.
        spheres: whether they act on the centers of spheres, or else on volumes.
    """

    centers: Floats
    radii: Floats
    tensions: Floats
    films: list[Film]
    outer: Floats
    spheres: bool = False

    def around(self, drop: int) -> list[tuple[int, Floats]]:
        """Films of a droplet, each with what takes it to where the droplet sees it."""
        found = [(k, np.zeros(3)) for k, film in enumerate(self.films) if film.i == drop]
        return found + [(k, -film.lattice) for k, film in enumerate(self.films) if film.j == drop]

    def ends(self) -> tuple[Integers, Integers]:
        """i and j of all films."""
        i, j = np.array([film[:2] for film in self.films], dtype=np.int64).reshape(-1, 2).T
        return i, j

    def axes(self) -> Floats:
        """Lines of centers, from i to j, shape (M, 3)."""
        lattice = np.array([film.lattice for film in self.films]).reshape(-1, 3)
        i, j = self.ends()
        return _unit(self.centers[j] + lattice - self.centers[i])

    def parts(self) -> list[tuple[Floats, bool]]:
        """Parts that nothing holds: what takes each of its droplets to where it hangs together,
        shape (N, 3), nan of others; and whether it turns freely, too, as it has no images."""
        found: list[tuple[Floats, bool]] = []
        left = set(range(len(self.centers)))
        while left:
            place, turns, reached = np.full((len(self.centers), 3), np.nan), True, {min(left)}
            place[min(left)] = 0.0
            while reached:
                drop = reached.pop()
                left.discard(drop)
                for film in self.films:
                    for one, other, step in ((*film[:3],), (film.j, film.i, -film.lattice)):
                        if one == drop and np.isnan(place[other, 0]):
                            place[other] = place[one] + step
                            reached.add(other)
                        elif one == drop and not np.allclose(place[other], place[one] + step):
                            turns = False
            found.append((place, turns))
        return found


class Found(NamedTuple):
    """What a mesh tells of a cluster.

    Attributes:
        energies: of each droplet, with its side of films, above the sphere.
        pressures: inside, at the centroid.
        centroids: of the droplets, shape (N, 3).
        forces: with which droplet i pushes each film, shape (M, 3).
        areas: of the films.
        nodes: number of all.
        seconds: processor time up to here.
    """

    energies: Floats
    pressures: Floats
    centroids: Floats
    forces: Floats
    areas: Floats
    nodes: int
    seconds: float


def cluster_of(state: State, outer: Floats | None = None) -> Cluster:
    """What meshes of a state of the law begin with.

    Args:
        state: of a `Droplet` with an adhesion, without walls.
        outer: see `Cluster`; none by default.

    Raises:
        ValueError: droplets press each other without a film.
    """
    packing, law, table = state.packing, state.law, state.contacts
    adhesion = pair_matrix("adhesion", law.adhesion, len(packing.species_radii))
    tension = np.broadcast_to(law.tension, len(packing.species_radii))
    # each film is listed from both sides
    first = [(row["i"], *row["image"]) < (row["j"], *-row["image"]) for row in table]
    films = []
    for row in table[first]:
        i, j = int(row["i"]), int(row["j"])
        if row["attached"]:
            films.append(
                Film(
                    i,
                    j,
                    row["image"] @ packing.box,
                    packing.positions[i] + (packing.radii[i] - row["indentation"]) * row["normal"],
                    float(row["facet_radius"]),
                    float(adhesion[packing.species[i], packing.species[j]]),
                )
            )
        elif row["force"] > 0.0:
            raise ValueError(
                f"droplets {i} and {j} press each other without a film: exact shapes are known "
                "where all that touch stick, or nothing sticks"
            )
    forces = np.zeros_like(packing.positions) if outer is None else np.asarray(outer, dtype=float)
    return Cluster(packing.positions, packing.radii, tension[packing.species], films, forces)


def extrapolated(coarse: Floats, middle: Floats, fine: Floats) -> tuple[Floats, Floats]:
    """The limit of what three levels tell, and what it was before the last one less that."""
    last = fine + (fine - middle) / 3.0
    return last, last - (middle + (middle - coarse) / 3.0)


def solve(cluster: Cluster, nodes: int = NODES, rim: int = RIM) -> list[Found]:
    """The shapes on meshes whose edges are halved from one to the next.

    Args:
        cluster: where the law has droplets and films.
        nodes: of the first mesh of a droplet.
        rim: those of a rim at least.

    Raises:
        ArithmeticError: Newton's method fails, as for films that cannot bear the outer forces.
    """
    began = time.process_time()
    rims = [_circle(cluster, film, nodes, rim) for film in range(len(cluster.films))]
    for _ in range(_REMADE):
        mesh = _Mesh.of(cluster, rims, nodes)
        mesh.settle(pinned=True)
        mesh.step()
        last, rims = rims, mesh.rims()
        if all(
            np.linalg.norm(new - old, axis=1).max() < _MOVED * film.radius
            for new, old, film in zip(rims, last, cluster.films, strict=True)
        ):
            break
    levels = []
    for level in range(HALVED + 1):
        if level > 0:
            mesh = mesh.halved()
        mesh.settle()
        levels.append(mesh.found(time.process_time() - began))
    return levels


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def _solved(system: csc_matrix, right: Floats) -> Floats:
    """Of a symmetric system: half of the time of an order that does not know it."""
    options = {"SymmetricMode": True}
    order = splu(system, "MMD_AT_PLUS_A", diag_pivot_thresh=0.01, options=options)
    return np.asarray(order.solve(right))


def _sums(which: Integers, values: Floats, count: int) -> Floats:
    return np.asarray(np.bincount(which, values, count), dtype=float)


# Meshes


def spiral(number: int) -> Floats:
    """Points on the unit sphere, evenly."""
    k = np.arange(number) + 0.5
    z = 1.0 - 2.0 * k / number
    angle, r = math.pi * (1.0 + math.sqrt(5.0)) * k, np.sqrt(1.0 - z * z)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


def _width(nodes: int) -> float:
    """Between so many on the unit sphere."""
    return math.sqrt(4.0 * math.pi / nodes)


def _circle(cluster: Cluster, number: int, nodes: int, least: int) -> Floats:
    """The first nodes of a rim."""
    film, normal = cluster.films[number], cluster.axes()[number]
    width = _width(nodes) * min(cluster.radii[[film.i, film.j]])
    count = max(least, math.ceil(2.0 * math.pi * film.radius / width))
    first = _unit(np.cross(normal, np.eye(3)[np.abs(normal).argmin()]))
    turn = 2.0 * math.pi * np.arange(count)[:, None] / count
    across = np.cos(turn) * first + np.sin(turn) * np.cross(normal, first)
    return np.asarray(film.center + film.radius * across)


def _disk(rim: Floats) -> tuple[Floats, Integers]:
    """Nodes of a film within its rim, and triangles, of which the first nodes are the rim."""
    count = len(rim)
    width = 2.0 * math.pi / count
    inner = math.ceil(math.pi * (1.0 - 0.5 * width) ** 2 / (0.87 * width**2))
    k = np.arange(inner) + 0.5
    size, turn = (1.0 - 0.8 * width) * np.sqrt(k / inner), math.pi * (1.0 + math.sqrt(5.0)) * k
    edge = 2.0 * math.pi * np.arange(count) / count
    flat = np.column_stack([size * np.cos(turn), size * np.sin(turn)])
    plane = np.concatenate([np.column_stack([np.cos(edge), np.sin(edge)]), flat])
    triangles = Delaunay(plane).simplices
    corners = np.concatenate([plane[triangles], np.ones((len(triangles), 3, 1))], axis=2)
    wide = np.abs(np.linalg.det(corners)) > 1e-9
    middle = rim.mean(axis=0)
    place = count * np.mod(turn, 2.0 * math.pi) / (2.0 * math.pi)
    before, part = place.astype(int) % count, (place % 1.0)[:, None]
    outwards = (1.0 - part) * rim[before] + part * rim[(before + 1) % count] - middle
    return middle + size[:, None] * outwards, triangles[wide].astype(np.int64)


def _sphere(rims: list[Floats], nodes: int) -> tuple[Floats, Integers]:
    """Directions between rims, which are the first, and triangles, which leave out the films."""
    width = _width(nodes)
    middles = np.array([_unit(rim.sum(axis=0)) for rim in rims]).reshape(-1, 3)
    angles = np.array(
        [np.arccos(rim @ middle).max() for rim, middle in zip(rims, middles, strict=True)]
    )
    ends = np.cumsum([len(rim) for rim in rims])
    count, points = sum(map(len, rims)), np.concatenate([np.empty((0, 3)), *rims])

    def add(more: Floats, apart: float, beyond: float) -> None:
        nonlocal points
        clear = (np.arccos(np.clip(more @ middles.T, -1.0, 1.0)) > angles + beyond).all(axis=1)
        clear &= cKDTree(points).query(more)[0] > apart
        points = np.concatenate([points, more[clear]])

    off = np.zeros(len(rims))
    for ring in range(1, _RINGS + 1):
        for k, (rim, middle) in enumerate(zip(rims, middles, strict=True)):
            step = 2.0 * math.pi * math.sin(angles[k] + off[k]) / len(rim)
            if step > 1.3 * width:
                continue
            off[k] += 0.87 * step
            start = _unit(rim + np.roll(rim, -1, axis=0)) if ring % 2 else rim
            away = _unit(start * (start @ middle)[:, None] - middle)
            add(math.cos(off[k]) * start + math.sin(off[k]) * away, 0.65 * step, -math.inf)
    add(spiral(nodes), 0.7 * width, 0.3 * width)
    # what a ring has put into another film
    inside = (np.arccos(np.clip(points @ middles.T, -1.0, 1.0)) < angles).any(axis=1)
    inside[:count] = False
    points = points[~inside]
    triangles = ConvexHull(points).simplices.astype(np.int64)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    inwards = np.einsum("tj,tj->t", np.cross(b - a, c - a), a + b + c) < 0.0
    triangles[inwards] = triangles[inwards, ::-1]
    of_rim = np.where(triangles < count, np.searchsorted(ends, triangles, side="right"), -1)
    behind = (of_rim[:, 0] >= 0) & (of_rim == of_rim[:, :1]).all(axis=1)
    return points, triangles[~behind]


class _Mesh:
    """All nodes and triangles.

    Attributes:
        given, tension: of each triangle; the second with what a force on a sphere makes of it.
        density: of outer forces, in a droplet.
        x: nodes, shape (n, 3).
        kind, owner: of each node, and its droplet, or its film.
        ways: two directions along which it moves, shape (n, 2, 3); 0 where it does not.
        sides: nodes of triangles, counterclockwise from outside their droplet, shape (T, 3); those
            of a film are here twice.
        drop, film: of each; film is -1 on free surfaces.
        shift: what is added to a node so that the center of its droplet is the origin, (T, 3, 3).
        pressures: of the droplets, at their centers.
    """

    def __init__(
        self,
        cluster: Cluster,
        nodes: tuple[Floats, Integers, Integers, Floats],
        sides: tuple[Integers, Integers, Integers, Floats],
        pressures: Floats,
    ) -> None:
        self.cluster, self.pressures = cluster, pressures
        self.x, self.kind, self.owner, self.ways = nodes
        self.sides, self.drop, self.film, self.shift = sides
        adhesion = np.array([*(film.adhesion for film in cluster.films), 0.0])
        self.given = self.tension = cluster.tensions[self.drop] - adhesion[self.film] / 2.0
        self.density = cluster.outer / self._full()[:, None]

    @classmethod
    def of(cls, cluster: Cluster, rims: list[Floats], nodes: int) -> _Mesh:
        """A mesh between rims."""
        points: list[tuple[Floats, Integers, Integers, Floats]] = []
        sides: list[tuple[Integers, Integers, Integers, Floats]] = []
        starts: list[int] = []

        def add_nodes(at: Floats, kind: int, owner: int, first: Floats, second: Floats) -> int:
            start, size = sum(len(each[0]) for each in points), len(at)
            both = np.stack([first, second], axis=1)
            points.append((at, np.full(size, kind), np.full(size, owner), both))
            return start

        def add_sides(triangles: Integers, drop: int, film: int, shift: Floats) -> None:
            size = len(triangles)
            sides.append((triangles, np.full(size, drop), np.full(size, film), shift))

        for k, rim in enumerate(rims):
            normal, film = cluster.axes()[k], cluster.films[k]
            inner, triangles = _disk(rim)
            a, b, c = (np.concatenate([rim, inner])[triangles[:, n]] for n in range(3))
            down = np.cross(b - a, c - a) @ normal < 0.0
            triangles[down] = triangles[down, ::-1]
            away = rim - rim.mean(axis=0)  # and across the line of centers
            away = _unit(away - (away @ normal)[:, None] * normal)
            starts.append(add_nodes(rim, _RIM, k, np.tile(normal, (len(rim), 1)), away))
            add_nodes(inner, _FILM, k, np.tile(normal, (len(inner), 1)), np.zeros_like(inner))
            triangles += starts[k]
            still = np.zeros((*triangles.shape, 3))
            add_sides(triangles, film.i, k, still - cluster.centers[film.i])
            back = triangles[:, ::-1]
            add_sides(back, film.j, k, still - film.lattice - cluster.centers[film.j])
        for d, center in enumerate(cluster.centers):
            around = cluster.around(d)
            seen = [rims[k] + shift - center for k, shift in around]
            u, triangles = _sphere([_unit(edge) for edge in seen], nodes)
            free = u[sum(map(len, seen)) :]
            middles = np.array([edge.mean(axis=0) for edge in seen]).reshape(-1, 3)
            square = np.einsum("kj,kj->k", middles, middles)
            along = free @ middles.T
            bound = np.where(along > 0.0, square / np.maximum(along, 1e-9), np.inf)
            most = _SWOLLEN * cluster.radii[d]  # films have pushed it aside
            reach = bound.min(axis=1, initial=most)[:, None] * free
            start = add_nodes(center + reach, _FREE, d, free, np.zeros_like(free))
            number = [starts[k] + np.arange(len(rims[k])) for k, _ in around]
            shifts = [np.tile(shift, (len(rims[k]), 1)) for k, shift in around]
            numbers = np.concatenate([*number, start + np.arange(len(free))])
            shift = np.concatenate([*shifts, np.zeros_like(free)]) - center
            add_sides(numbers[triangles], d, -1, shift[triangles])
        x, kind, owner, ways = (np.concatenate(each) for each in zip(*points, strict=True))
        all_sides, drop, of, shift = (np.concatenate(each) for each in zip(*sides, strict=True))
        pressures = 2.0 * cluster.tensions / cluster.radii
        return cls(cluster, (x, kind, owner, ways), (all_sides, drop, of, shift), pressures)

    def halved(self) -> _Mesh:
        """Four triangles for each."""
        pairs = np.concatenate([self.sides[:, [k, (k + 1) % 3]] for k in range(3)])
        edges, which = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True)
        which = which.reshape(3, -1)
        of_film, of_free = (np.zeros(len(edges), dtype=bool) for _ in range(2))
        of_film[which[:, self.film >= 0]] = True
        of_free[which[:, self.film < 0]] = True
        kind = np.where(of_film, np.where(of_free, _RIM, _FILM), _FREE)
        a, b = edges.T
        middle = (self.x[a] + self.x[b]) / 2.0
        owner, ways = self.owner[a].copy(), (self.ways[a] + self.ways[b]) / 2.0
        # of free surfaces seen from the center of a droplet
        seen = self.x[self.sides] + self.shift
        free = self.film < 0
        for k in range(3):
            own = free & (kind[which[k]] == _FREE)
            ends = seen[own][:, [k, (k + 1) % 3]]
            direction = _unit(ends.sum(axis=1))
            reach = np.linalg.norm(ends, axis=2).mean(axis=1)
            at, drop = which[k, own], self.drop[own]
            owner[at] = drop
            middle[at] = reach[:, None] * direction + self.cluster.centers[drop]
            ways[at] = 0.0
            ways[at, 0] = direction
        ways[kind == _FILM, 1] = 0.0
        size = np.linalg.norm(ways, axis=2, keepdims=True)
        ways = ways / np.where(size > 0.0, size, 1.0)
        count = len(self.x)
        nodes = (
            np.concatenate([self.x, middle]),
            np.concatenate([self.kind, kind]),
            np.concatenate([self.owner, owner]),
            np.concatenate([self.ways, ways]),
        )
        corner, center = self.sides.T, -self.cluster.centers[self.drop]
        at = [self.shift[:, k] for k in range(3)]
        # a node on a film is where both ends of the edge are
        mid = [np.where(kind[which[k]][:, None] == _FREE, center, at[k]) for k in range(3)]
        half = [count + which[k] for k in range(3)]
        parts = [(corner[k], half[k], half[(k + 2) % 3]) for k in range(3)] + [tuple(half)]
        shifts = [(at[k], mid[k], mid[(k + 2) % 3]) for k in range(3)] + [tuple(mid)]
        sides = (
            np.concatenate([np.stack(each, axis=1) for each in parts]),
            np.tile(self.drop, 4),
            np.tile(self.film, 4),
            np.concatenate([np.stack(each, axis=1) for each in shifts]),
        )
        return _Mesh(self.cluster, nodes, sides, self.pressures)

    def rims(self) -> list[Floats]:
        """Of all films, smoothed."""
        found = []
        for k in range(len(self.cluster.films)):
            rim = self.x[(self.kind == _RIM) & (self.owner == k)]
            modes = np.fft.rfft(rim, axis=0)
            modes[_HARMONICS + 1 :] = 0.0
            found.append(np.fft.irfft(modes, len(rim), axis=0))
        return found

    # Newton's method

    def settle(self, pinned: bool = False) -> None:
        """Find the shape, of free surfaces alone if films are pinned."""
        for _ in range(_ITERATIONS):
            if self.step(pinned) < _SMALLEST_STEP:
                return
        raise ArithmeticError(f"no shape was found in {_ITERATIONS} iterations")

    def step(self, pinned: bool = False) -> float:
        """One step; the largest change over a radius."""
        moves = (self.ways != 0.0).any(axis=2)
        if pinned:
            moves &= (self.kind == _FREE)[:, None]
        number = np.where(moves, np.cumsum(moves).reshape(moves.shape) - 1, -1)
        if self.cluster.spheres:
            each = np.append(self._lean() * self._areas(), 0.0)  # of both sides
            self.tension = self.given - each[self.film]
        slope, growth, hessian = self._system(number, int(moves.sum()))
        volume = self._volumes()
        rows = None if pinned else self._rigid(number, int(moves.sum()))
        blocks = [[hessian, -growth.T], [-growth, None]]
        right = [-slope + growth.T @ self.pressures, volume - self._full()]
        if rows is not None and rows.shape[0] > 0:
            blocks = [[*blocks[0], rows.T], [*blocks[1], None], [rows, None, None]]
            right.append(np.zeros(rows.shape[0]))
        solved = _solved(csc_matrix(bmat(blocks)), np.concatenate(right))
        change = np.where(moves, solved[number], 0.0)
        radius = np.empty(len(self.x))
        sizes = np.array([film.radius for film in self.cluster.films])
        free = self.kind == _FREE
        radius[free] = self.cluster.radii[self.owner[free]]
        radius[~free] = sizes[self.owner[~free]]
        relative = np.abs(change).max(axis=1) / radius  # of a film, that of its rim
        largest = np.where(free, _LARGEST_STEP, _LARGEST_MOVE)
        part = min(1.0, float((largest / np.maximum(relative, 1e-99)).min()))
        self.x = self.x + part * np.einsum("nw,nwj->nj", change, self.ways)
        self.pressures = self.pressures + part * solved[moves.sum() :][: len(self.pressures)]
        return float(relative.max())

    def _lean(self) -> Floats:
        """c of each film."""
        i, j = self.cluster.ends()
        along = np.einsum("mj,mj->m", self.cluster.axes(), self.density[i] - self.density[j])
        return np.asarray(along / (4.0 * math.pi))

    def _areas(self) -> Floats:
        """Of films, each of which has two sides."""
        area, on = np.linalg.norm(self._seen()[1], axis=1) / 4.0, self.film >= 0
        return _sums(self.film[on], area[on], len(self.cluster.films))

    def _full(self) -> Floats:
        return np.asarray(VOLUME * self.cluster.radii**3)

    def _seen(self) -> tuple[Floats, Floats, Floats]:
        """Nodes of triangles about their center, normals of twice the area, sixfold volumes."""
        at = self.x[self.sides] + self.shift
        normal = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
        sixfold = np.einsum("tj,tj->t", at[:, 0], np.cross(at[:, 1], at[:, 2]))
        return at, normal, sixfold

    def _volumes(self) -> Floats:
        return _sums(self.drop, self._seen()[2] / 6.0, len(self.pressures))

    def _corners(self) -> tuple[Floats, Floats, Floats]:
        """By the corners of triangles: slopes of area times tension, of six times the volume, and
        of the work of the outer forces."""
        at, normal, sixfold = self._seen()
        across = np.roll(at, -1, axis=1) - np.roll(at, -2, axis=1)
        size = np.linalg.norm(normal, axis=1)
        area = np.cross(across, normal[:, None]) * (self.tension / (2.0 * size))[:, None, None]
        volume = np.cross(np.roll(at, -1, axis=1), np.roll(at, -2, axis=1))
        push = self.density[self.drop]
        height = np.einsum("tj,tj->t", at.mean(axis=1), push) * 0.75
        work = (
            height[:, None, None] * volume / 6.0 + (sixfold / 24.0)[:, None, None] * push[:, None]
        )
        return area, volume, work

    def _system(self, number: Integers, count: int) -> tuple[Floats, Floats, csc_matrix]:
        """Slope of E and of the outer forces' work, of volumes, and second derivatives."""
        at, normal, _ = self._seen()
        area, volume, work = self._corners()
        ways = self.ways[self.sides]
        numbers = number[self.sides]

        def along(corners: Floats) -> Floats:
            return np.asarray(np.einsum("tcj,tcwj->tcw", corners, ways).reshape(len(ways), 6))

        flat, there = numbers.reshape(len(ways), 6), numbers.reshape(-1) >= 0
        own = flat.ravel()[there]
        slope = _sums(own, along(area - work).ravel()[there], count)
        of_volume = along(volume)
        drops = np.repeat(self.drop, 6)[there]
        growth = coo_matrix(
            (of_volume.ravel()[there] / 6.0, (drops, own)), (len(self.pressures), count)
        ).tocsr()
        # |N|/2 with dN by corner k along v: v x (x_(k+1) - x_(k+2))
        across = np.roll(at, -1, axis=1) - np.roll(at, -2, axis=1)
        turns = np.cross(ways, across[:, :, None]).reshape(len(ways), 6, 3)
        size = np.linalg.norm(normal, axis=1)
        on_normal = np.einsum("tij,tj->ti", turns, normal)
        second = np.einsum("tij,tkj->tik", turns, turns)
        push = self.density[self.drop]
        height = 0.75 * np.einsum("tj,tj->t", at.mean(axis=1), push)
        inside = (self.pressures[self.drop] + height) / 6.0
        of_push = np.einsum("tcwj,tj->tcw", ways, push).reshape(len(ways), 6) / 24.0
        bend = of_volume[:, :, None] * of_push[:, None]
        by_volume = -(bend + bend.transpose(0, 2, 1))
        for k in range(3):
            one, next_one = slice(2 * k, 2 * k + 2), slice(2 * ((k + 1) % 3), 2 * ((k + 1) % 3) + 2)
            cross = np.cross(ways[:, k, :, None], ways[:, (k + 1) % 3, None])
            by_normal = np.einsum("tabj,tj->tab", cross, normal)
            by_place = np.einsum("tabj,tj->tab", cross, at[:, (k + 2) % 3])
            second[:, one, next_one] += by_normal
            second[:, next_one, one] += by_normal.transpose(0, 2, 1)
            by_place *= inside[:, None, None]
            by_volume[:, one, next_one] -= by_place
            by_volume[:, next_one, one] -= by_place.transpose(0, 2, 1)
        second -= on_normal[:, :, None] * on_normal[:, None] / (size**2)[:, None, None]
        second *= (self.tension / (2.0 * size))[:, None, None]
        second += by_volume
        rows, columns = np.repeat(flat, 6, axis=1).ravel(), np.tile(flat, 6).ravel()
        keep = (rows >= 0) & (columns >= 0)
        hessian = coo_matrix((second.ravel()[keep], (rows[keep], columns[keep])), (count, count))
        return slope, growth, hessian.tocsc()

    def _rigid(self, number: Integers, count: int) -> csc_matrix:
        """Shifts and turns that nothing holds, which a step leaves out."""
        home, on = self.owner.copy(), self.kind != _FREE
        home[on] = self.cluster.ends()[0][self.owner[on]]
        keep, found = number >= 0, []
        for place, turns in self.cluster.parts():
            at = self.x + place[home]
            there = ~np.isnan(at[:, 0])
            at = np.where(there[:, None], at - at[there].mean(axis=0), 0.0)
            fields = [np.where(there[:, None], axis, 0.0) for axis in np.eye(3)]
            fields += [np.cross(axis, at) for axis in np.eye(3)] if turns else []
            for field in fields:
                along = np.einsum("nj,nwj->nw", field, self.ways)
                row = np.zeros(count)
                row[number[keep]] = along[keep]
                found.append(row / np.linalg.norm(field))
        # a turn of two droplets about their line of centers moves nothing
        _, size, rows = np.linalg.svd(np.array(found), full_matrices=False)
        return csc_matrix(rows[size > _NO_MOVE])

    def _spheres(self, at: Floats) -> Floats:
        """Energies of polyhedra of the same volumes with all nodes at one distance."""
        u, count = _unit(at), len(self.pressures)
        normal = np.cross(u[:, 1] - u[:, 0], u[:, 2] - u[:, 0])
        area = _sums(self.drop, np.linalg.norm(normal, axis=1) / 2.0, count)
        volume = _sums(self.drop, np.einsum("tj,tj->t", u[:, 0], normal) / 6.0, count)
        return np.asarray(self.cluster.tensions * area * (self._full() / volume) ** (2.0 / 3.0))

    def found(self, seconds: float) -> Found:
        """What the shape tells."""
        at, normal, sixfold = self._seen()
        count = len(self.pressures)
        area = np.linalg.norm(normal, axis=1) / 2.0
        energies = _sums(self.drop, self.given * area, count) - self._spheres(at)
        moment = (sixfold / 24.0)[:, None] * at.sum(axis=1)
        middle = np.stack([_sums(self.drop, part, count) for part in moment.T], axis=1)
        middle /= self._full()[:, None]
        by_area, by_volume, work = self._corners()
        inside = self.pressures[self.drop] / 6.0
        push = inside[:, None, None] * by_volume + work
        push -= np.where(self.film < 0, 1.0, 0.0)[:, None, None] * by_area
        forces, areas = np.zeros((len(self.cluster.films), 3)), self._areas()
        held, owner = self.kind[self.sides] != _FREE, self.owner[self.sides]
        for k, film in enumerate(self.cluster.films):
            seen = np.isclose(self.shift, -self.cluster.centers[film.i]).all(axis=2)
            corners = held & (owner == k) & seen & (self.drop == film.i)[:, None]
            forces[k] = push[corners].sum(axis=0)
        pressures = self.pressures + np.einsum("nj,nj->n", self.density, middle)
        centroids = self.cluster.centers + middle
        return Found(energies, pressures, centroids, forces, areas, len(self.x), seconds)

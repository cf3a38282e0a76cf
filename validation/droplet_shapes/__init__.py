"""The exact shape of one droplet between planes, by finite elements.

A droplet of tension 1 and volume 4 pi/3 about the origin, with r = exp(rho) in the direction u, has
the least area A at its volume V between planes n_c.x <= 1 - a_c, which bound rho:

    rho <= ln((1 - a_c)/(n_c.u))
    A = sum |x_i x x_j + x_j x x_k + x_k x x_i|/2,    V = sum x_i.(x_j x x_k)/6

over the flat triangles between nodes x = exp(rho) u. Newton's method finds rho, the pressure p, and
which nodes lie on planes (a primal-dual active set: Hintermueller, Ito, Kunisch, SIAM J. Optim. 13,
865 (2002)). The force of a plane is what holds its nodes, dA = -sum f_c dh_c. Meshes are fine at
the rims of facets; each level halves all edges, and what two levels tell is extrapolated, as errors
fall with the square of the edges.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import bmat, csr_matrix
from scipy.sparse.linalg import splu
from scipy.spatial import ConvexHull

Floats = NDArray[np.float64]

VOLUME = 4.0 * math.pi / 3.0

# Nodes of the first mesh, and how often it is refined at the rims of facets.
_NODES, _GRADED = 1500, 3

# Stiffness against shifts, in steps alone, not in what is solved.
_HOLD = 1e-4

_ITERATIONS, _LARGEST_STEP, _SMALLEST_STEP = 100, 0.3, 1e-10


class Shape(NamedTuple):
    """A droplet between planes.

    Attributes:
        energy: area above that of the sphere.
        pressure: inside.
        forces: of each plane, shape (C,).
        energy_error, pressure_error, force_error: what the last extrapolation has changed, a bound
            of the errors in practice; of forces the largest one.
        nodes: of the finest mesh.
    """

    energy: float
    pressure: float
    forces: Floats
    energy_error: float
    pressure_error: float
    force_error: float
    nodes: int


def shape(normals: ArrayLike, indentations: ArrayLike, levels: int = 3) -> Shape:
    """The droplet between planes n_c.x <= 1 - a_c.

    Args:
        normals: unit vectors n_c, shape (C, 3).
        indentations: a_c, shape (C,).
        levels: of the mesh, at least 3.

    Raises:
        ValueError: fewer levels; an indentation of 1 or more.
        ArithmeticError: Newton's method fails, as for droplets squeezed beyond their volume.
    """
    if levels < 3:
        raise ValueError(f"levels must be 3 or more, not {levels}")
    largest = np.max(indentations, initial=0.0)
    if not largest < 1.0:
        raise ValueError(f"planes must be beyond the origin, indentations below 1, not {largest}")
    n, heights = np.asarray(normals, dtype=float), 1.0 - np.asarray(indentations, dtype=float)
    mesh = _Mesh(_spiral(_NODES))
    found = _relaxed(mesh, n, heights, np.zeros(_NODES))
    for _ in range(_GRADED):
        mesh, rho = mesh.refined(_at_rims(mesh.triangles, found.held), found.rho)
        found = _relaxed(mesh, n, heights, rho)
    rows = [found.values]
    for _ in range(levels - 1):
        mesh, rho = mesh.refined(np.ones(len(mesh.u), dtype=bool), found.rho)
        found = _relaxed(mesh, n, heights, rho)
        rows.append(found.values)
    last, before = ((4.0 * rows[k] - rows[k - 1]) / 3.0 for k in (-1, -2))
    error = np.abs(last - before)
    energy, pressure = last[:2]
    return Shape(
        float(energy),
        float(pressure),
        last[2:],
        *map(float, (error[0], error[1], error[2:].max())),
        len(mesh.u),
    )


class _Relaxed(NamedTuple):
    values: Floats  # energy, pressure, forces
    rho: Floats
    held: NDArray[np.bool_]  # nodes on planes


def _spiral(number: int) -> Floats:
    """Points on the unit sphere, evenly."""
    k = np.arange(number) + 0.5
    z = 1.0 - 2.0 * k / number
    angle, r = math.pi * (1.0 + math.sqrt(5.0)) * k, np.sqrt(1.0 - z * z)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


def _at_rims(triangles: NDArray[np.int32], held: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Nodes of triangles at the rims of facets, and of their neighbors."""
    near = np.zeros(len(held), dtype=bool)
    near[triangles[held[triangles].any(axis=1) & ~held[triangles].all(axis=1)]] = True
    near[triangles[near[triangles].any(axis=1)]] = True
    return near


class _Mesh:
    """Delaunay triangles between directions u, counterclockwise from outside."""

    def __init__(self, u: Floats) -> None:
        self.u = u
        triangles = ConvexHull(u).simplices
        a, b, c = (u[triangles[:, k]] for k in range(3))
        inwards = np.einsum("tj,tj->t", np.cross(b - a, c - a), a) < 0.0
        triangles[inwards] = triangles[inwards, ::-1]
        self.triangles = triangles
        a, b, c = (u[triangles[:, k]] for k in range(3))
        self.opposite = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
        self.sixfold = np.einsum("tj,tj->t", a, self.opposite[:, 0])

    def refined(self, near: NDArray[np.bool_], rho: Floats) -> tuple[_Mesh, Floats]:
        """A mesh with further nodes in the middle of edges between those that are `near`."""
        sides = np.concatenate([self.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
        edges = np.unique(np.sort(sides[near[sides].all(axis=1)], axis=1), axis=0)
        middle = self.u[edges].sum(axis=1)
        middle /= np.linalg.norm(middle, axis=1)[:, None]
        between = rho[edges].mean(axis=1)
        return _Mesh(np.concatenate([self.u, middle])), np.concatenate([rho, between])

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
        return np.bincount(self.triangles.ravel(), corners.ravel(), len(self.u))

    def sphere(self) -> float:
        """Area of the polyhedron with all nodes at one distance, and the volume of a droplet."""
        zero = np.zeros(len(self.u))
        return self.area(zero)[0] * (VOLUME / self.volume(zero)[0]) ** (2.0 / 3.0)


def _relaxed(mesh: _Mesh, normals: Floats, heights: Floats, rho: Floats) -> _Relaxed:
    along = np.maximum(mesh.u @ normals.T, 1e-9)
    bounds = np.log(heights / along)
    plane, bound = bounds.argmin(axis=1), bounds.min(axis=1)
    rho = np.minimum(rho, bound)
    held, pressure = rho == bound, 2.0
    for _ in range(_ITERATIONS):
        _, slope, curvature = mesh.area(rho)
        volume, growth, each = mesh.volume(rho)
        hessian = mesh.matrix(curvature - pressure * each[:, None, None])
        step, free = np.where(held, bound - rho, 0.0), ~held
        rest = pressure * growth - slope - hessian @ step
        side = growth[free, None]
        moves = side * mesh.u[free]  # what a shift of the droplet does: planes may allow it
        system = bmat(
            [
                [hessian[free][:, free], -side, moves],
                [-side.T, None, None],
                [moves.T, None, -np.eye(3) / _HOLD],
            ]
        ).tocsc()
        missing = VOLUME - volume - growth @ step
        solved = splu(system).solve(np.concatenate([rest[free], [-missing], np.zeros(3)]))
        step[free], change = solved[: len(side)], solved[len(side)]
        part = min(1.0, _LARGEST_STEP / np.abs(step).max())
        rho, pressure = rho + part * step, pressure + part * change
        push = pressure * growth - slope - part * (hessian @ step)
        then, held = held, np.where(held, push > 0.0, rho > bound)
        if np.abs(step).max() < _SMALLEST_STEP and np.array_equal(held, then):
            break
    else:
        raise ArithmeticError(f"no shape was found in {_ITERATIONS} iterations")
    area, slope, _ = mesh.area(rho)
    push = np.where(held, pressure * mesh.volume(rho)[1] - slope, 0.0)
    forces = np.bincount(plane, push, len(heights)) / heights
    return _Relaxed(np.array([area - mesh.sphere(), pressure, *forces]), rho, held)

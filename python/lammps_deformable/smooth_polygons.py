"""Smooth polygons at rest: Newton's method on contacts that are soft at first.

The energy has flat directions, because polygons turn almost freely in each other, and its second
derivatives jump where vertices get into touch. FIRE creeps there; damped steps of Newton's method
do not. Soft contacts let polygons find their places before hard ones decide: without them packings
stay caught, at up to twice the energy (benchmarks/smooth_minimizers.py).
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import core
from .box import cartesian, fractional
from .hessian import factored
from .relax import polygon_forces

if TYPE_CHECKING:
    from collections.abc import Callable

    from .polygons import DeformablePolygon, Polygons

Array = NDArray[np.float64]

# Stiffnesses of contacts over kr, one after the other, and the residual at which a soft one ends.
_SOFT, _SOFT_TOLERANCE = (0.002, 0.02, 0.2, 1.0), 1e-3

# Steps at each stiffness; loose packings never end. Jammed ones took up to 700: in mixtures stiff
# polygons first regain their size, in steps of the length below.
_STEPS = 1000

# Largest step of a vertex over the range of contacts, so that polygons do not pass through each
# other.
_LARGEST_STEP = 0.2

# A line search ends where the slope has fallen to this part, or after so many evaluations. Energies
# are equal within this part, their rounding.
_FLAT, _TRIALS, _ROUNDING = 0.5, 12, 1e-12

# First damping, and the one at which forces are rounding [energy/length^2].
_DAMPING, _MOST_DAMPING = 1e-3, 1e6


@dataclass(frozen=True, eq=False)
class SmoothPolygons:
    """Smooth polygons in a periodic box: all that their energy depends on, besides the vertices.

    Attributes:
        beads: the settings.
        polygons: the undeformed polygons of each species.
        species: of each polygon, shape (N,).
        box: lattice vectors as rows, shape (2, 2) [length].
    """

    model: DeformablePolygon
    polygons: Polygons
    species: NDArray[np.int64]
    box: Array

    @property
    def number(self) -> NDArray[np.int64]:
        """Vertices of each polygon, shape (N,)."""
        return self.polygons.number[self.species]

    def energy(self, vertices: Array, softness: float = 1.0) -> core.SmoothPolygonEnergy:
        """Energy and derivatives, with contacts of the stiffness kr times a factor.

        Args:
            vertices: of all polygons, each polygon unwrapped, shape (V, 2) [length].
            softness: the factor.
        """
        polygons, kind = self.polygons, self.species
        return core.smooth_polygons(
            vertices,
            self.number,
            self.box,
            polygons.kL[kind],
            polygons.spacing[kind],
            polygons.kA[kind],
            polygons.area[kind],
            softness * self.model.kr,
            2.0 * self.model.radius,
        )

    def residual(self, at: core.SmoothPolygonEnergy) -> float:
        """Largest force on a vertex over that on a vertex in a contact."""
        largest = float(np.linalg.norm(at.gradient, axis=1).max())
        spacing = self.polygons.spacing[self.species]
        return polygon_forces(largest, at.pressure, spacing, self.box, self.polygons.kL).residual


def relax_smooth(
    polygons: SmoothPolygons,
    vertices: Array,
    tolerance: float,
    each: Callable[[float], object] = lambda residual: None,
) -> Array:
    """Vertices of smooth polygons that minimize their energy.

    Args:
        polygons: their settings and box.
        vertices: at the start, shape (V, 2) [length].
        tolerance: of the residual, see `SmoothPolygons.residual`. It is not reached where polygons
            are so loose that nothing holds them.
        each: called with the residual after each step.
    """
    start = polygons.energy(vertices)
    if polygons.residual(start) <= tolerance:
        return vertices
    # contacts so soft that vertices sink in by half of their range would let them pass
    spacing = polygons.polygons.spacing[polygons.species]
    deepest = float(np.max(start.pressure * spacing)) / polygons.model.kr
    softest = deepest / polygons.model.radius
    for softness in _SOFT:
        if softness >= min(softest, 1.0):
            stop = tolerance if softness == 1.0 else _SOFT_TOLERANCE
            relaxed = _minimize(polygons, vertices, softness, stop, each)
            # contacts that let polygons cross were too soft: the next ones start from the same
            # place
            if softness == 1.0 or not have_crossed(polygons, relaxed):
                vertices = relaxed
    return vertices


def have_crossed(polygons: SmoothPolygons, vertices: Array) -> bool:
    """Whether the outlines of two polygons intersect, which contacts do not undo."""
    import shapely

    owner = np.repeat(np.arange(len(polygons.species)), polygons.number)
    center = np.add.reduceat(vertices, np.cumsum(polygons.number) - polygons.number, axis=0)
    box = cartesian(
        np.floor(fractional(center / polygons.number[:, None], polygons.box)), polygons.box
    )
    home = vertices - box[owner]  # polygons are smaller than the box: neighbors are next to it
    tree = shapely.STRtree(shapely.linearrings(home, indices=owner))
    for x, y in product((0, 1), (-1, 0, 1)):
        image = shapely.linearrings(home + cartesian(np.array([x, y]), polygons.box), indices=owner)
        a, b = tree.query(image, predicate="intersects")
        if np.any((a != b) | ((x, y) != (0, 0))):
            return True
    return False


def _minimize(
    polygons: SmoothPolygons,
    vertices: Array,
    softness: float,
    tolerance: float,
    each: Callable[[float], object],
) -> Array:
    """Levenberg and Marquardt's damping of Newton's steps, with a line search along each."""

    def energy(x: Array) -> core.SmoothPolygonEnergy:
        return polygons.energy(x, softness)

    at, damping = energy(vertices), _DAMPING
    for _ in range(_STEPS):
        residual = polygons.residual(at)
        each(residual)
        if residual <= tolerance or damping > _MOST_DAMPING:
            break
        step, damping = _step(polygons, at, damping)
        longest = float(np.linalg.norm(step, axis=1).max())
        step *= min(1.0, _LARGEST_STEP * 2.0 * polygons.model.radius / longest)
        part, there = _line_search(energy, vertices, at, step)
        if there is None:
            damping *= 10.0
            continue
        vertices, at = vertices + part * step, there
        if part > 0.5:
            damping /= 5.0
        elif part < 0.1:
            damping *= 4.0
    return vertices


def _step(
    polygons: SmoothPolygons, at: core.SmoothPolygonEnergy, damping: float
) -> tuple[Array, float]:
    """A step downhill, (H + damping) s = -g, and the damping that it needed.

    H = H' + sum kA grad(A) grad(A)^T has dense blocks. With the pressures t of the areas as
    unknowns it is sparse:  (H' + damping) s + grad(A) t = -g,   grad(A)^T s - t/kA = 0.
    """
    from scipy.sparse import csc_matrix

    gradient, slope = at.gradient.ravel(), at.area_gradient.ravel()
    size, extra = gradient.size, len(polygons.species)
    row, column, value = at.hessian()
    of_all = np.arange(size)
    area = size + np.repeat(np.arange(extra), 2 * polygons.number)
    last = size + np.arange(extra)
    rows = np.concatenate([row, of_all, area, last, of_all])
    columns = np.concatenate([column, area, of_all, last, of_all])
    fixed = np.concatenate([value, slope, slope, -1.0 / polygons.polygons.kA[polygons.species]])
    right = np.concatenate([-gradient, np.zeros(extra)])
    while damping <= _MOST_DAMPING:
        values = np.concatenate([fixed, np.full(size, damping)])
        matrix = csc_matrix((values, (rows, columns)), shape=(size + extra, size + extra))
        with suppress(RuntimeError):  # of a singular matrix
            step = factored(matrix)(right)[:size]
            if core.dot(gradient, step) < 0.0:
                return step.reshape(-1, 2), damping
        damping *= 10.0
    return at.gradient / -damping, damping  # the damping is all that counts


def _line_search(
    energy: Callable[[Array], core.SmoothPolygonEnergy],
    x: Array,
    at: core.SmoothPolygonEnergy,
    step: Array,
) -> tuple[float, core.SmoothPolygonEnergy | None]:
    """The part of a step that lowers the energy and halves its slope, and the energy there.

    Evaluations are cheap against the factors of a step. Returns None if no part was found.
    """
    start, slope = at.energy, core.dot(at.gradient, step)
    low, high, low_slope, part = 0.0, 1.0, slope, 1.0
    lowest: tuple[float, core.SmoothPolygonEnergy | None] = (0.0, None)
    for _ in range(_TRIALS):
        there = energy(x + part * step)
        here = core.dot(there.gradient, step)
        rounded = abs(there.energy - start) < _ROUNDING * start and abs(here) < abs(slope)
        lower = there.energy < start + 1e-4 * part * slope or rounded
        if lower:
            lowest = part, there
            if abs(here) <= _FLAT * abs(slope) or (part == 1.0 and here < 0.0):
                break
        if here > 0.0:
            high = part
            share = low_slope / (low_slope - here)
            part = low + (high - low) * min(max(share, 0.1), 0.9)
        else:
            low, low_slope, high = (part, here, high) if lower else (low, low_slope, part)
            part = 0.5 * (low + high)
    return lowest

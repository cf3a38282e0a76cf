"""What a plane at a height cuts of walls in space, as walls in the plane, and their volume."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from .corners import ROUNDING
from .distances import Distances
from .lattice import fractional, lengths, widths
from .room import bounds, closed, corners_between
from .wall_base import HalfSpace, sides_of
from .walls import Ball, Circle, Cone, Cylinder, Disk, Plane, Polygon, Post, Sphere, Wall

Floats = NDArray[np.float64]

# Measures the area between walls of the plane, in a box of the plane.
Area = Callable[[Sequence[Wall], Floats], float]

# Heights of sections from one of the `_levels` to the next, by Gauss' rule.
_HEIGHTS = 16


def section_between(walls: Sequence[Wall], box: Floats, height: float) -> list[Wall] | None:
    """The walls that the plane z = height cuts, as walls in the plane.

    Args:
        walls: in space.
        box: lattice vectors as rows, shape (3, 3) [length].
        height: [length].

    Returns:
        None if the plane is outside of a container.
    """
    found: list[Wall] = []
    shut, ends = closed(walls, 3)[2], bounds(walls, box)
    for wall in walls:
        cut = _cut(wall, box, height, shut, ends)
        if cut is None:
            return None
        found += cut
    return found


def _cut(wall: Wall, box: Floats, height: float, shut: bool, ends: Floats) -> list[Wall] | None:
    """What the plane cuts of a wall; `shut`: whether there are no images along z."""
    if isinstance(wall, Plane):
        *flat, nz = wall.normal
        above, square = height - wall.point[2], float(np.dot(flat, flat))
        if square <= (ROUNDING * nz) ** 2:
            return [] if nz * above > 0.0 else None
        x, y = np.subtract(wall.point[:2], np.multiply(nz * above / square, flat)).tolist()
        return [Plane((x, y), tuple(flat))]
    if isinstance(wall, Ball):
        return [
            Disk((x, y), half)
            for x, y, z in _images(wall, box, shut)
            if (half := _half_width(wall, z, height)) > 0.0
        ]
    if isinstance(wall, Post):
        return _cut_post(wall, box, height, shut, ends)
    if isinstance(wall, Cone):
        half = wall.radius_at(height)
        return [Circle(wall.center[:2], half)] if half > 0.0 else None
    if not isinstance(wall, (Sphere, Cylinder)):
        raise TypeError(wall)
    x, y, z = wall.center
    if isinstance(wall, Cylinder) and wall.axis == "z":
        return [Circle((x, y), wall.radius)]
    half = _half_width(wall, z, height)
    if half == 0.0:
        return None
    if isinstance(wall, Sphere):
        return [Circle((x, y), half)]
    corner = (x, y - half) if wall.axis == "x" else (x - half, y)
    sides = sides_of(corner, (2.0 * half, 2.0 * half))
    return [*sides[2:]] if wall.axis == "x" else [*sides[:2]]


def _cut_post(wall: Post, box: Floats, height: float, shut: bool, ends: Floats) -> list[Wall]:
    """A disk, or strips through the room."""
    if wall.axis == "z":
        return [Disk(wall.center[:2], wall.radius)]
    along = "xy".index(wall.axis)
    strips: list[Wall] = []
    for *flat, z in _images(wall, box, shut):
        if (half := _half_width(wall, z, height)) > 0.0:
            low, high = ends[:, :2].copy()
            low[1 - along], high[1 - along] = flat[1 - along] - half, flat[1 - along] + half
            (left, front), (right, back) = low.tolist(), high.tolist()
            strips.append(Polygon(((left, front), (right, front), (right, back), (left, back))))
    return strips


def _half_width(wall: Ball | Sphere | Cylinder | Post, z: float, height: float) -> float:
    """Of a round wall with its center at z, 0 where the plane does not cut it."""
    return float(np.sqrt(max(wall.radius**2 - (height - z) ** 2, 0.0)))


def _images(wall: Ball | Post, box: Floats, shut: bool) -> list[list[float]]:
    """Centers of an obstacle and of its images along z."""
    cell = 0.0 if shut else float(np.floor(fractional(wall.middle, box)[2]))
    steps = (0,) if shut else (-1, 0, 1)
    return [(wall.middle + (step - cell) * box[2]).tolist() for step in steps]


def volume_of(walls: Sequence[Wall], box: Floats, area: Area) -> float:
    """The volume between walls from the areas of sections [length^3].

    Exact to rounding where these are polynomials of the height of the second degree, as of
    polyhedra and of spheres, or begin and end as a root of such, as of a cylinder that lies.
    """
    return _volume(tuple(walls), tuple(box.ravel().tolist()), area)


@lru_cache(maxsize=64)  # a packing asks for it again and again
def _volume(walls: tuple[Wall, ...], rows: tuple[float, ...], area: Area) -> float:
    from scipy.spatial import ConvexHull

    box = np.reshape(rows, (3, 3))
    apart = [wall for wall in walls if isinstance(wall, Ball) and _is_apart(wall, walls, box)]
    within = sum(4.0 / 3.0 * np.pi * ball.radius**3 for ball in apart)
    walls = tuple(wall for wall in walls if wall not in apart)
    if not walls:
        return float(np.prod(box.diagonal())) - within
    if all(isinstance(wall, Plane) for wall in walls):
        return float(ConvexHull(corners_between(walls, box)).volume) - within
    places, weights = np.polynomial.legendre.leggauss(_HEIGHTS)
    # denser at the ends, where it turns a root into a power
    dense, weights = (3.0 * places - places**3) / 2.0, 1.5 * (1.0 - places**2) * weights
    total = -within
    for low, high in pairwise(_levels(walls, box)):
        half = 0.5 * (high - low)
        for place, weight in zip(dense.tolist(), weights.tolist(), strict=True):
            cut = section_between(walls, box, low + half * (1.0 + place))
            total += half * weight * (0.0 if cut is None else _area(cut, box[:2, :2], area))
    return total


def _is_apart(ball: Ball, walls: Sequence[Wall], box: Floats) -> bool:
    """Whether a ball crosses no other wall and no image of itself."""
    periodic = ~np.array(closed(walls, 3))
    if (widths(box)[periodic] < 2.0 * ball.radius).any():
        return False
    others = [wall for wall in walls if wall is not ball]
    _, distance = Distances(others, box)(ball.middle[None])
    return bool((distance >= ball.radius).all())


def _area(walls: Sequence[Wall], box: Floats, area: Area) -> float:
    try:
        return area(walls, box)
    except ParameterError:  # containers that do not meet at this height
        return 0.0


def _levels(walls: Sequence[Wall], box: Floats) -> list[float]:
    """Heights at which walls begin and end, and where they cross, within the room."""
    low, high = bounds(walls, box)[:, 2]
    shut = closed(walls, 3)
    found = [low, high]
    if any(shut):
        found += corners_between(walls, box)[:, 2].tolist()
    planes = [wall for wall in walls if isinstance(wall, Plane)]
    spheres: list[tuple[list[float], float]] = []
    for wall in walls:
        if isinstance(wall, (Cylinder, Post)) and wall.axis != "z":
            own = _images(wall, box, shut[2]) if isinstance(wall, Post) else [[*wall.center]]
            found += [z + sign * wall.radius for *_, z in own for sign in (-1.0, 1.0)]
        elif isinstance(wall, (Ball, Sphere)):
            own = _images(wall, box, shut[2]) if isinstance(wall, Ball) else [[*wall.center]]
            spheres += [(center, wall.radius) for center in own]
    for n, (center, radius) in enumerate(spheres):
        found += [center[2] - radius, center[2] + radius]
        cuts = [plane.half_spaces()[0] for plane in planes]
        cuts += [_radical(center, radius, *other) for other in spheres[:n]]
        for normal, offset in cuts:
            away = offset - float(normal @ center)
            if abs(away) < radius:  # they cross in a circle
                half = float(np.sqrt((radius**2 - away**2) * max(1.0 - normal[2] ** 2, 0.0)))
                middle = center[2] + away * float(normal[2])
                found += [middle - half, middle + half]
    return np.unique(np.clip(found, low, high)).tolist()


def _radical(x: list[float], r: float, other: list[float], s: float) -> HalfSpace:
    """The plane in which two spheres cross, if they do."""
    apart = np.subtract(other, x)
    distance = float(lengths(apart)) or 1.0
    along = (distance**2 + r**2 - s**2) / (2.0 * distance)
    return apart / distance, float(apart @ x) / distance + along

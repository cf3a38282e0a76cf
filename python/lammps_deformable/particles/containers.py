"""The room that walls leave to particles, in the plane and in space.

Where it ends, boxes that go with it, distances of particles from walls, its area or volume, random
centers in it, and lines that show it.

A direction in which a container ends is *closed*: the box is not periodic along it, and is as long
as the container. Obstacles repeat with the box along the other directions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import chain, combinations, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.box import cartesian, fractional, lengths, widths
from ..common.checks import shown
from ..common.errors import ParameterError
from .walls import (
    Cone,
    Cylinder,
    HalfSpace,
    Plane,
    PolygonWall,
    Segment,
    Sphere,
    SurfaceWall,
    Wall,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Normals that are nearer to a plane than this part of a radian, and parts of a normal: rounding.
ROUNDING = 1e-12

# Corners count that are outside of other half spaces by this part of the largest offset.
_OUTSIDE = 1e-12


def are_open(normals: Floats) -> bool:
    """Whether half planes or half spaces with these unit normals have no end, shape (n, d)."""
    if normals.shape[1] == 2:
        angles = np.sort(np.arctan2(normals[:, 1], normals[:, 0]))
        widest = np.diff(angles, append=angles[0] + 2.0 * np.pi).max()
        return bool(widest > np.pi - ROUNDING)
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(normals)
    except (QhullError, ValueError):  # all in a plane
        return True
    return bool((hull.equations[:, -1] >= -ROUNDING).any())  # the origin is not within


def corners_of(normals: Floats, offsets: Floats) -> Floats:
    """Corners of the points n x <= offset, shape (m, d); some may be there more than once.

    Args:
        normals: unit vectors, shape (n, d).
        offsets: shape (n,) [length].
    """
    if normals.shape[1] == 2:
        try:
            edges = core.polygon_edges(normals[:, 0], normals[:, 1], offsets)
        except ValueError:
            return np.empty((0, 2))
        return edges[~np.isnan(edges).any(axis=1)].reshape(-1, 2)
    three = np.array(list(combinations(range(len(normals)), 3)))
    a, b, c = np.moveaxis(normals[three], 1, 0)
    crossed = [np.cross(b, c), np.cross(c, a), np.cross(a, b)]
    volume = np.sum(a * crossed[0], axis=1)
    meet = np.abs(volume) > ROUNDING
    parts = offsets[three].T[..., None] * np.array(crossed)
    points = parts.sum(axis=0)[meet] / volume[meet, None]
    outside = points @ normals.T - offsets
    return points[(outside <= _OUTSIDE * np.abs(offsets).max()).all(axis=1)]


# Round walls stay round: factors along the axes agree up to this.
_SAME = 1e-9


def closed(walls: Sequence[Wall], dimension: int = 2) -> tuple[bool, ...]:
    """Whether walls close each direction."""
    shares = [np.abs(n) for wall in walls for n, _ in wall._half_spaces()]
    if not shares:
        return (False,) * dimension
    return tuple((np.max(shares, axis=0) > ROUNDING).tolist())


def bounds(walls: Sequence[Wall], box: Floats) -> Floats:
    """Lowest and highest corner of the room, as rows, shape (2, d) [length].

    In a direction that is not closed, the room goes from 0 to the length of the box.

    Raises:
        ParameterError: the container is open, or leaves no room, or the box is tilted.
    """
    ends = np.array([np.zeros(len(box)), box.diagonal()])
    shut = closed(walls, len(box))
    if not any(shut):
        return ends
    tilts = box[np.tril_indices(len(box), -1)]
    if tilts.any():
        raise ParameterError(
            f"a box with a container must be rectangular, not tilted by {tilts[tilts != 0.0][0]:g}"
        )
    corners = corners_between(walls, box)
    return np.where(shut, [corners.min(axis=0), corners.max(axis=0)], ends)


def box_between(walls: Sequence[Wall], box: Floats) -> Floats:
    """The box with the length of the container along closed directions, shape (d, d) [length]."""
    if not any(closed(walls, len(box))):
        return box
    low, high = bounds(walls, box)
    return np.diag(high - low)


def corners_between(walls: Sequence[Wall], box: Floats, around: float = 1.0) -> Floats:
    """Corners of the container within the periodic box, shape (n, d) [length].

    Args:
        walls: round ones count as squares or cubes around them.
        box: lattice vectors as rows.
        around: factor by which these are larger.

    Raises:
        ParameterError: the container is open, or leaves no room.
    """
    dimension = len(box)
    normals, offsets = half_spaces_between(walls, box, closed(walls, dimension), around)
    if are_open(normals):
        raise ParameterError(
            "the planes leave the room open: add planes that enclose it, or take a `BoxWall`"
        )
    corners = corners_of(normals, offsets)
    if len(corners) <= dimension or np.ptp(corners, axis=0).min() <= 0.0:
        others = "circles" if dimension == 2 else "round walls"
        raise ParameterError(
            f"planes and {others} leave no room: a plane's normal must point to the particles"
        )
    return corners


def half_spaces_between(
    walls: Sequence[Wall], box: Floats, shut: Sequence[bool], around: float = 1.0
) -> tuple[Floats, Floats]:
    """Unit normals, shape (n, d), and offsets, shape (n,), of walls and of periodic sides."""
    rows = [row for wall in walls for row in wall._half_spaces(around)]
    for n, length, end in zip(np.eye(len(box)), box.diagonal(), shut, strict=True):
        if not end:
            rows += [(n, length), (-n, 0.0)]
    normals = np.array([n for n, _ in rows]).reshape(-1, len(box))
    return normals, np.array([offset for _, offset in rows])


def check_fit(walls: Sequence[Wall], box: Floats, cutoff: float) -> None:
    """Refuse obstacles that LAMMPS would not repeat with the periodic box.

    Args:
        walls: the shapes.
        box: lattice vectors as rows, shape (d, d) [length].
        cutoff: distance from the center of a particle at which walls begin to count [length].
    """
    shuts, around = closed(walls, len(box)), "circle" if len(box) == 2 else "sphere"
    for n, wall in enumerate(walls, start=1):
        if wall.inside:
            continue
        for axis, length, shut in zip("xyz", box.diagonal(), shuts, strict=False):
            if isinstance(wall, Cylinder) and axis == wall.axis:
                if (tilt := box["xyz".index(axis)]).astype(bool).sum() > 1:
                    raise ParameterError(
                        f"post {n} is not along an edge of the box, {tilt.tolist()}: its axis must "
                        "be x, or the box not tilted"
                    )
                continue
            if not shut and wall._extent + cutoff > 0.5 * length:
                raise ParameterError(
                    f"{wall._kind} {n} does not fit into the periodic box: a {around} around it "
                    f"and the reach of particles, {wall._extent:.4g} + {cutoff:.4g}, exceed half "
                    f"of the box along {axis}, {0.5 * length:.4g}; take a larger box, smaller "
                    "obstacles, or a container"
                )


def stretched(walls: Sequence[Wall], box: Floats, new: Floats) -> tuple[Wall, ...]:
    """Walls after a stretch of the box along its axes, about the origin.

    Raises:
        ParameterError: the box is sheared, or a round wall stretched in one direction.
    """
    if not walls:
        return ()
    factors = new.diagonal() / box.diagonal()
    sheared = np.abs(new - box * factors) > _SAME * new[0, 0]
    if sheared.any():
        at = tuple(np.argwhere(sheared)[0])
        raise ParameterError(
            f"a box with walls cannot be sheared: its tilt must be {(box * factors)[at]:g}, not "
            f"{new[at]:g}"
        )
    for n, wall in enumerate(walls, start=1):
        axes = list(wall._round_axes)
        if axes and np.ptp(factors[axes]) > _SAME * factors[axes[0]]:
            along = " and ".join(f"{factors[k]:g} along {'xyz'[k]}" for k in axes)
            raise ParameterError(
                f"{wall._kind} {n} must stay round: the box may be stretched by one factor only, "
                f"not by {along}"
            )
    return tuple(wall._stretched(*factors.tolist()) for wall in walls)


def in_box(walls: Sequence[Wall], box: Floats, places: Floats) -> Floats:
    """The images of places in the box, shape (N, d) [length]; walls leave no others."""
    fractions = fractional(places, box)
    cell = np.where(closed(walls, len(box)), 0.0, np.floor(fractions))
    return cartesian(fractions - cell, box)


class Distances:
    """Distances of particles from walls: the nearest point of each wall.

    Args:
        walls: the shapes.
        box: lattice vectors as rows, shape (d, d) [length].
    """

    def __init__(self, walls: Sequence[Wall], box: Floats) -> None:
        dimension = len(box)
        sides = np.where(closed(walls, dimension), 0.0, box.diagonal()).tolist()
        kind = core.Scene if dimension == 2 else core.SpaceScene
        tilts = [float(box[row, axis]) for row in range(dimension) for axis in range(row)]
        self._scene: Any = kind(*sides, *tilts)
        self._count, self._columns = len(walls), dimension + 2
        for wall in walls:
            wall._add_to(self._scene)

    def __call__(self, positions: Floats) -> tuple[Floats, Floats]:
        """Directions to the walls and distances of these N positions.

        Returns:
            Unit vectors, shape (number of walls, N, d), and distances, shape (number of walls, N)
            [length]; negative beyond a plane or round container and inside of an obstacle.
        """
        found = self._nearest(positions)
        return found[..., :-2], found[..., -2]

    def turns(self, positions: Floats) -> Floats:
        """Angle by which each direction turns for a sideways step, (number of walls, N) [1/length].

        It is 0 on a side, 1/h at a corner, 1/(rho + h) outside of a disk of radius rho, and
        -1/(rho - h) inside of a circle or sphere. At a cylinder or cone it is that for a step
        around the axis.
        """
        return self._nearest(positions)[..., -1]

    def contacts(
        self, positions: Floats, reach: float
    ) -> tuple[Integers, Integers, Floats, Floats]:
        """All contacts of these positions up to this distance; a `SurfaceWall` may have several.

        Returns:
            Numbers of positions and of walls, directions, shape (contacts, d), and distances
            [length].
        """
        rows = self._scene.contacts(np.ascontiguousarray(positions), reach)
        i, wall = rows[:, :2].astype(np.int64).T
        return i, wall, rows[:, 2:-3], rows[:, -3]

    def _nearest(self, positions: Floats) -> Floats:
        shape = self._count, len(positions), self._columns
        found: Floats = self._scene.nearest(*positions.T).reshape(shape)
        return found


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
        above, square = height - wall.origin[2], float(np.dot(flat, flat))
        if square <= (ROUNDING * nz) ** 2:
            return [] if nz * above > 0.0 else None
        x, y = np.subtract(wall.origin[:2], np.multiply(nz * above / square, flat)).tolist()
        return [Plane((x, y), tuple(flat))]
    if isinstance(wall, Cone):
        half = wall._radius_at(height)
        return [Sphere(half, tuple(wall._middle[:2]))] if half > 0.0 else None
    if isinstance(wall, SurfaceWall):
        return _cut_of_surface(wall, height)
    if not isinstance(wall, (Sphere, Cylinder)):
        raise TypeError(wall)
    if isinstance(wall, Cylinder) and wall.axis == "z":
        return [Sphere(wall.radius, tuple(wall._middle[:2]), inside=wall.inside)]
    found: list[Wall] = []
    for x, y, z in _images(wall, box, shut):
        if (half := _half_width(wall, z, height)) == 0.0:
            continue
        if isinstance(wall, Sphere):
            found.append(Sphere(half, (x, y), inside=wall.inside))
            continue
        along = "xy".index(str(wall.axis))
        low, high = ends[:, :2].copy()  # of a strip through the room
        low[1 - along], high[1 - along] = (x, y)[1 - along] - half, (x, y)[1 - along] + half
        if wall.inside:
            unit = np.eye(2)[1 - along]
            low[along], width = (x, y)[along], 2.0 * half * unit
            found += [Plane(tuple(low), tuple(unit)), Plane(tuple(low + width), tuple(-unit))]
        else:
            (left, front), (right, back) = low.tolist(), high.tolist()
            corners = ((left, front), (right, front), (right, back), (left, back))
            found.append(PolygonWall(corners))
    return found if found or not wall.inside else None


def _cut_of_surface(wall: SurfaceWall, height: float) -> list[Wall] | None:
    """Polygons of the plane z = height, and chains where the surface is open."""
    import shapely

    triangles = np.array(wall.corners)
    above = triangles[..., 2] > height
    lines = []
    for corners, up in zip(triangles, above, strict=True):
        if up.all() or not up.any():
            continue
        alone = int(np.flatnonzero(up == (up.sum() == 1))[0])  # on its side of the plane
        parts = []
        for other in (alone + 1, alone + 2):
            a, b = sorted((corners[alone].tolist(), corners[other % 3].tolist()))
            part = (height - a[2]) / (b[2] - a[2])
            parts.append((a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])))
        if parts[0] != parts[1]:
            lines.append(shapely.LineString(parts))
    whole, _, loose, _ = shapely.polygonize_full(lines)
    rings = [polygon.exterior.coords for polygon in whole.geoms]
    chains = [] if wall.inside else [line.coords for line in loose.geoms]
    found: list[Wall] = [SurfaceWall(ring, inside=wall.inside) for ring in rings]
    found += [SurfaceWall(chain) for chain in chains]
    return found if found or not wall.inside else None


def _half_width(wall: Sphere | Cylinder, z: float, height: float) -> float:
    """Of a round wall with its center at z, 0 where the plane does not cut it."""
    return float(np.sqrt(max(wall.radius**2 - (height - z) ** 2, 0.0)))


def _images(wall: Sphere | Cylinder, box: Floats, shut: bool) -> list[list[float]]:
    """Centers of a round wall, of an obstacle with those of its images along z."""
    if shut or wall.inside:
        return [wall._middle.tolist()]
    cell = float(np.floor(fractional(wall._middle, box)[2]))
    return [(wall._middle + (step - cell) * box[2]).tolist() for step in (-1, 0, 1)]


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
    if any(isinstance(wall, SurfaceWall) for wall in walls):
        return _beside_surfaces(walls, box, area)
    balls = [wall for wall in walls if isinstance(wall, Sphere) and not wall.inside]
    apart = [ball for ball in balls if _is_apart(ball, walls, box)]
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
            total += half * weight * (0.0 if cut is None else _area_at(cut, box[:2, :2], area))
    return total


def _beside_surfaces(walls: Sequence[Wall], box: Floats, area: Area) -> float:
    """The volume that surfaces leave, which cross no other walls."""
    surfaces = [wall for wall in walls if isinstance(wall, SurfaceWall)]
    others = tuple(wall for wall in walls if not isinstance(wall, SurfaceWall))
    within = sum(wall._volume for wall in surfaces if not wall.inside)
    rooms = [wall._volume for wall in surfaces if wall.inside]
    if not rooms:
        return _volume(others, tuple(box.ravel().tolist()), area) - within
    balls = [wall for wall in others if isinstance(wall, Sphere) and not wall.inside]
    if len(rooms) > 1 or len(balls) < len(others):
        raise ParameterError(
            "the volume between a SurfaceWall with inside=True and other containers or a Cylinder "
            "is not known: let it be the only container, with a Sphere or a SurfaceWall in it"
        )
    return rooms[0] - within - sum(4.0 / 3.0 * np.pi * ball.radius**3 for ball in balls)


def _is_apart(ball: Sphere, walls: Sequence[Wall], box: Floats) -> bool:
    """Whether a ball crosses no other wall and no image of itself."""
    periodic = ~np.array(closed(walls, 3))
    if (widths(box)[periodic] < 2.0 * ball.radius).any():
        return False
    others = [wall for wall in walls if wall is not ball]
    _, distance = Distances(others, box)(ball._middle[None])
    return bool((distance >= ball.radius).all())


def _area_at(walls: Sequence[Wall], box: Floats, area: Area) -> float:
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
        if isinstance(wall, Cylinder) and wall.axis != "z":
            own = _images(wall, box, shut[2])
            found += [z + sign * wall.radius for *_, z in own for sign in (-1.0, 1.0)]
        elif isinstance(wall, Sphere):
            spheres += [(center, wall.radius) for center in _images(wall, box, shut[2])]
    for n, (center, radius) in enumerate(spheres):
        found += [center[2] - radius, center[2] + radius]
        cuts = [plane._half_spaces()[0] for plane in planes]
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


# A quarter of the corners of a polygon that stands for a disk.
_QUARTER = 256


def container(walls: Sequence[Wall], box: Floats) -> Any:
    """A polygon of shapely: the container within the periodic box, or the box.

    Circles are polygons of the same area.

    Raises:
        ParameterError: see `bounds`.
    """
    import shapely

    if not any(closed(walls)):
        return shapely.Polygon([(0.0, 0.0), box[0], box[0] + box[1], box[1]])
    room = _hull(corners_between(walls, box, around=2.0))
    for wall in walls:
        if isinstance(wall, Sphere) and wall.inside:
            room = room.intersection(_round(wall))
        if isinstance(wall, SurfaceWall) and wall.inside:
            room = room.intersection(_outline_of(wall))
    if room.area == 0.0:
        raise ParameterError("planes and circles leave no room: they do not overlap")
    return room


def obstacles(walls: Sequence[Wall], box: Floats) -> list[Any]:
    """Shapes of shapely: obstacles and their images next to the box; disks as polygons."""
    from shapely.affinity import translate

    steps = [(0,) if shut else (-1, 0, 1) for shut in closed(walls)]
    shifts = [cartesian(np.array([a, b]), box) for a in steps[0] for b in steps[1]]
    solid = []
    for wall in walls:
        if wall.inside:
            continue
        own = _shape_of(wall)
        cell = np.where(closed(walls), 0.0, np.floor(fractional(wall._middle, box)))
        solid.append(translate(own, *-cartesian(cell, box)) if cell.any() else own)
    return [translate(shape, *shift) for shape in solid for shift in shifts]


def _shape_of(wall: Wall) -> Any:
    if isinstance(wall, SurfaceWall):
        return _outline_of(wall)
    return _hull(wall.corners) if isinstance(wall, (Segment, PolygonWall)) else _round(wall)


def _outline_of(wall: SurfaceWall) -> Any:
    """A polygon, or a line where it is open.

    Raises:
        ParameterError: it crosses itself.
    """
    import shapely

    if not wall._is_closed:
        return shapely.LineString(wall.corners)
    polygon = shapely.Polygon(wall.corners)
    if not polygon.is_valid:
        raise ParameterError(
            f"a SurfaceWall that is closed must not cross or touch itself: {shown(wall.corners)}"
        )
    return polygon


def _hull(points: Any) -> Any:
    import shapely

    return shapely.MultiPoint(points).convex_hull


def _round(wall: Any) -> Any:
    """A polygon of the same area."""
    import shapely

    angle = np.pi / (2.0 * _QUARTER)
    larger = wall.radius * np.sqrt(angle / np.sin(angle))
    return shapely.Point(wall._middle).buffer(larger, quad_segs=_QUARTER)


def free_room(walls: Sequence[Wall], box: Floats) -> float:
    """Area of the container, or of the box, without obstacles [length^2]; the volume in space.

    Exact to rounding; only where a round wall crosses another one, to 1e-5 of the disk or ball.

    Raises:
        ParameterError: see `bounds`, or obstacles fill the room, or are too large to compute with.
    """
    if not walls:
        return float(np.prod(box.diagonal()))
    import shapely

    what = "area" if len(box) == 2 else "volume"
    try:
        with np.errstate(all="ignore"):  # of numbers so large that areas overflow
            free = _area(walls, box) if len(box) == 2 else volume_of(walls, box, _area)
    except (shapely.errors.GEOSException, OverflowError):
        largest = max(abs(value) for wall in walls for value in wall._values)
        raise ParameterError(
            f"walls are too large to compute the {what} between them: one has the value {largest:g}"
        ) from None
    if not 0.0 < free < np.inf:
        raise ParameterError(f"obstacles fill the room: they leave no {what} to particles")
    return free


def _area(walls: Sequence[Wall], box: Floats) -> float:
    import shapely

    solid = shapely.union_all(obstacles(walls, box))
    return float(container(walls, box).difference(solid).area)


# Random places that are tried for each particle.
_TRIALS = 1000


def check_centers(walls: Sequence[Wall], box: Floats, positions: Floats) -> None:
    """Refuse particles whose center is on the wrong side of a wall."""
    _, distances = Distances(walls, box)(positions)
    for n, (wall, distance) in enumerate(zip(walls, distances, strict=True), start=1):
        if (wrong := np.flatnonzero(~(distance > 0.0))).size:
            k = int(wrong[0])
            where = "outside of" if wall.inside else "within"
            raise ParameterError(
                f"the center of particle {k}, {positions[k].tolist()}, is {where} {wall._kind} "
                f"{n}: "
                "`Packing.between` puts particles between walls"
            )


def random_places(
    walls: Sequence[Wall], box: Floats, number: int, rng: np.random.Generator
) -> Floats:
    """Random centers between walls, shape (number, d) [length]."""
    dimension = len(box)
    low, high = bounds(walls, box)
    free_room(walls, box)  # or there is no place
    distances, places = Distances(walls, box), np.empty((0, dimension))
    shut = any(closed(walls, dimension))
    for _ in range(_TRIALS):
        tried = rng.random((number, dimension))
        tried = low + tried * (high - low) if shut else cartesian(tried, box)
        free = (distances(tried)[1] > 0.0).all(axis=0)
        places = np.concatenate([places, tried[free]])[:number]
        if len(places) == number:
            return places
    raise ParameterError(
        f"walls leave too little room for {number} particles: take fewer or smaller obstacles"
    )


# Points of a circle, and of a side, which may end where another wall begins.
_POINTS, _OF_A_SIDE = 120, 1000

# Corners are on a plane up to this part of the size of the room.
_ON = 1e-9


def lines_around(walls: Sequence[Wall], box: Floats, viewer: Floats) -> list[Floats]:
    """Edges of the room and of the periodic box, as lines of shape (n, 3) [length].

    Args:
        walls: in space; balls have no lines.
        box: lattice vectors as rows, shape (3, 3) [length].
        viewer: unit vector to the viewer, who sees outlines of round walls.
    """
    outlines = [_outline(wall, walls, box, viewer) for wall in walls]
    return [*_edges(walls, box), *chain.from_iterable(outlines)]


def _edges(walls: Sequence[Wall], box: Floats) -> list[Floats]:
    """Of the box, or where two flat ends meet."""
    if not any(closed(walls, 3)):
        ends = np.array(np.meshgrid(*[(0.0, 1.0)] * 3)).T.reshape(-1, 3)
        pairs = combinations(ends, 2)
        return [np.stack(both) @ box for both in pairs if np.abs(np.subtract(*both)).sum() == 1.0]
    corners = corners_between(walls, box)
    flat = [wall for wall in walls if isinstance(wall, Plane)]
    normals, offsets = half_spaces_between(flat, box, closed(walls, 3))
    if not len(normals):
        return []
    on = np.abs(corners @ normals.T - offsets) <= _ON * np.ptp(corners, axis=0).max()
    found = []
    for i, j in combinations(range(len(normals)), 2):
        both = corners[on[:, i] & on[:, j]]
        along = both @ np.cross(normals[i], normals[j])
        if len(both) > 1 and np.ptp(along) > _ON * np.abs(along).max():
            found.append(both[[along.argmin(), along.argmax()]])
    return found


def _outline(wall: Wall, walls: Sequence[Wall], box: Floats, viewer: Floats) -> list[Floats]:
    """Of a round wall, as the viewer sees it, as far as it is in the room."""
    if isinstance(wall, Sphere) and wall.inside:
        lines = [wall._middle + wall.radius * _circle(viewer)]
    elif isinstance(wall, SurfaceWall):
        return list(wall._edges)
    elif isinstance(wall, (Cylinder, Cone)):
        lines = _around_axis(wall, walls, box, viewer)
    else:
        return []
    others = [each for each in walls if each is not wall and each.inside]
    return list(chain.from_iterable(_within(others, box, line) for line in lines))


def _around_axis(
    wall: Cylinder | Cone, walls: Sequence[Wall], box: Floats, viewer: Floats
) -> list[Floats]:
    """Rims at the ends of the room, and both sides where the viewer sees it end."""
    axis, middle = np.array(wall._direction), wall._middle
    if not wall.inside:  # the image in the box
        cell = np.where(closed(walls, 3), 0.0, np.floor(fractional(middle, box)))
        middle = middle - cell @ box
    ends = [middle + axis * (end - middle) for end in bounds(walls, box)]
    if isinstance(wall, Cone):
        slope, radii = wall._slope, [wall._radius_at(float(end[2])) for end in ends]
    else:
        slope, radii = 0.0, [wall.radius] * 2
    lines = [end + radius * _circle(axis) for end, radius in zip(ends, radii, strict=True)]
    # The normal of a side, its direction u minus slope times the axis, is across the view.
    beside = viewer - (viewer @ axis) * axis
    steep, size = slope * float(viewer @ axis), float(lengths(beside))
    if size > max(_ON, abs(steep)):
        toward, part = beside / size, steep / size
        for sign in (-1.0, 1.0):
            u = part * toward + sign * np.sqrt(1.0 - part**2) * np.cross(axis, toward)
            low, high = (end + radius * u for end, radius in zip(ends, radii, strict=True))
            lines.append(low + np.linspace(0.0, 1.0, _OF_A_SIDE)[:, None] * (high - low))
    return lines


def _within(walls: Sequence[Wall], box: Floats, line: Floats) -> list[Floats]:
    """The parts of a line in the room between walls."""
    _, distances = Distances(walls, box)(line)
    inside = (distances >= -_ON * np.abs(box).max()).all(axis=0)
    cuts = np.flatnonzero(np.diff(inside)) + 1
    return [part for part in np.split(line, cuts)[int(not inside[0]) :: 2] if len(part) > 1]


def _circle(axis: Floats) -> Floats:
    """A circle around an axis, of radius 1."""
    first = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    first /= lengths(first)
    angle = np.linspace(0.0, 2.0 * np.pi, _POINTS)[:, None]
    return np.cos(angle) * first + np.sin(angle) * np.cross(axis, first)

"""The room that walls leave to particles: where it ends, its area, and distances from the walls.

A direction in which a container ends is *closed*: the box is not periodic along it, and is as long
as the container. Obstacles repeat with the box along the other directions.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from .lattice import cartesian
from .walls import Circle, Disk, Plane, Wall

# Components of a unit normal below this are rounding.
_ROUNDING = 1e-12

# A quarter of the corners of a polygon that stands for a disk.
_QUARTER = 256

# Round walls stay round: factors along x and y agree up to this.
_SAME = 1e-9

# Random places that are tried for each particle.
_TRIALS = 1000

Floats = NDArray[np.float64]


def closed(walls: Sequence[Wall], dimension: int = 2) -> tuple[bool, ...]:
    """Whether walls close each direction; in three dimensions there are none."""
    if not walls:
        return (False,) * dimension
    if any(isinstance(wall, Circle) for wall in walls):
        return True, True
    shares = np.array([[0.0, 0.0], *(np.abs(_normal(w)) for w in walls if isinstance(w, Plane))])
    x, y = (shares.max(axis=0) > _ROUNDING).tolist()
    return x, y


def bounds(walls: Sequence[Wall], box: Floats) -> Floats:
    """Lower left and upper right corner of the room, as rows, shape (2, d) [length].

    In a direction that is not closed, the room goes from 0 to the length of the box.

    Raises:
        ParameterError: the container is open, or leaves no room, or the box is tilted.
    """
    ends = np.array([np.zeros(len(box)), box.diagonal()])
    shut = closed(walls, len(box))
    if not any(shut):
        return ends
    if box[1, 0] != 0.0:
        raise ParameterError(
            f"a box with a container must be rectangular, not tilted by {box[1, 0]:g}"
        )
    corners = _corners(walls, box)
    return np.where(shut, [corners.min(axis=0), corners.max(axis=0)], ends)


def box_between(walls: Sequence[Wall], box: Floats) -> Floats:
    """The box with the length of the container along closed directions, shape (d, d) [length]."""
    if not any(closed(walls)):
        return box
    low, high = bounds(walls, box)
    return np.diag(high - low)


def _corners(walls: Sequence[Wall], box: Floats, around: float = 1.0) -> Floats:
    """Corners of the container within the periodic box, shape (n, 2) [length].

    Args:
        walls: circles count as squares around them.
        box: lattice vectors as rows.
        around: factor by which the squares are larger.
    """
    from .. import core

    rows: list[tuple[Floats, float]] = []
    for plane in (wall for wall in walls if isinstance(wall, Plane)):
        rows.append((-_normal(plane), float(-_normal(plane) @ plane.point)))
    for wall in walls:
        if isinstance(wall, Circle):
            size = around * wall.radius
            rows += [(n, float(n @ wall.center) + size) for n in (*np.eye(2), *-np.eye(2))]
    for n, length, shut in zip(np.eye(2), box.diagonal(), closed(walls), strict=True):
        if not shut:
            rows += [(n, length), (-n, 0.0)]
    normals, offsets = np.array([n for n, _ in rows]), np.array([offset for _, offset in rows])
    angles = np.sort(np.arctan2(normals[:, 1], normals[:, 0]))
    if np.diff(angles, append=angles[0] + 2.0 * np.pi).max() > np.pi - _ROUNDING:
        raise ParameterError(
            "the planes leave the room open: add planes that enclose it (`rectangle` has four)"
        )
    try:
        edges = core.polygon_edges(normals[:, 0], normals[:, 1], offsets)
    except ValueError:
        edges = np.empty((0, 4))
    corners = edges[~np.isnan(edges).any(axis=1)].reshape(-1, 2)
    if len(corners) < 3 or np.ptp(corners, axis=0).min() <= 0.0:
        raise ParameterError(
            "planes and circles leave no room: a plane's normal must point to the particles"
        )
    return corners


def _normal(plane: Plane) -> Floats:
    return np.array(plane.normal) / np.hypot(*plane.normal)


def container(walls: Sequence[Wall], box: Floats) -> Any:
    """A polygon of shapely: the container within the periodic box, or the box.

    Circles are polygons of the same area.

    Raises:
        ParameterError: see `bounds`.
    """
    import shapely

    if not any(closed(walls)):
        return shapely.Polygon([(0.0, 0.0), box[0], box[0] + box[1], box[1]])
    room = shapely.MultiPoint(_corners(walls, box, around=2.0)).convex_hull
    for wall in walls:
        if isinstance(wall, Circle):
            room = room.intersection(_round(wall))
    if room.area == 0.0:
        raise ParameterError("planes and circles leave no room: they do not overlap")
    return room


def obstacles(walls: Sequence[Wall], box: Floats) -> list[Any]:
    """Shapes of shapely: obstacles and their images next to the box; disks as polygons."""
    import shapely
    from shapely.affinity import translate

    steps = [(0,) if shut else (-1, 0, 1) for shut in closed(walls)]
    shifts = [cartesian(np.array([a, b]), box) for a in steps[0] for b in steps[1]]
    solid = [
        _round(wall) if isinstance(wall, Disk) else shapely.MultiPoint(wall.corners).convex_hull
        for wall in walls
        if not isinstance(wall, (Plane, Circle))
    ]
    return [translate(shape, *shift) for shape in solid for shift in shifts]


def _round(wall: Circle | Disk) -> Any:
    """A polygon of the same area."""
    import shapely

    angle = np.pi / (2.0 * _QUARTER)
    larger = wall.radius * np.sqrt(angle / np.sin(angle))
    return shapely.Point(wall.center).buffer(larger, quad_segs=_QUARTER)


def free_room(walls: Sequence[Wall], box: Floats) -> float:
    """Area of the container, or of the box, without obstacles [length^2]; volume of a box in space.

    Exact to rounding; only where a round wall crosses another one, to 1e-5 of the disk.

    Raises:
        ParameterError: see `bounds`, or obstacles fill the room, or are too large to compute with.
    """
    if not walls:
        return float(np.prod(box.diagonal()))
    import shapely

    try:
        with np.errstate(all="ignore"):  # of numbers so large that areas overflow
            free = container(walls, box).difference(shapely.union_all(obstacles(walls, box)))
    except shapely.errors.GEOSException:
        largest = max(abs(value) for wall in walls for value in wall.values)
        raise ParameterError(
            f"walls are too large to compute the area between them: one has the value {largest:g}"
        ) from None
    if not 0.0 < free.area < np.inf:
        raise ParameterError("obstacles fill the room: they leave no area to particles")
    return float(free.area)


class Distances:
    """Distances of particles from walls: the nearest point of each wall.

    Args:
        walls: the shapes.
        box: lattice vectors as rows, shape (2, 2) [length].
    """

    def __init__(self, walls: Sequence[Wall], box: Floats) -> None:
        from .. import core

        lx, ly = np.where(closed(walls), 0.0, box.diagonal()).tolist()
        self._scene, self._count = core.Scene(lx, ly, float(box[1, 0])), len(walls)
        for wall in walls:
            if isinstance(wall, Plane):
                self._scene.add_plane(*wall.values)
            elif isinstance(wall, (Circle, Disk)):
                self._scene.add_round(*wall.center, wall.radius, isinstance(wall, Circle))
            else:
                self._scene.add_polygon(*np.transpose(wall.corners))

    def __call__(self, positions: Floats) -> tuple[Floats, Floats]:
        """Directions to the walls and distances of these N positions.

        Returns:
            Unit vectors, shape (number of walls, N, 2), and distances, shape (number of walls, N)
            [length]; negative beyond a plane or circle and inside of an obstacle.
        """
        found = self._nearest(positions)
        return found[..., :2], found[..., 2]

    def turns(self, positions: Floats) -> Floats:
        """Angle by which each direction turns for a sideways step, (number of walls, N) [1/length].

        It is 0 on a side, 1/h at a corner, 1/(rho + h) outside of a disk of radius rho, and
        -1/(rho - h) inside of a circle.
        """
        return self._nearest(positions)[..., 3]

    def _nearest(self, positions: Floats) -> Floats:
        return self._scene.nearest(*positions.T).reshape(self._count, len(positions), 4)


def check_fit(walls: Sequence[Wall], box: Floats, cutoff: float) -> None:
    """Refuse obstacles that LAMMPS would not repeat with the periodic box.

    Args:
        walls: the shapes.
        box: lattice vectors as rows, shape (2, 2) [length].
        cutoff: distance from the center of a particle at which walls begin to count [length].
    """
    for n, wall in enumerate(walls, start=1):
        if isinstance(wall, (Plane, Circle)):
            continue
        for axis, length, shut in zip("xy", box.diagonal(), closed(walls), strict=True):
            if not shut and wall.extent + cutoff > 0.5 * length:
                raise ParameterError(
                    f"{wall.kind} {n} does not fit into the periodic box: a circle around it and "
                    f"the reach of particles, {wall.extent:.4g} + {cutoff:.4g}, exceed half of the "
                    f"box along {axis}, {0.5 * length:.4g}; take a larger box, smaller obstacles, "
                    "or a container"
                )


def check_centers(walls: Sequence[Wall], box: Floats, positions: Floats) -> None:
    """Refuse particles whose center is on the wrong side of a wall."""
    _, distances = Distances(walls, box)(positions)
    for n, (wall, distance) in enumerate(zip(walls, distances, strict=True), start=1):
        if (wrong := np.flatnonzero(~(distance > 0.0))).size:
            k = int(wrong[0])
            where = "outside of" if isinstance(wall, (Plane, Circle)) else "within"
            raise ParameterError(
                f"the center of particle {k}, {positions[k].tolist()}, is {where} {wall.kind} {n}: "
                "`Packing.between` puts particles between walls"
            )


def random_places(
    walls: Sequence[Wall], box: Floats, number: int, rng: np.random.Generator
) -> Floats:
    """Random centers between walls, shape (number, 2) [length]."""
    low, high = bounds(walls, box)
    free_room(walls, box)  # or there is no place
    distances, places = Distances(walls, box), np.empty((0, 2))
    for _ in range(_TRIALS):
        tried = rng.random((number, 2))
        tried = low + tried * (high - low) if any(closed(walls)) else cartesian(tried, box)
        free = (distances(tried)[1] > 0.0).all(axis=0)
        places = np.concatenate([places, tried[free]])[:number]
        if len(places) == number:
            return places
    raise ParameterError(
        f"walls leave too little room for {number} particles: take fewer or smaller obstacles"
    )


def stretched(walls: Sequence[Wall], box: Floats, new: Floats) -> tuple[Wall, ...]:
    """Walls after a stretch of the box along x and y, about the origin.

    Raises:
        ParameterError: the box is sheared, or a round wall stretched in one direction.
    """
    if not walls:
        return ()
    x, y = (new.diagonal() / box.diagonal()).tolist()
    if abs(new[1, 0] - box[1, 0] * x) > _SAME * new[0, 0]:
        raise ParameterError(
            f"a box with walls cannot be sheared: its tilt must be {box[1, 0] * x:g}, not "
            f"{new[1, 0]:g}"
        )
    for n, wall in enumerate(walls, start=1):
        if isinstance(wall, (Circle, Disk)) and abs(x - y) > _SAME * x:
            raise ParameterError(
                f"{wall.kind} {n} must stay round: the box may be stretched by one factor only, "
                f"not by {x:g} along x and {y:g} along y"
            )
    return tuple(wall.stretched(x, y) for wall in walls)


def free_motions(walls: Sequence[Wall], dimension: int = 2) -> int:
    """Number of motions of all particles together that no wall resists."""
    if not walls:
        return dimension
    if all(isinstance(wall, Plane) for wall in walls):
        return 2 - sum(closed(walls))
    return int(_pivot(walls) is not None)


def _pivot(walls: Sequence[Wall]) -> tuple[float, float] | None:
    """The common center of a round container and round obstacles, about which all may turn."""
    centers = {wall.center for wall in walls if isinstance(wall, (Circle, Disk))}
    is_round = all(isinstance(wall, (Circle, Disk)) for wall in walls)
    return centers.pop() if is_round and len(centers) == 1 and all(closed(walls)) else None


def motions(walls: Sequence[Wall], positions: Floats) -> Floats:
    """These motions, of particles at N positions, shape (`free_motions`, N, d)."""
    if (pivot := _pivot(walls)) is not None:
        x, y = (positions - pivot).T
        return np.stack([-y, x], axis=1)[None]
    dimension = positions.shape[1]
    free = free_motions(walls, dimension) > 0
    along = np.eye(dimension)[free & ~np.array(closed(walls, dimension))]
    return np.repeat(along[:, None], len(positions), axis=1)

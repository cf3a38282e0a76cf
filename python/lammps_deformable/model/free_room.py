"""The area or volume that walls leave free, and its shape in the plane."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from .lattice import cartesian, fractional
from .room import closed, corners_between
from .sections import volume_of
from .walls import Circle, Disk, Polygon, Segment, Wall

# A quarter of the corners of a polygon that stands for a disk.
_QUARTER = 256

Floats = NDArray[np.float64]


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
        if isinstance(wall, Circle):
            room = room.intersection(_round(wall))
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
        if not isinstance(wall, (Disk, Segment, Polygon)):
            continue
        own = _round(wall) if isinstance(wall, Disk) else _hull(wall.corners)
        cell = np.where(closed(walls), 0.0, np.floor(fractional(wall.middle, box)))
        solid.append(translate(own, *-cartesian(cell, box)) if cell.any() else own)
    return [translate(shape, *shift) for shape in solid for shift in shifts]


def _hull(points: Any) -> Any:
    import shapely

    return shapely.MultiPoint(points).convex_hull


def _round(wall: Circle | Disk) -> Any:
    """A polygon of the same area."""
    import shapely

    angle = np.pi / (2.0 * _QUARTER)
    larger = wall.radius * np.sqrt(angle / np.sin(angle))
    return shapely.Point(wall.center).buffer(larger, quad_segs=_QUARTER)


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
        largest = max(abs(value) for wall in walls for value in wall.values)
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

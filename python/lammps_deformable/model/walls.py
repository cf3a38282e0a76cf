"""Walls: containers (planes, and round ones) and obstacles, in the plane and in space."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Union

from ..common.errors import ParameterError
from ..common.validate import shown
from .plane_walls import Circle, Disk, Polygon, Segment
from .space_walls import Ball, Cone, Cylinder, Post, Sphere
from .wall_base import Plane

Wall = Union[  # noqa: UP007  of Python 3.10 at run time
    Plane, Circle, Disk, Segment, Polygon, Sphere, Cylinder, Cone, Ball, Post
]
_IN_THE_PLANE: tuple[type[Wall], ...] = (Plane, Circle, Disk, Segment, Polygon)
_IN_SPACE: tuple[type[Wall], ...] = (Plane, Sphere, Cylinder, Cone, Ball, Post)
KINDS: dict[str, type[Wall]] = {each.kind: each for each in _IN_THE_PLANE + _IN_SPACE}


def as_walls(given: Wall | Iterable[Wall], dimension: int | None = None) -> tuple[Wall, ...]:
    """Walls from one shape or several.

    Args:
        given: the shapes.
        dimension: 2 or 3, if it is known.

    Raises:
        ParameterError: one of them is no shape, or one of another dimension.
    """
    kinds = tuple(KINDS.values())
    known = {2: _IN_THE_PLANE, 3: _IN_SPACE}.get(dimension or 0, kinds)
    names = ", ".join(kind.__name__ for kind in known)
    try:
        walls = (given,) if isinstance(given, kinds) else tuple(given)  # type: ignore[arg-type]
    except TypeError:
        raise ParameterError(
            f"walls must be one or several of {names}, not {shown(given)}"
            + (": take its `planes`" if hasattr(given, "planes") else "")
        ) from None
    for n, wall in enumerate(walls, start=1):
        if not isinstance(wall, kinds):
            raise ParameterError(
                f"wall {n} must be one of {names}, not {shown(wall)}"
                + ("; put * before a rectangle" if isinstance(wall, (tuple, list)) else "")
            )
        if dimension and wall.dimension != dimension:
            if isinstance(wall, Plane):
                way_out = f"give its point and normal as ({', '.join('xyz'[:dimension])})"
            else:
                way_out = f"take one of {names}"
            raise ParameterError(
                f"{wall.kind} {n} is a wall in {wall.dimension} dimensions, and the particles have "
                f"{dimension}: {way_out}"
            )
    return walls

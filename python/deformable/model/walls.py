"""Walls: containers (plane, circle) and obstacles (disk, segment, polygon).

Containers and obstacles have the names and the numbers of `fix deformable/wall`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeVar, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError
from ..common.validate import numbers, positive, shown
from .adhesion import wall_adhesion

Point = tuple[float, float]
R = TypeVar("R", bound="_Round")


@dataclass(frozen=True)
class Plane:
    """A straight wall without ends; particles are on one side of it.

    Attributes:
        point: any point of the wall (x, y) [length].
        normal: direction from the wall to the particles (x, y), of any length.
        adhesion: energy that a particle gains for each unit of length of its film with the wall
            [energy/length], see `Ring`.

    Raises:
        ParameterError: a value is not finite, or the normal is (0, 0).
    """

    kind: ClassVar[str] = "plane"

    point: Point
    normal: Point
    adhesion: float = 0.0

    def __post_init__(self) -> None:
        _set_adhesion(self)
        _set_points(self, "point", "normal")
        if self.normal == (0.0, 0.0):
            raise ParameterError("normal of a plane must have a direction, not (0, 0)")

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers of LAMMPS' word."""
        return (*self.point, *self.normal)

    def stretched(self, x: float, y: float) -> Plane:
        """The plane after the coordinates are multiplied by x and y."""
        normal = self.normal[0] * y, self.normal[1] * x
        return replace(self, point=_scaled(self.point, x, y), normal=normal)


@dataclass(frozen=True)
class _Round:
    kind: ClassVar[str]

    center: Point
    radius: float
    adhesion: float = 0.0

    def __post_init__(self) -> None:
        _set_adhesion(self)
        _set_points(self, "center")
        object.__setattr__(self, "radius", positive(f"radius of a {self.kind}", self.radius))

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers of LAMMPS' word."""
        return (*self.center, self.radius)

    @property
    def middle(self) -> NDArray[np.float64]:
        """Its center, shape (2,) [length]."""
        return np.array(self.center)

    @property
    def extent(self) -> float:
        """Its radius [length]."""
        return self.radius

    def stretched(self: R, x: float, y: float) -> R:
        """The wall after the coordinates are multiplied by x = y."""
        return replace(self, center=_scaled(self.center, x, x), radius=self.radius * x)


@dataclass(frozen=True)
class Circle(_Round):
    """A round container: particles are inside.

    Attributes:
        center: (x, y) [length].
        radius: [length].
        adhesion: energy that a particle gains for each unit of length of its film with the wall
            [energy/length], see `Ring`.

    Raises:
        ParameterError: a value is not finite, or the radius is not positive.
    """

    kind = "circle"


@dataclass(frozen=True)
class Disk(_Round):
    """A round obstacle: particles are outside.

    Attributes:
        center: (x, y) [length].
        radius: [length].
        adhesion: energy that a particle gains for each unit of length of its film with the wall
            [energy/length], see `Ring`.

    Raises:
        ParameterError: a value is not finite, or the radius is not positive.
    """

    kind = "disk"


class _Cornered:
    """An obstacle that is given by its corners."""

    kind: ClassVar[str]
    corners: tuple[Point, ...]

    @property
    def middle(self) -> NDArray[np.float64]:
        """Mean of the corners, shape (2,) [length]."""
        middle: NDArray[np.float64] = np.mean(self.corners, axis=0)
        return middle

    @property
    def extent(self) -> float:
        """Radius of a circle around it, about the middle [length]."""
        return float(np.linalg.norm(self.corners - self.middle, axis=1).max())

    def _check(self) -> None:
        """Refuse corners that do not make a convex shape."""
        from .. import core

        try:
            core.polygon_planes(*np.transpose(self.corners))
        except ValueError as error:
            raise ParameterError(f"a {self.kind} {error}, not {shown(self.corners)}") from None


@dataclass(frozen=True)
class Segment(_Cornered):
    """A straight obstacle with two ends, which particles touch from both sides.

    Attributes:
        start: one end (x, y) [length].
        end: the other one.
        adhesion: energy that a particle gains for each unit of length of its film with the wall
            [energy/length], see `Ring`.

    Raises:
        ParameterError: a value is not finite, or both ends are the same point.
    """

    kind = "segment"

    start: Point
    end: Point
    adhesion: float = 0.0

    def __post_init__(self) -> None:
        _set_adhesion(self)
        _set_points(self, "start", "end")
        self._check()

    @property
    def corners(self) -> tuple[Point, ...]:  # type: ignore[override]
        """Both ends."""
        return self.start, self.end

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers of LAMMPS' word."""
        return (*self.start, *self.end)

    def stretched(self, x: float, y: float) -> Segment:
        """The segment after the coordinates are multiplied by x and y."""
        return replace(self, start=_scaled(self.start, x, y), end=_scaled(self.end, x, y))


@dataclass(frozen=True)
class Polygon(_Cornered):
    """A convex obstacle.

    Attributes:
        corners: in the order around it, in either direction, shape (n, 2), n >= 3 [length].
        adhesion: energy that a particle gains for each unit of length of its film with the wall
            [energy/length], see `Ring`.

    Raises:
        ParameterError: a value is not finite, there are too few corners, or it is not convex.
    """

    kind = "polygon"

    corners: tuple[Point, ...]
    adhesion: float = 0.0

    def __post_init__(self) -> None:
        _set_adhesion(self)
        given = numbers("corners of a polygon", self.corners)
        if given.ndim != 2 or given.shape[1] != 2 or len(given) < 3:
            raise ParameterError(
                "corners of a polygon must be three or more points (x, y), not "
                f"{shown(self.corners)}"
            )
        object.__setattr__(self, "corners", tuple((x, y) for x, y in given.tolist()))
        self._check()

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers of LAMMPS' word, after the number of corners."""
        return tuple(value for corner in self.corners for value in corner)

    def stretched(self, x: float, y: float) -> Polygon:
        """The polygon after the coordinates are multiplied by x and y."""
        return replace(self, corners=tuple(_scaled(corner, x, y) for corner in self.corners))


Wall = Union[Plane, Circle, Disk, Segment, Polygon]  # noqa: UP007  of Python 3.10 at run time
KINDS: dict[str, type[Wall]] = {each.kind: each for each in (Plane, Circle, Disk, Segment, Polygon)}


def rectangle(
    width: float, height: float, corner: ArrayLike = (0.0, 0.0), adhesion: float = 0.0
) -> tuple[Plane, Plane, Plane, Plane]:
    """Four planes around particles: left, right, lower and upper side of a rectangular container.

        Simulation(packing, law, walls=[*rectangle(20, 10), Disk((5, 5), 1)])

    Args:
        width: along x [length].
        height: along y [length].
        corner: the lower left one (x, y) [length].
        adhesion: of all four [energy/length].

    Raises:
        ParameterError: a length is not positive, the corner is no point, or the adhesion negative.
    """
    width, height = positive("width", width), positive("height", height)
    x, y = _point("corner", corner)
    return (
        Plane((x, y), (1.0, 0.0), adhesion),
        Plane((x + width, y), (-1.0, 0.0), adhesion),
        Plane((x, y), (0.0, 1.0), adhesion),
        Plane((x, y + height), (0.0, -1.0), adhesion),
    )


def as_walls(given: Wall | Iterable[Wall]) -> tuple[Wall, ...]:
    """Walls from one shape or several.

    Raises:
        ParameterError: one of them is no shape.
    """
    kinds = tuple(KINDS.values())
    if isinstance(given, kinds):
        return (given,)
    names = ", ".join(kind.__name__ for kind in kinds)
    try:
        walls = tuple(given)  # type: ignore[arg-type]
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
    return walls


def _point(name: str, given: ArrayLike) -> Point:
    point = numbers(name, given)
    if point.shape != (2,):
        raise ParameterError(f"{name} must be a point (x, y), not {shown(given)}")
    x, y = point.tolist()
    return x, y


def _set_points(shape: Wall | _Round, *names: str) -> None:
    for name in names:
        point = _point(f"{name} of a {shape.kind}", getattr(shape, name))
        object.__setattr__(shape, name, point)


def _set_adhesion(shape: Any) -> None:
    object.__setattr__(shape, "adhesion", wall_adhesion(shape.kind, shape.adhesion))


def _scaled(point: Point, x: float, y: float) -> Point:
    return point[0] * x, point[1] * y

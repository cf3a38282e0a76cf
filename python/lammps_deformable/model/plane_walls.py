"""Walls in the plane beside `Plane`: a container (circle), obstacles (disk, segment, polygon).

Containers and obstacles have the names and the numbers of `fix deformable/wall`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError
from ..common.validate import numbers, positive, shown
from .wall_base import (
    Plane,
    Point,
    Round,
    Shape,
    point_of,
    scaled,
    set_adhesion,
    set_points,
    sides_of,
)


@dataclass(frozen=True)
class _Round(Round):
    adhesion: float = 0.0

    def __post_init__(self) -> None:
        set_adhesion(self)
        self._check(2)


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

    kind: ClassVar[str] = "circle"


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

    kind: ClassVar[str] = "disk"
    is_obstacle: ClassVar[bool] = True


class _Cornered(Shape):
    """An obstacle that is given by its corners."""

    is_obstacle: ClassVar[bool] = True
    corners: tuple[Point, ...]

    @property
    def dimension(self) -> int:
        """2."""
        return 2

    def add_to(self, scene: Any) -> None:
        """Add it to a scene of `ld.core`."""
        scene.add_polygon(*np.transpose(self.corners))

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

    kind: ClassVar[str] = "segment"

    start: Point
    end: Point
    adhesion: float = 0.0

    def __post_init__(self) -> None:
        set_adhesion(self)
        set_points(self, 2, "start", "end")
        self._check()

    @property
    def corners(self) -> tuple[Point, ...]:  # type: ignore[override]
        """Both ends."""
        return self.start, self.end

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers of LAMMPS' word."""
        return (*self.start, *self.end)

    def stretched(self, *factors: float) -> Segment:
        """The segment after the coordinates are multiplied by one factor each."""
        return replace(self, start=scaled(self.start, factors), end=scaled(self.end, factors))


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

    kind: ClassVar[str] = "polygon"

    corners: tuple[Point, ...]
    adhesion: float = 0.0

    def __post_init__(self) -> None:
        set_adhesion(self)
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

    def stretched(self, *factors: float) -> Polygon:
        """The polygon after the coordinates are multiplied by one factor each."""
        return replace(self, corners=tuple(scaled(corner, factors) for corner in self.corners))


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
    lengths = positive("width", width), positive("height", height)
    left, right, low, high = sides_of(point_of("corner", corner, 2), lengths, adhesion)
    return left, right, low, high

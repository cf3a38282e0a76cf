"""Walls in space beside `Plane`: round containers (sphere, cylinder, cone), obstacles (ball, post).

Containers and obstacles have the names of `fix deformable/wall`. Droplets do not stick to them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ..common.errors import ParameterError
from ..common.validate import finite, positive, shown
from .wall_base import HalfSpace, Plane, Point, Round, point_of, scaled, sides_of

S = TypeVar("S", bound="_Straight")


@dataclass(frozen=True)
class Sphere(Round):
    """A round container in space: particles are inside.

    Attributes:
        center: (x, y, z) [length].
        radius: [length].

    Raises:
        ParameterError: a value is not finite, or the radius is not positive.
    """

    kind: ClassVar[str] = "sphere"
    adhesion: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        self._check(3)


@dataclass(frozen=True)
class Ball(Round):
    """A round obstacle in space: particles are outside.

    Attributes:
        center: (x, y, z) [length].
        radius: [length].

    Raises:
        ParameterError: a value is not finite, or the radius is not positive.
    """

    kind: ClassVar[str] = "ball"
    is_obstacle: ClassVar[bool] = True
    adhesion: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        self._check(3)


@dataclass(frozen=True)
class _Straight(Round):
    """A round wall without ends along one of the axes of the box."""

    adhesion: ClassVar[float] = 0.0

    axis: str = "z"

    def __post_init__(self) -> None:
        self._check(3)
        if not isinstance(self.axis, str) or self.axis not in ("x", "y", "z"):
            raise ParameterError(f"axis of a {self.kind} must be x, y or z, not {shown(self.axis)}")

    @property
    def direction(self) -> Point:
        """Of the axis, a unit vector."""
        return tuple(float(axis == self.axis) for axis in "xyz")

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers of LAMMPS' word."""
        return (*self.center, *self.direction, self.radius)

    def half_spaces(self, around: float = 1.0) -> list[HalfSpace]:
        """Four planes around a container."""
        along = "xyz".index(self.axis)
        return [(n, offset) for n, offset in super().half_spaces(around) if not n[along]]

    def add_to(self, scene: Any) -> None:
        """Add it to a scene of `ld.core`."""
        scene.add_cone(*self.values, 0.0, not self.is_obstacle)

    @property
    def round_axes(self) -> tuple[int, ...]:
        """The axes across its own."""
        return tuple(k for k, axis in enumerate("xyz") if axis != self.axis)

    def stretched(self: S, *factors: float) -> S:
        """The wall after the coordinates are multiplied by these factors, equal across it."""
        radius = self.radius * factors[self.round_axes[0]]
        return replace(self, center=scaled(self.center, factors), radius=radius)


@dataclass(frozen=True)
class Cylinder(_Straight):
    """A tube without ends: particles are inside. Planes may close it, or it goes on with the box.

    Attributes:
        center: any point of its axis (x, y, z) [length].
        radius: [length].
        axis: `x`, `y` or `z`, along which it goes.

    Raises:
        ParameterError: a value is not finite, the radius is not positive, or the axis another one.
    """

    kind: ClassVar[str] = "cylinder"


@dataclass(frozen=True)
class Post(_Straight):
    """A round obstacle without ends: particles are outside.

    Attributes:
        center: any point of its axis (x, y, z) [length].
        radius: [length].
        axis: `x`, `y` or `z`, along which it goes.

    Raises:
        ParameterError: a value is not finite, the radius is not positive, or the axis another one.
    """

    kind: ClassVar[str] = "post"
    is_obstacle: ClassVar[bool] = True


@dataclass(frozen=True)
class Cone(Round):
    """A funnel that stands along z, without ends: particles are inside. Planes close it.

    Attributes:
        center: a point of its axis (x, y, z) [length].
        radius: there [length].
        slope: by which the radius grows upward, for each unit of z; negative: downward.

    Raises:
        ParameterError: a value is not finite, the radius is not positive, or the slope is 0.
    """

    kind: ClassVar[str] = "cone"
    adhesion: ClassVar[float] = 0.0

    slope: float

    def __post_init__(self) -> None:
        self._check(3)
        object.__setattr__(self, "slope", finite("slope of a cone", self.slope))
        if self.slope == 0.0:
            raise ParameterError("slope of a cone must not be 0: take a Cylinder")

    @property
    def direction(self) -> Point:
        """Of the axis, a unit vector."""
        return (0.0, 0.0, 1.0)

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers of LAMMPS' word."""
        return (*self.center, *self.direction, self.radius, self.slope)

    def radius_at(self, z: float) -> float:
        """Its radius at a height, 0 beyond its tip [length]."""
        return max(self.radius + self.slope * (z - self.center[2]), 0.0)

    def half_spaces(self, around: float = 1.0) -> list[HalfSpace]:
        """Four planes around it, which lean."""
        slant = float(np.hypot(1.0, self.slope))
        rows = [
            np.array([x, y, -self.slope]) / slant for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))
        ]
        return [(n, float(n @ self.center) + around * self.radius / slant) for n in rows]

    def add_to(self, scene: Any) -> None:
        """Add it to a scene of `ld.core`."""
        scene.add_cone(*self.values, True)

    @property
    def round_axes(self) -> tuple[int, ...]:
        """The axes across its own."""
        return (0, 1)

    def stretched(self, *factors: float) -> Cone:
        """The cone after the coordinates are multiplied by these factors, equal across it."""
        across, _, along = factors
        center, slope = scaled(self.center, factors), self.slope * across / along
        return replace(self, center=center, radius=self.radius * across, slope=slope)


def cuboid(
    width: float, depth: float, height: float, corner: ArrayLike = (0.0, 0.0, 0.0)
) -> tuple[Plane, Plane, Plane, Plane, Plane, Plane]:
    """Six planes around particles: both sides along x, then along y, then floor and top.

        bidisperse(200, dimension=3).between([*cuboid(10, 10, 10), Ball((5, 5, 5), 2)])

    Args:
        width: along x [length].
        depth: along y [length].
        height: along z [length].
        corner: the lowest one (x, y, z) [length].

    Raises:
        ParameterError: a length is not positive, or the corner is no point.
    """
    sides = positive("width", width), positive("depth", depth), positive("height", height)
    left, right, front, back, floor, top = sides_of(point_of("corner", corner, 3), sides)
    return left, right, front, back, floor, top

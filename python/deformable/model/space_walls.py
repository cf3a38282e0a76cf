"""Walls in space beside `Plane`: round containers (sphere, cylinder) and an obstacle (ball).

Containers and obstacles have the names of `fix deformable/wall`. Droplets do not stick to them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

from numpy.typing import ArrayLike

from ..common.errors import ParameterError
from ..common.validate import positive, shown
from .wall_base import HalfSpace, Plane, Point, Round, point_of, scaled, sides_of


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
class Cylinder(Round):
    """A tube without ends: particles are inside. Planes may close it, or it goes on with the box.

    Attributes:
        center: any point of its axis (x, y, z) [length].
        radius: [length].
        axis: `x`, `y` or `z`, along which it goes.

    Raises:
        ParameterError: a value is not finite, the radius is not positive, or the axis another one.
    """

    kind: ClassVar[str] = "cylinder"
    adhesion: ClassVar[float] = 0.0

    axis: str = "z"

    def __post_init__(self) -> None:
        self._check(3)
        if not isinstance(self.axis, str) or self.axis not in ("x", "y", "z"):
            raise ParameterError(f"axis of a cylinder must be x, y or z, not {shown(self.axis)}")

    @property
    def direction(self) -> Point:
        """Of the axis, a unit vector."""
        return tuple(float(axis == self.axis) for axis in "xyz")

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers of LAMMPS' word."""
        return (*self.center, *self.direction, self.radius)

    def half_spaces(self, around: float = 1.0) -> list[HalfSpace]:
        """Four planes around it."""
        along = "xyz".index(self.axis)
        return [(n, offset) for n, offset in super().half_spaces(around) if not n[along]]

    def add_to(self, scene: Any) -> None:
        """Add it to a scene of `deformable.core`."""
        scene.add_cylinder(*self.values)

    @property
    def round_axes(self) -> tuple[int, ...]:
        """The axes across its own."""
        return tuple(k for k, axis in enumerate("xyz") if axis != self.axis)

    def stretched(self, *factors: float) -> Cylinder:
        """The cylinder after the coordinates are multiplied by these factors, equal across it."""
        radius = self.radius * factors[self.round_axes[0]]
        return replace(self, center=scaled(self.center, factors), radius=radius)


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

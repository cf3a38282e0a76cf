"""What walls in the plane and in space have in common; planes, which are in both."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError
from ..common.validate import numbers, positive, shown
from .adhesion import wall_adhesion
from .lattice import lengths

Floats = NDArray[np.float64]
Point = tuple[float, ...]

# The points n x <= offset, by n and the offset.
HalfSpace = tuple[Floats, float]

R = TypeVar("R", bound="Round")


class Shape(ABC):
    """A wall. What it adds to a LAMMPS command are its `kind` and its `values`."""

    kind: ClassVar[str]
    is_obstacle: ClassVar[bool] = False

    @property
    @abstractmethod
    def dimension(self) -> int:
        """2, or 3 in space."""

    def half_spaces(self, around: float = 1.0) -> list[HalfSpace]:
        """Those that have a container in common; of a round one a square or cube around it.

        Args:
            around: factor by which that is larger.
        """
        return []

    @property
    def round_axes(self) -> tuple[int, ...]:
        """The axes along which a round wall is stretched by one factor."""
        return ()


@dataclass(frozen=True)
class Plane(Shape):
    """A flat wall without ends, in the plane a straight one; particles are on one side of it.

    Attributes:
        point: any point of the wall (x, y), in space (x, y, z) [length].
        normal: direction from the wall to the particles (x, y) or (x, y, z), of any length.
        adhesion: energy that a particle gains for each unit of length of its film with the wall
            [energy/length], see `Ring`.

    Raises:
        ParameterError: a value is not finite, or the normal is 0, or there is an adhesion in space.
    """

    kind: ClassVar[str] = "plane"

    point: Point
    normal: Point
    adhesion: float = 0.0

    def __post_init__(self) -> None:
        set_adhesion(self)
        given = [numbers(f"{name} of a plane", getattr(self, name)) for name in _OF_A_PLANE]
        if [each.shape for each in given] not in ([(2,)] * 2, [(3,)] * 2):
            wrong = 0 if given[0].shape not in ((2,), (3,)) or given[1].shape == (2,) else 1
            raise ParameterError(
                f"{_OF_A_PLANE[wrong]} of a plane must be a point (x, y), in space (x, y, z) and "
                f"the {_OF_A_PLANE[1 - wrong]} too, not {shown(getattr(self, _OF_A_PLANE[wrong]))}"
            )
        for name, each in zip(_OF_A_PLANE, given, strict=True):
            object.__setattr__(self, name, tuple(each.tolist()))
        if not any(self.normal):
            raise ParameterError(f"normal of a plane must have a direction, not {self.normal}")
        if self.dimension == 3 and self.adhesion:
            raise ParameterError(
                "adhesion of a plane is for the plane: droplets in space do not stick, leave it out"
            )

    @property
    def dimension(self) -> int:
        """2, or 3 in space."""
        return len(self.point)

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers of LAMMPS' word."""
        return (*self.point, *self.normal)

    def half_spaces(self, around: float = 1.0) -> list[HalfSpace]:
        """The points on the side of the particles."""
        out = -np.array(self.normal) / lengths(np.array(self.normal))
        return [(out, float(out @ self.point))]

    def add_to(self, scene: Any) -> None:
        """Add it to a scene of `ld.core`."""
        scene.add_plane(*self.values)

    def stretched(self, *factors: float) -> Plane:
        """The plane after the coordinates are multiplied by one factor each."""
        others = (_product(factors[:k] + factors[k + 1 :]) for k in range(len(factors)))
        return replace(
            self, point=scaled(self.point, factors), normal=scaled(self.normal, tuple(others))
        )


_OF_A_PLANE = ("point", "normal")


@dataclass(frozen=True)
class Round(Shape):
    """A wall around a center."""

    center: Point
    radius: float

    def _check(self, dimension: int) -> None:
        set_points(self, dimension, "center")
        object.__setattr__(self, "radius", positive(f"radius of a {self.kind}", self.radius))

    @property
    def dimension(self) -> int:
        """2, or 3 in space."""
        return len(self.center)

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers of LAMMPS' word."""
        return (*self.center, self.radius)

    @property
    def middle(self) -> Floats:
        """Its center, shape (d,) [length]."""
        return np.array(self.center)

    @property
    def extent(self) -> float:
        """Its radius [length]."""
        return self.radius

    def half_spaces(self, around: float = 1.0) -> list[HalfSpace]:
        """A square, or cube, around a container."""
        if self.is_obstacle:
            return []
        units, size = np.eye(self.dimension), around * self.radius
        return [(n, float(n @ self.center) + size) for n in (*units, *-units)]

    def add_to(self, scene: Any) -> None:
        """Add it to a scene of `ld.core`."""
        scene.add_round(*self.values, not self.is_obstacle)

    @property
    def round_axes(self) -> tuple[int, ...]:
        """All axes."""
        return tuple(range(self.dimension))

    def stretched(self: R, *factors: float) -> R:
        """The wall after all coordinates are multiplied by these equal factors."""
        return replace(self, center=scaled(self.center, factors), radius=self.radius * factors[0])


def sides_of(corner: Point, lengths: Point, adhesion: float = 0.0) -> tuple[Plane, ...]:
    """Planes around a rectangle or cuboid: both sides along x, then along y, and z."""
    found = []
    for axis, length in enumerate(lengths):
        for sign, shift in ((1.0, 0.0), (-1.0, length)):
            point = tuple(x + shift * (k == axis) for k, x in enumerate(corner))
            normal = tuple(sign * (k == axis) for k in range(len(corner)))
            found.append(Plane(point, normal, adhesion))
    return tuple(found)


def point_of(name: str, given: ArrayLike, dimension: int) -> Point:
    """A point as a tuple."""
    point = numbers(name, given)
    if point.shape != (dimension,):
        axes = ", ".join("xyz"[:dimension])
        raise ParameterError(f"{name} must be a point ({axes}), not {shown(given)}")
    return tuple(point.tolist())


def set_points(shape: Shape, dimension: int, *names: str) -> None:
    """Check attributes of a shape that are points."""
    for name in names:
        point = point_of(f"{name} of a {shape.kind}", getattr(shape, name), dimension)
        object.__setattr__(shape, name, point)


def set_adhesion(shape: Any) -> None:
    """Check the adhesion of a shape."""
    object.__setattr__(shape, "adhesion", wall_adhesion(shape.kind, shape.adhesion))


def scaled(point: Point, factors: Point) -> Point:
    """A point with its coordinates multiplied by one factor each."""
    return tuple(x * factor for x, factor in zip(point, factors, strict=True))


def _product(factors: Point) -> float:
    product = 1.0
    for factor in factors:
        product *= factor
    return product

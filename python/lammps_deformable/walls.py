"""What walls in the plane and in space have in common; planes, which are in both.

Walls in the plane beside `Plane`: a container (circle), obstacles (disk, segment, polygon).

Containers and obstacles have the names and the numbers of `fix deformable/wall`.

Walls in space beside `Plane`: round containers (sphere, cylinder, cone), obstacles (ball, post).

Containers and obstacles have the names of `fix deformable/wall`. Droplets do not stick to them.

Walls: containers (planes, and round ones) and obstacles, in the plane and in space.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._checks import finite, numbers, positive, shown
from .box import lengths
from .errors import ParameterError
from .laws import wall_adhesion

if TYPE_CHECKING:
    from collections.abc import Iterable


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
        from . import core

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

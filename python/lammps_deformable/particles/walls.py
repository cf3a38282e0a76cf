"""Walls of a packing, in the plane and in space: containers (`inside`) and obstacles.

A container keeps particles on its inner side, an obstacle keeps them out. `as_walls` makes the
walls of a packing of what a user gives, `room.py` has the room that they leave, `commands.py`
writes them for *fix deformable/wall*, whose words are `kind` and `values`.
"""

from __future__ import annotations

import math
import os
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import KW_ONLY, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import core
from ..common.box import lengths
from ..common.checks import as_call, expect, number_or_nan, numbers, positive, shown
from ..common.errors import FileError, ParameterError
from ..common.files import reading
from .laws import wall_adhesion

Floats = NDArray[np.float64]
Point = tuple[float, ...]

# The points n x <= offset, by n and the offset.
HalfSpace = tuple[Floats, float]

# Parts of a direction: rounding.
_ROUNDING = 1e-12


@dataclass(frozen=True, repr=False)
class Wall(ABC):
    """A wall.

    Attributes:
        adhesion: energy that a particle gains for each unit of length of its film with the wall
            [energy/length], see `Ring`; in space for each unit of area [energy/length^2], see
            `Droplet`.
    """

    inside: ClassVar[bool]  # whether it is a container

    adhesion: float = field(default=0.0, kw_only=True)

    def __post_init__(self) -> None:
        """Check the attributes."""
        name = type(self).__name__
        object.__setattr__(self, "adhesion", wall_adhesion(name, self.adhesion))
        expect(f"inside of a {name}", self.inside, bool)

    def __repr__(self) -> str:
        return as_call(self)

    @property
    def parts(self) -> tuple[Wall, ...]:
        """The walls that stand for it in a packing: itself, or its sides."""
        return (self,)

    def _placed(self, dimension: int) -> Wall:
        """The wall in a packing of this dimension, which a sphere around 0 does not know."""
        return self

    @property
    @abstractmethod
    def dimension(self) -> int:
        """2, 3 in space, 0 if it is not known yet."""

    @property
    @abstractmethod
    def _kind(self) -> str:
        """LAMMPS' word."""

    @property
    @abstractmethod
    def _values(self) -> tuple[float, ...]:
        """The numbers after LAMMPS' word."""

    @abstractmethod
    def _add_to(self, scene: Any) -> None:
        """Add it to a scene of `ld.core`."""

    @abstractmethod
    def _stretched(self, *factors: float) -> Wall:
        """The wall after each coordinate is multiplied by its factor; equal ones where round."""

    def _half_spaces(self, around: float = 1.0) -> list[HalfSpace]:
        """Those that have a container in common; of a round one a square or cube around it.

        Args:
            around: factor by which that is larger.
        """
        return []

    @property
    def _round_axes(self) -> tuple[int, ...]:
        """The axes along which a round wall is stretched by one factor."""
        return ()

    @property
    @abstractmethod
    def _middle(self) -> Floats:
        """A point of the wall, the center of an obstacle, shape (d,) [length]."""

    @property
    def _extent(self) -> float:
        """Radius of a circle or sphere around it, about the middle; infinite without [length]."""
        return math.inf

    def _set_point(self, name: str, dimension: int) -> None:
        """Check an attribute that is a point; 0 is the origin."""
        given = getattr(self, name)
        point = numbers(f"{name} of a {type(self).__name__}", given)
        if point.shape == () and point == 0.0:
            point = np.zeros(dimension)
        if point.shape != (dimension,):
            axes = ", ".join("xyz"[:dimension])
            raise ParameterError(
                f"{name} of a {type(self).__name__} must be a point ({axes}), not {shown(given)}"
            )
        object.__setattr__(self, name, tuple(point.tolist()))


@dataclass(frozen=True, repr=False)
class Plane(Wall):
    """A flat wall without ends, in the plane a straight one; particles are on one side of it.

    Attributes:
        origin: any point of the wall (x, y), in space (x, y, z) [length]; 0 is the origin.
        normal: direction from the wall to the particles (x, y) or (x, y, z), of any length.

    Raises:
        ParameterError: a value is not finite, or the normal is 0, or there is an adhesion in space.
    """

    inside: ClassVar[bool] = True
    _kind: ClassVar[str] = "plane"

    origin: Point
    normal: Point

    def __post_init__(self) -> None:
        normal = numbers("normal of a Plane", self.normal)
        if normal.shape not in ((2,), (3,)) or not normal.any():
            raise ParameterError(
                "normal of a Plane must be a direction (x, y), or (x, y, z) in space, not "
                f"{shown(self.normal)}"
            )
        object.__setattr__(self, "normal", tuple(normal.tolist()))
        self._set_point("origin", self.dimension)
        super().__post_init__()

    @property
    def dimension(self) -> int:
        return len(self.normal)

    @property
    def _middle(self) -> Floats:
        return np.array(self.origin)

    @property
    def _values(self) -> tuple[float, ...]:
        return (*self.origin, *self.normal)

    def _half_spaces(self, around: float = 1.0) -> list[HalfSpace]:
        out = -np.array(self.normal) / lengths(np.array(self.normal))
        return [(out, float(out @ self.origin))]

    def _add_to(self, scene: Any) -> None:
        scene.add_plane(*self._values)

    def _stretched(self, *factors: float) -> Plane:
        others = (math.prod(factors[:k] + factors[k + 1 :]) for k in range(len(factors)))
        normal = _scaled(self.normal, tuple(others))
        return replace(self, origin=_scaled(self.origin, factors), normal=normal)


class _Round(Wall):
    """A sphere, or a cylinder."""

    radius: float
    origin: Point | float

    @property
    def _middle(self) -> Floats:
        return np.array(self.origin)

    @property
    def _extent(self) -> float:
        return self.radius

    def _half_spaces(self, around: float = 1.0) -> list[HalfSpace]:
        if not self.inside:
            return []
        units = [np.eye(self.dimension)[axis] for axis in self._round_axes]
        size = around * self.radius
        return [(n, float(n @ self._middle) + size) for n in (*units, *(-n for n in units))]

    def _stretched(self, *factors: float) -> Wall:
        origin, radius = _scaled(self._middle, factors), self.radius * factors[self._round_axes[0]]
        return replace(self, origin=origin, radius=radius)  # type: ignore[call-arg]

    def _set_radius(self) -> None:
        radius = positive(f"radius of a {type(self).__name__}", self.radius)
        object.__setattr__(self, "radius", radius)


@dataclass(frozen=True, repr=False)
class Sphere(_Round):
    """A round wall: a sphere in space, a circle in the plane.

    Attributes:
        radius: [length].
        origin: its center, (x, y) or (x, y, z) [length].
        inside: particles are inside; otherwise it is an obstacle.

    Raises:
        ParameterError: a value is not finite, or the radius is not positive, or there is an
            adhesion in space.
    """

    radius: float
    origin: Point | float = 0.0
    _: KW_ONLY
    inside: bool = True  # type: ignore[misc]

    def __post_init__(self) -> None:
        self._set_radius()
        if number_or_nan(self.origin) == 0.0:
            object.__setattr__(self, "origin", 0.0)
        else:
            in_space = numbers("origin of a Sphere", self.origin).shape == (3,)
            self._set_point("origin", 3 if in_space else 2)
        super().__post_init__()

    def _placed(self, dimension: int) -> Sphere:
        return self if self.dimension else replace(self, origin=(0.0,) * dimension)

    @property
    def dimension(self) -> int:
        return np.size(self.origin) if np.ndim(self.origin) else 0

    @property
    def _kind(self) -> str:
        names = ("disk", "circle") if self.dimension == 2 else ("ball", "sphere")
        return names[self.inside]

    @property
    def _values(self) -> tuple[float, ...]:
        return (*self._middle.tolist(), self.radius)

    def _add_to(self, scene: Any) -> None:
        scene.add_round(*self._values, self.inside)

    @property
    def _round_axes(self) -> tuple[int, ...]:
        return tuple(range(self.dimension))


@dataclass(frozen=True, repr=False)
class Cylinder(_Round):
    """A tube without ends in space. Planes may close it, or it goes on with the box.

    Attributes:
        radius: [length].
        axis: `x`, `y` or `z`, or (0, 0, 1) and so on: a direction along an axis of the coordinates.
        origin: any point of its own axis (x, y, z) [length].
        inside: particles are inside; otherwise it is a post, an obstacle.

    Raises:
        ParameterError: a value is not finite, the radius is not positive, or the axis another one.
    """

    dimension: ClassVar[int] = 3

    radius: float
    axis: str | Point
    origin: Point | float = 0.0
    _: KW_ONLY
    inside: bool = True  # type: ignore[misc]

    def __post_init__(self) -> None:
        self._set_radius()
        self._set_point("origin", 3)
        along = np.flatnonzero(_axis_of("Cylinder", self.axis, "xyz"))
        object.__setattr__(self, "axis", "xyz"[int(along[0])])
        super().__post_init__()

    @property
    def _kind(self) -> str:
        return "cylinder" if self.inside else "post"

    @property
    def _direction(self) -> Point:
        """Of the axis, a unit vector."""
        return tuple(float(axis == self.axis) for axis in "xyz")

    @property
    def _values(self) -> tuple[float, ...]:
        return (*self._middle.tolist(), *self._direction, self.radius)

    def _add_to(self, scene: Any) -> None:
        scene.add_cone(*self._values, 0.0, self.inside)

    @property
    def _round_axes(self) -> tuple[int, ...]:
        return tuple(k for k, axis in enumerate("xyz") if axis != self.axis)


@dataclass(frozen=True, repr=False)
class Cone(Wall):
    """A funnel that stands along z, without end: particles are inside. Planes close it.

    Attributes:
        tip: (x, y, z) [length]; 0 is the origin.
        axis: from the tip to the particles: `z` or (0, 0, 1) upward, `-z` or (0, 0, -1) downward.
        angle: between the axis and the side, above 0, below pi/2 [rad].

    Raises:
        ParameterError: a value is not finite or out of its range, or the axis another one.
    """

    dimension: ClassVar[int] = 3
    inside: ClassVar[bool] = True
    _kind: ClassVar[str] = "cone"

    tip: Point | float
    axis: str | Point
    angle: float

    def __post_init__(self) -> None:
        self._set_point("tip", 3)
        up = _axis_of("Cone", self.axis, "z")[2] > 0.0
        object.__setattr__(self, "axis", "z" if up else "-z")
        object.__setattr__(self, "angle", number_or_nan(self.angle))
        if not 0.0 < self.angle < 0.5 * math.pi:
            raise ParameterError(
                f"angle of a Cone must be above 0 and below pi/2, not {shown(self.angle)}"
            )
        super().__post_init__()

    @property
    def _slope(self) -> float:
        """By which the radius grows upward, for each unit of z; negative: downward."""
        return math.tan(self.angle) * (1.0 if self.axis == "z" else -1.0)

    @property
    def _direction(self) -> Point:
        """A unit vector upward."""
        return (0.0, 0.0, 1.0)

    @property
    def _values(self) -> tuple[float, ...]:
        x, y, z = self._middle.tolist()
        return (
            x,
            y,
            z + math.copysign(1.0, self._slope),
            0.0,
            0.0,
            1.0,
            abs(self._slope),
            self._slope,
        )

    @property
    def _middle(self) -> Floats:
        return np.array(self.tip)

    def _radius_at(self, z: float) -> float:
        """Its radius at a height, 0 beyond its tip [length]."""
        return max(self._slope * (z - float(self._middle[2])), 0.0)

    def _half_spaces(self, around: float = 1.0) -> list[HalfSpace]:
        slant = float(np.hypot(1.0, self._slope))
        rows = [
            np.array([x, y, -self._slope]) / slant for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))
        ]
        return [(n, float(n @ self._middle)) for n in rows]

    def _add_to(self, scene: Any) -> None:
        scene.add_cone(*self._values, True)

    @property
    def _round_axes(self) -> tuple[int, ...]:
        return (0, 1)

    def _stretched(self, *factors: float) -> Cone:
        across, _, along = factors
        tip = _scaled(self._middle, factors)
        return replace(self, tip=tip, angle=math.atan(abs(self._slope) * across / along))


class _Cornered(Wall):
    """An obstacle in the plane that is given by its corners."""

    dimension: ClassVar[int] = 2
    corners: tuple[Point, ...]

    @property
    def _values(self) -> tuple[float, ...]:
        return tuple(value for corner in self.corners for value in corner)

    def _add_to(self, scene: Any) -> None:
        scene.add_polygon(*np.transpose(self.corners))

    @property
    def _middle(self) -> Floats:
        middle: Floats = np.mean(self.corners, axis=0)
        return middle

    @property
    def _extent(self) -> float:
        return float(np.linalg.norm(self.corners - self._middle, axis=1).max())

    def _check_convex(self) -> None:
        try:
            core.polygon_planes(*np.transpose(self.corners))
        except ValueError as error:
            raise ParameterError(
                f"a {type(self).__name__} {error}, not {shown(self.corners)}"
            ) from None


@dataclass(frozen=True, repr=False)
class Segment(_Cornered):
    """A straight obstacle with two ends, which particles in the plane touch from both sides.

    Attributes:
        a: one end (x, y) [length].
        b: the other one.

    Raises:
        ParameterError: a value is not finite, or both ends are the same point.
    """

    inside: ClassVar[bool] = False
    _kind: ClassVar[str] = "segment"

    a: Point
    b: Point

    def __post_init__(self) -> None:
        self._set_point("a", 2)
        self._set_point("b", 2)
        self._check_convex()
        super().__post_init__()

    @property
    def corners(self) -> tuple[Point, ...]:  # type: ignore[override]
        """Both ends."""
        return self.a, self.b

    def _stretched(self, *factors: float) -> Segment:
        return replace(self, a=_scaled(self.a, factors), b=_scaled(self.b, factors))


@dataclass(frozen=True, repr=False)
class PolygonWall(_Cornered):
    """A convex polygon in the plane.

    Attributes:
        corners: in the order around it, in either direction, shape (n, 2), n >= 3 [length].
        inside: particles are inside; then a packing has its sides as walls, each a `Plane`, from
            the one between the first two corners on. Otherwise it is an obstacle.

    Raises:
        ParameterError: a value is not finite, there are too few corners, or it is not convex.
    """

    _kind: ClassVar[str] = "polygon"

    corners: tuple[Point, ...]
    _: KW_ONLY
    inside: bool = False  # type: ignore[misc]

    def __post_init__(self) -> None:
        given = numbers("corners of a PolygonWall", self.corners)
        if given.ndim != 2 or given.shape[1] != 2 or len(given) < 3:
            raise ParameterError(
                "corners of a PolygonWall must be three or more points (x, y), not "
                f"{shown(self.corners)}"
            )
        object.__setattr__(self, "corners", tuple((x, y) for x, y in given.tolist()))
        self._check_convex()
        super().__post_init__()

    @property
    def parts(self) -> tuple[Wall, ...]:
        if not self.inside:
            return (self,)
        sides = []
        for a, b in zip(self.corners, self.corners[1:] + self.corners[:1], strict=True):
            (x, y), (inward, up) = np.subtract(b, a), self._middle - a
            turn = 1.0 if x * up > y * inward else -1.0  # whether the middle is to the left
            sides.append(Plane(a, (-turn * y, turn * x), adhesion=self.adhesion))
        return tuple(sides)

    def _stretched(self, *factors: float) -> PolygonWall:
        return replace(self, corners=tuple(_scaled(corner, factors) for corner in self.corners))


@dataclass(frozen=True, repr=False)
class BoxWall(Wall):
    """A rectangle, or a cuboid in space.

        packing.between([BoxWall((20, 10)), Sphere(1, (5, 5), inside=False)])

    Attributes:
        lengths: (lx, ly), or (lx, ly, lz) in space [length].
        origin: its lowest corner [length].
        inside: particles are inside; then a packing has its sides as walls, each a `Plane`: both
            across x, then across y, and z. Otherwise it is an obstacle, in the plane only.

    Raises:
        ParameterError: a length is not positive, the origin is no point, or it is an obstacle, or
            has an adhesion, in space.
    """

    _kind: ClassVar[str] = "box"

    lengths: Point
    origin: Point | float = 0.0
    _: KW_ONLY
    inside: bool = True  # type: ignore[misc]

    def __post_init__(self) -> None:
        given = numbers("lengths of a BoxWall", self.lengths)
        if given.shape not in ((2,), (3,)) or not (given > 0.0).all():
            raise ParameterError(
                "lengths of a BoxWall must be positive, (lx, ly) or (lx, ly, lz), not "
                f"{shown(self.lengths)}"
            )
        object.__setattr__(self, "lengths", tuple(given.tolist()))
        self._set_point("origin", self.dimension)
        super().__post_init__()
        if self.dimension == 3 and not self.inside:
            raise ParameterError(
                "a BoxWall in space cannot be an obstacle: take a Sphere or a Cylinder with "
                "inside=False"
            )

    @property
    def dimension(self) -> int:
        return len(self.lengths)

    @property
    def parts(self) -> tuple[Wall, ...]:
        low = np.array(self.origin)
        units, high = np.eye(self.dimension), low + self.lengths
        if not self.inside:
            (left, front), (right, back) = low.tolist(), high.tolist()
            corners = ((left, front), (right, front), (right, back), (left, back))
            return (PolygonWall(corners, adhesion=self.adhesion),)
        return tuple(
            Plane(tuple(corner.tolist()), tuple((sign * n).tolist()), adhesion=self.adhesion)
            for axis, n in enumerate(units)
            for sign, corner in ((1.0, low), (-1.0, np.where(n > 0.0, high, low)))
        )

    @property
    def _middle(self) -> Floats:
        return np.array(self.origin) + 0.5 * np.array(self.lengths)

    @property
    def _values(self) -> tuple[float, ...]:
        return tuple(value for part in self.parts for value in part._values)

    def _add_to(self, scene: Any) -> None:
        for part in self.parts:
            part._add_to(scene)

    def _stretched(self, *factors: float) -> BoxWall:
        origin = _scaled(np.array(self.origin), factors)
        return replace(self, lengths=_scaled(self.lengths, factors), origin=origin)


@dataclass(frozen=True, repr=False)
class SurfaceWall(Wall):
    """A wall of any outline: a chain of segments in the plane, triangles in space.

        SurfaceWall([(0, 0), (4, 0), (4, 2), (8, 2)])  # a step
        SurfaceWall("funnel.stl")

    Attributes:
        corners: points of the chain in their order, shape (n, 2), or three corners of each
            triangle, shape (n, 3, 3) [length]. Or a file: rows of x and y, or STL if its name ends
            so. Triangles are joined where their corners agree to 1e-7 of the size.
        inside: particles are inside, and it is closed. Otherwise particles are outside of what is
            closed, and touch what is open from both sides. A chain is closed if it ends where it
            begins; a container is closed in any case.

    Raises:
        ParameterError: a value is not finite, a segment has no length or a triangle no area, or a
            container is open.
        FileError: the file cannot be read.
    """

    corners: tuple[Any, ...]
    _: KW_ONLY
    inside: bool = False  # type: ignore[misc]

    def __post_init__(self) -> None:
        super().__post_init__()
        given: Any = self.corners
        if isinstance(given, str | os.PathLike):
            given = _read_mesh(Path(given))
        found = numbers("corners of a SurfaceWall", given)
        if found.shape[1:] not in ((2,), (3, 3)):
            raise ParameterError(
                "corners of a SurfaceWall must be points (x, y), shape (n, 2), or triangles, "
                f"shape (n, 3, 3), or a file, not {shown(self.corners)}"
            )
        object.__setattr__(self, "corners", _as_tuples(found.tolist()))
        try:
            self._edges  # noqa: B018
        except ValueError as error:
            raise ParameterError(f"a SurfaceWall {error}") from None

    @cached_property
    def _measured(self) -> tuple[float, Floats]:
        return core.mesh(self.dimension, self._rows, self.inside)

    @property
    def _volume(self) -> float:
        """Area or volume of what is closed."""
        return self._measured[0]

    @property
    def _edges(self) -> Floats:
        """In space: both ends of each edge that is not flat, shape (m, 2, 3)."""
        return self._measured[1].reshape(-1, 2, self.dimension)

    @property
    def dimension(self) -> int:
        return 3 if isinstance(self.corners[0][0], tuple) else 2

    @property
    def _kind(self) -> str:
        return "room" if self.inside else "surface"

    @property
    def _rows(self) -> Floats:
        """Points, or three corners of each triangle, one after the other."""
        return np.array(self.corners).reshape(-1, self.dimension)

    @property
    def _is_closed(self) -> bool:
        """Of a chain."""
        return self.inside or self.corners[0] == self.corners[-1]

    @property
    def _values(self) -> tuple[float, ...]:
        return tuple(self._rows.ravel().tolist())

    def _add_to(self, scene: Any) -> None:
        scene.add_mesh(self._rows, self.inside)

    def _half_spaces(self, around: float = 1.0) -> list[HalfSpace]:
        if not self.inside:
            return []
        half, units = 0.5 * np.ptp(self._rows, axis=0), np.eye(self.dimension)
        sides = [(n, half @ np.abs(n)) for n in (*units, *-units)]
        return [(n, float(n @ self._middle + around * size)) for n, size in sides]

    @property
    def _middle(self) -> Floats:
        middle: Floats = 0.5 * (self._rows.min(axis=0) + self._rows.max(axis=0))
        return middle

    @property
    def _extent(self) -> float:
        return float(lengths(self._rows - self._middle).max())

    def _stretched(self, *factors: float) -> SurfaceWall:
        return replace(self, corners=_as_tuples((np.array(self.corners) * factors).tolist()))


def _read_mesh(path: Path) -> Floats:
    """Points of a chain, or triangles, in a file."""
    dimension = 3 if path.suffix.lower() == ".stl" else 2
    name = f"corners of a SurfaceWall, file '{path}',"
    try:
        content = path.read_bytes()
    except OSError as error:
        raise FileError(f"{name} cannot be read: {error.strerror}") from None
    with reading(name):
        found: Floats = core.read_mesh(dimension, content)
    return found if dimension == 2 else found.reshape(-1, 3, 3)


def _as_tuples(values: Any) -> Any:
    """Nested lists as nested tuples."""
    return tuple(map(_as_tuples, values)) if isinstance(values, list) else values


def _scaled(point: Point | Floats, factors: Point) -> Point:
    """A point with its coordinates multiplied by one factor each."""
    return tuple(float(x) * factor for x, factor in zip(point, factors, strict=True))


def _axis_of(name: str, given: ArrayLike, letters: str) -> Floats:
    """A unit vector along one of these axes, or opposite to it."""
    if isinstance(given, str) and (letter := given.removeprefix("-")) and letter in letters:
        unit = np.eye(3)["xyz".index(letter)]
        return -unit if given.startswith("-") else unit
    try:
        vector = numbers("axis", given)
    except ParameterError:
        vector = np.zeros(3)
    known = [unit for letter, unit in zip("xyz", np.eye(3), strict=True) if letter in letters]
    for unit in known:
        if vector.shape == (3,) and 0.0 < np.abs(vector).sum() == abs(vector @ unit):
            return np.copysign(1.0, vector @ unit) * unit
    names = " or ".join(letters) if len(letters) > 1 else f"{letters} or -{letters}"
    raise ParameterError(
        f"axis of a {name} must be {names}, or a direction along it, not {shown(given)}"
    )


SHAPES: dict[str, type[Wall]] = {
    each.__name__: each
    for each in (Plane, Sphere, Cylinder, Cone, Segment, PolygonWall, BoxWall, SurfaceWall)
}


def kind_of(wall: Wall) -> str:
    """LAMMPS' word for a wall."""
    return wall._kind


def as_walls(given: Wall | Iterable[Wall], dimension: int) -> tuple[Wall, ...]:
    """The walls of a packing from one wall or several; a box becomes its sides.

    Raises:
        ParameterError: one of them is no wall, or one of another dimension.
    """
    lacking = ("Cylinder", "Cone") if dimension == 2 else ("Segment", "PolygonWall")
    names = ", ".join(name for name in SHAPES if name not in lacking)
    try:
        several = (given,) if isinstance(given, Wall | str) else tuple(given)
    except TypeError:
        raise ParameterError(
            f"walls must be one or several of {names}, not {shown(given)}"
        ) from None
    found: list[Wall] = []
    for n, wall in enumerate(several, start=1):
        if not isinstance(wall, Wall):
            raise ParameterError(f"wall {n} must be one of {names}, not {shown(wall)}")
        wall = wall._placed(dimension)
        if wall.dimension != dimension:
            way_out = f"take one of {names}"
            if type(wall).__name__ not in lacking:
                way_out = f"give its points as ({', '.join('xyz'[:dimension])})"
            raise ParameterError(
                f"wall {n}, {shown(wall)}, is a wall in {wall.dimension} dimensions, and the "
                f"particles have {dimension}: {way_out}"
            )
        found += wall.parts
    return tuple(found)

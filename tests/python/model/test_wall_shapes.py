"""Shapes of walls: what they refuse, and how they stretch."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import BoxWall, ParameterError, Plane, PolygonWall, Segment, Sphere
from lammps_deformable.walls import as_walls

WRONG = {
    "normal": (lambda: Plane((0, 0), (0, 0)), "normal of a plane"),
    "point": (lambda: Plane((0, 0, 0), (0, 1)), "point of a plane must be a point"),
    "inf": (lambda: Plane((0, np.inf), (0, 1)), "point of a plane must be finite"),
    "words": (lambda: Sphere(1, "ab", inside=False), "center of a disk"),
    "radius": (
        lambda: Sphere(-1, (0, 0), inside=False),
        "radius of a disk must be a positive number, not -1",
    ),
    "circle": (lambda: Sphere(0, (0, 0)), "radius of a circle"),
    "length": (lambda: Segment((1, 2), (1, 2)), "a segment has no length"),
    "few": (lambda: PolygonWall([(0, 0), (1, 0)]), "corners of a polygon must be three or more"),
    "convex": (
        lambda: PolygonWall([(0, 0), (2, 0), (0.5, 0.5), (0, 2)]),
        r"a polygon is not convex at its corner \(0.5",
    ),
    "star": (
        lambda: PolygonWall(
            [(1, 0), (-0.809, 0.588), (0.309, -0.951), (0.309, 0.951), (-0.809, -0.588)]
        ),
        "a polygon crosses itself",
    ),
    "width": (lambda: BoxWall((0, 1)).parts, "width"),
    "corner": (lambda: BoxWall((1, 1), 3).parts, "corner must be a point"),
    "no shape": (lambda: as_walls(3), "walls must be one or several of Plane, .* not 3"),
    "class": (lambda: as_walls([Sphere]), "wall 1 must be one of Plane"),
    "nested": (
        lambda: as_walls([Sphere(1, (0, 0), inside=False), BoxWall((1, 1))]),
        "wall 2 must be one of Plane.*put [*] before",
    ),
    "bead walls": (
        lambda: as_walls(ld.Walls([0.0, 2.0, 4.0], [1.0, 1.0, 1.0])),
        "walls must be one or several of Plane",
    ),
}


@pytest.mark.parametrize(("make", "message"), WRONG.values(), ids=WRONG)
def test_wrong_shapes(make, message) -> None:
    with pytest.raises(ParameterError, match=message) as error:
        make()
    assert "\n" not in str(error.value)


def test_rectangle() -> None:
    """Normals point inward, from points on the sides."""
    sides = BoxWall((4, 2), (1, 10)).parts
    middle = np.array([3, 11])
    heights = [(middle - side.point) @ side.normal for side in sides]
    assert heights == [2, 2, 1, 1]


def test_shapes_are_values() -> None:
    assert Sphere(2, [0, 1], inside=False) == Sphere(2.0, (0.0, 1.0), inside=False)
    assert len({Segment((0, 0), (1, 0)), Segment(np.zeros(2), [1, 0])}) == 1
    assert PolygonWall(np.array([[0, 0], [1, 0], [0, 1]])).corners == ((0, 0), (1, 0), (0, 1))


def test_stretched_plane() -> None:
    """Points of the line stay on it."""
    plane = Plane((1, 2), (3, 1))
    along = np.array([1, 2]) + 0.7 * np.array([-1, 3])
    new = plane.stretched(2.0, 0.5)
    assert (along * [2.0, 0.5] - new.point) @ new.normal == pytest.approx(0, abs=1e-14)


def test_sides_of_bead_walls_as_planes() -> None:
    """`Walls` of beads around the origin, as planes of a container."""
    walls = ld.Walls([0.0, 2.0, 4.0], [1.0, 1.5, 2.0])
    for plane, height in zip(walls.planes, walls.height, strict=True):
        assert -np.dot(plane.point, plane.normal) == pytest.approx(height)

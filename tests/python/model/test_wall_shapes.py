"""Shapes of walls: what they refuse, and how they stretch."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import Circle, Disk, ParameterError, Plane, Polygon, Segment, rectangle
from lammps_deformable.walls import as_walls

WRONG = {
    "normal": (lambda: Plane((0, 0), (0, 0)), "normal of a plane"),
    "point": (lambda: Plane((0, 0, 0), (0, 1)), "point of a plane must be a point"),
    "inf": (lambda: Plane((0, np.inf), (0, 1)), "point of a plane must be finite"),
    "words": (lambda: Disk("ab", 1), "center of a disk"),
    "radius": (lambda: Disk((0, 0), -1), "radius of a disk must be a positive number, not -1"),
    "circle": (lambda: Circle((0, 0), 0), "radius of a circle"),
    "length": (lambda: Segment((1, 2), (1, 2)), "a segment has no length"),
    "few": (lambda: Polygon([(0, 0), (1, 0)]), "corners of a polygon must be three or more"),
    "convex": (
        lambda: Polygon([(0, 0), (2, 0), (0.5, 0.5), (0, 2)]),
        r"a polygon is not convex at its corner \(0.5",
    ),
    "star": (
        lambda: Polygon(
            [(1, 0), (-0.809, 0.588), (0.309, -0.951), (0.309, 0.951), (-0.809, -0.588)]
        ),
        "a polygon crosses itself",
    ),
    "width": (lambda: rectangle(0, 1), "width"),
    "corner": (lambda: rectangle(1, 1, 3), "corner must be a point"),
    "no shape": (lambda: as_walls(3), "walls must be one or several of Plane, .* not 3"),
    "class": (lambda: as_walls([Disk]), "wall 1 must be one of Plane"),
    "nested": (
        lambda: as_walls([Disk((0, 0), 1), rectangle(1, 1)]),
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
    sides = rectangle(4, 2, corner=(1, 10))
    middle = np.array([3, 11])
    heights = [(middle - side.point) @ side.normal for side in sides]
    assert heights == [2, 2, 1, 1]


def test_shapes_are_values() -> None:
    assert Disk([0, 1], 2) == Disk((0.0, 1.0), 2.0)
    assert len({Segment((0, 0), (1, 0)), Segment(np.zeros(2), [1, 0])}) == 1
    assert Polygon(np.array([[0, 0], [1, 0], [0, 1]])).corners == ((0, 0), (1, 0), (0, 1))


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

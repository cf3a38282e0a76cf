"""Walls: what they refuse, what stands for them, and how they stretch."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import (
    BoxWall,
    Cone,
    Cylinder,
    ParameterError,
    Plane,
    PolygonWall,
    Segment,
    Sphere,
)
from lammps_deformable.particles.polygons import Walls
from lammps_deformable.particles.walls import as_walls
from refusals import refused

WRONG = {
    "normal": (lambda: Plane((0, 0), (0, 0)), "normal of a Plane"),
    "inf": (lambda: Plane((0, np.inf), (0, 1)), "origin of a Plane must be finite"),
    "ragged": (lambda: Sphere(1, (0.0, [1])), "origin of a Sphere must be finite numbers"),
    "inside": (lambda: Sphere(1, inside="no"), "inside of a Sphere must be of the kind bool"),
    "adhesion": (lambda: Sphere(1, (0, 0), adhesion=-1), "adhesion"),
    "length": (lambda: Segment((1, 2), (1, 2)), "a Segment has no length"),
    "few": (lambda: PolygonWall([(0, 0), (1, 0)]), "corners of a PolygonWall must be three"),
    "convex": (
        lambda: PolygonWall([(0, 0), (2, 0), (0.5, 0.5), (0, 2)]),
        r"a PolygonWall is not convex at its corner \(0.5",
    ),
    "star": (
        lambda: PolygonWall(
            [(1, 0), (-0.809, 0.588), (0.309, -0.951), (0.309, 0.951), (-0.809, -0.588)]
        ),
        "a PolygonWall crosses itself",
    ),
    "width": (lambda: BoxWall((0, 1)), "lengths of a BoxWall must be positive"),
    "block": (lambda: BoxWall((1, 1, 1), inside=False), "cannot be an obstacle"),
    "axis": (lambda: Cylinder(1, (1, 1, 0)), r"axis of a Cylinder must be x or y or z, .*\(1, 1"),
    "leaning": (lambda: Cone(0, "x", 0.5), "axis of a Cone must be z or -z, .* not 'x'"),
    "angle": (lambda: Cone(0, "z", 2.0), "angle of a Cone must be above 0 and below pi/2, not 2"),
    "no shape": (lambda: as_walls(3, 2), "walls must be one or several of Plane, .* not 3"),
    "class": (lambda: as_walls([Sphere], 2), "wall 1 must be one of Plane, Sphere, Segment"),
    "dimension": (
        lambda: as_walls([Sphere(1), Cylinder(1, "z")], 2),
        r"wall 2, Cylinder\(radius=1.0, axis='z', .* is a wall in 3 dimensions, .* 2: take one of",
    ),
}


def test_wrong_shapes() -> None:
    for make, message in WRONG.values():
        with refused(message):
            make()


@pytest.mark.parametrize("walls", [
    BoxWall((4, 2), (1, 10)),
    PolygonWall([(1, 10), (1, 12), (5, 12), (5, 10)], inside=True),
])  # fmt: skip
def test_sides_of_a_rectangle(walls) -> None:
    """Normals point inward, from points on the sides, whatever the order of the corners."""
    sides = as_walls(walls, 2)
    middle = np.array([3, 11])
    heights = [(middle - side.origin) @ side.normal / np.hypot(*side.normal) for side in sides]
    assert sorted(heights) == [1, 1, 2, 2]
    assert ld.Packing([middle], 0.1, (9, 9), walls=walls).volume == pytest.approx(8)


def test_an_obstacle_of_a_box_is_a_polygon() -> None:
    (wall,) = as_walls(BoxWall((4, 2), (1, 10), inside=False), 2)
    assert wall == PolygonWall([(1, 10), (5, 10), (5, 12), (1, 12)])


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_sphere_around_0_has_the_dimension_of_the_packing(dimension) -> None:
    packing = ld.bidisperse(4, dimension=dimension, seed=1).between(Sphere(4))
    assert packing.walls == (Sphere(4, (0,) * dimension),)
    assert packing.periodic == (False,) * dimension


def test_walls_are_values() -> None:
    assert Sphere(2, [0, 1], inside=False) == Sphere(2.0, (0.0, 1.0), inside=False)
    assert len({Segment((0, 0), (1, 0)), Segment(np.zeros(2), [1, 0])}) == 1
    assert PolygonWall(np.array([[0, 0], [1, 0], [0, 1]])).corners == ((0, 0), (1, 0), (0, 1))
    assert Cylinder(1, (0, 0, 2)) == Cylinder(1, "z", (0, 0, 0))
    for wall in (
        Plane((1, 2), (0, 1), adhesion=0.5),
        Sphere(2, (0, 1), inside=False),
        Cylinder(1, "x", (0, 2, 0)),
        Cone((0, 0, 1), (0, 0, -3), 0.5),
        BoxWall((3, 4)),
    ):
        assert eval(repr(wall)) == wall


def test_sides_of_the_box_become_walls() -> None:
    """Along an axis that is not periodic the box has the walls of a rectangle there."""
    places, box = [[1, 1], [2, 3]], (6, 5)
    channel = ld.Packing(places, 0.5, box, periodic=(True, False))
    assert channel.walls == as_walls(BoxWall(box), 2)[2:]
    assert channel.periodic == (True, False)
    assert ld.Packing(places, 0.5, box, periodic=False).walls == as_walls(BoxWall(box), 2)
    assert channel.replace(walls=()).periodic == (True, True)
    with pytest.raises(ParameterError, match="periodic must be True or False, or 2 of them"):
        ld.Packing(places, 0.5, box, periodic=(True, False, True))


def test_sides_of_bead_walls_as_planes() -> None:
    """`Walls` of beads around the origin, as planes of a container."""
    walls = Walls([0.0, 2.0, 4.0], [1.0, 1.5, 2.0])
    for plane, height in zip(walls.planes, walls.height, strict=True):
        assert -np.dot(plane.origin, plane.normal) == pytest.approx(height)


def test_bead_walls_are_a_polygon() -> None:
    for angle, height, message in (
        ([0.0, 3.0], [1.0, 1.0], "less than half a turn"),
        ([0.0, 4.0, 2.0], [1.0, 1.0, 1.0], "must increase through one turn"),
        ([0.0, 2.0, 4.0], [1.0, 0.0, 1.0], "3 positive numbers"),
    ):
        with refused(message):
            Walls(angle, height)

"""The room between walls: its box, its area, and places in it."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import BoxWall, ParameterError, Plane, PolygonWall, Segment, Sphere
from lammps_deformable.particles import containers
from lammps_deformable.state.contacts import free_motions
from refusals import refused

BOX = np.array([[12.0, 0.0], [0.0, 10.0]])
CHANNEL = (Plane((0, 1), (0, 1)), Plane((5, 9), (0, -2)))
TRIANGLE = PolygonWall([(4, 4), (6, 4), (5, 6)])


@pytest.fixture(scope="module")
def loose() -> ld.Packing:
    return ld.bidisperse(30, phi=0.3, seed=1)


SCENES = {
    # walls, box, lower left corner, free area
    "disk elsewhere": (Sphere(2, (31, -23), inside=False), (12, 10), (0, 0), 120 - 4 * np.pi),
    "segment": (Segment((3, 3), (5, 4)), (12, 10), (0, 0), 120),
    "overlap": ((TRIANGLE, PolygonWall([(4, 4), (6, 4), (5, 5)])), (12, 10), (0, 0), 118),
    "rectangle": (BoxWall((7, 5), (-3, 2)), (7, 5), (-3, 2), 35),
    "channel": (CHANNEL, (12, 8), (0, 1), 96),
    "stopped": (
        (*CHANNEL, TRIANGLE, Sphere(1, (12, 5), inside=False)),
        (12, 8),
        (0, 1),
        94 - np.pi,
    ),
    "prism in the floor": (
        (BoxWall((10, 8)), PolygonWall([(4, -1), (6, -1), (6, 1), (4, 1)])),
        (10, 8),
        (0, 0),
        78,
    ),
    "half moon": ((Sphere(2, (0, 0)), Plane((0, 0), (1, 0))), (4, 4), None, 2 * np.pi),
    "hexagon": (
        [
            Plane(-np.array([c, s]), (c, s))
            for c, s in np.c_[np.cos(np.arange(6) * np.pi / 3), np.sin(np.arange(6) * np.pi / 3)]
        ],
        (2, 4 / np.sqrt(3)),
        (-1, -2 / np.sqrt(3)),
        2 * np.sqrt(3),
    ),
}


def test_box_and_area(loose) -> None:
    """phi is over the area that walls leave free; a disk across another wall is a polygon."""
    for name, (walls, box, origin, area) in SCENES.items():
        packing = ld.Packing(loose.positions, loose.radii, BOX, species=loose.species, walls=walls)
        if origin is not None:
            assert packing.box.diagonal() == pytest.approx(box), name
            assert packing.origin == pytest.approx(origin), name
        assert packing.volume == pytest.approx(area, rel=1e-5 if origin is None else 1e-12), name
        assert packing.phi == pytest.approx(np.pi * np.sum(packing.radii**2) / area, rel=1e-5)


def test_places_between_walls(loose) -> None:
    walls = (Sphere(9, (1, 2)), Sphere(3, (4, 2), inside=False), TRIANGLE, Segment((0, 0), (0, 4)))
    packing = loose.between(walls, seed=3)
    x, y = packing.positions.T
    assert np.hypot(x - 1, y - 2).max() < 9
    assert np.hypot(x - 4, y - 2).min() > 3
    assert not np.array_equal(packing.positions, loose.between(walls, seed=4).positions)
    # packings from several seeds have several places, and each has the same ones again
    first, second, again = (ld.bidisperse(20, seed=seed) for seed in (1, 2, 1))
    room = first.between(walls).positions
    assert not np.array_equal(room, second.between(walls).positions)
    by_column = again.replace(positions=np.asfortranarray(again.positions))
    assert np.array_equal(room, by_column.between(walls).positions)
    assert packing.radii.tolist() == loose.radii.tolist()
    # another phi: everything by one factor
    dense = packing.at(0.8)
    assert dense.phi == pytest.approx(0.8)
    factor = np.sqrt(packing.phi / 0.8)
    assert dense.walls[1] == Sphere(3 * factor, (4 * factor, 2 * factor), inside=False)
    assert dense.positions == pytest.approx(packing.positions * factor)


WRONG = {
    "floor": (Plane((0, 0), (0, 1)), "planes leave the room open"),
    "outward": (
        [Plane(p.origin, -np.array(p.normal)) for p in BoxWall((5, 5)).parts],
        "leave no room",
    ),
    "filled": ((BoxWall((5, 5)), Sphere(4, (2.5, 2.5), inside=False)), "obstacles fill the room"),
    "crowded": (
        (BoxWall((5, 5)), Sphere(3.5354, (2.5, 2.5), inside=False)),
        "obstacles fill the room|too little room",
    ),
    "huge circles": ((Sphere(1e300, (0, 0)),) * 2, r"too large .* 1e\+300"),
}


def test_no_room(loose) -> None:
    for walls, message in WRONG.values():
        with refused(message):
            loose.between(walls)


def test_containers_need_a_rectangular_box() -> None:
    tilted = ld.bidisperse(10, tilt=0.2, seed=1)
    with pytest.raises(ParameterError, match="not tilted"):
        tilted.between(BoxWall((5, 5)))
    assert tilted.between(Sphere(1, (0, 0), inside=False)).box[1, 0] > 0


def test_obstacles_fit_into_the_periodic_box() -> None:
    containers.check_fit([Sphere(3, (0, 0), inside=False)], BOX, 2.0)
    with pytest.raises(ParameterError, match=r"segment 2 does not fit .* along y"):
        containers.check_fit([Sphere(3, (0, 0), inside=False), Segment((0, 0), (0, 8))], BOX, 2.0)
    containers.check_fit([*BoxWall((3, 3)).parts, Segment((0, 0), (0, 8))], BOX, 2.0)


def test_centers_on_the_wrong_side() -> None:
    x = np.array([[1.0, 1.0], [5.0, 5.0]])
    for walls, message in (
        (
            [Sphere(1, (9, 9), inside=False), Sphere(1, (5, 5.5), inside=False)],
            "particle 1, .5.0, 5.0., is within disk 2",
        ),
        ([TRIANGLE], "particle 1, .* within polygon 1"),
        ([Segment((4, 5), (6, 5))], "particle 1, .* within segment 1"),
        (BoxWall((4, 9)).parts, "particle 1, .* outside of plane 2"),
        ([Sphere(2, (1, 1))], "particle 1, .* outside of circle 1"),
    ):
        with pytest.raises(ParameterError, match=message):
            containers.check_centers(walls, BOX, x)
    # the image of a disk
    with pytest.raises(ParameterError, match="particle 0"):
        containers.check_centers([Sphere(1, (12.5, 10.5), inside=False)], BOX, x)


def test_free_motions() -> None:
    """Of all particles together: of a box, a channel, a round container, an annulus, and none."""
    ring, hub = (Sphere(3, (0, 0)), Sphere(4, (0, 0))), Sphere(1, (0, 0), inside=False)
    counts = [
        free_motions(walls)
        for walls in (
            (),
            CHANNEL,
            ring,
            (hub, *ring),
            BoxWall((2, 2)).parts,
            (*ring, TRIANGLE),
            (hub,),
        )
    ]
    assert counts == [2, 1, 1, 1, 0, 0, 0]

"""The room between walls in space: its box, its volume, places in it, and what stays round."""

from collections.abc import Callable

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import BoxWall, Cylinder, ParameterError, Plane, Sphere
from lammps_deformable.particles import containers
from lammps_deformable.particles.containers import free_room, section_between
from lammps_deformable.state.contacts import free_motions, motions
from refusals import refused

BOX = np.diag([12.0, 10.0, 9.0])
TILTED = np.array([[12.0, 0.0, 0.0], [3.0, 10.0, 0.0], [-2.0, 4.0, 9.0]])
PLATES = (Plane((0, 0, 1), (0, 0, 1)), Plane((5, 9, 4), (0, 0, -2)))
FLOOR_OF_TUBE = (Plane((0, 1, 0), (0, 1, 0)), Plane((0, 5, 0), (0, -1, 0)))
OF_BALL = 4.0 / 3.0 * np.pi


@pytest.fixture(scope="module")
def loose() -> ld.Packing:
    return ld.bidisperse(30, phi=0.2, dimension=3, seed=1)


SCENES = {
    # walls, box, lowest corner, volume, how well the volume is known
    "none": ((), (12, 10, 9), (0, 0, 0), 1080, 1e-12),
    "cuboid": (BoxWall((7, 5, 4), (-3, 2, 1)), (7, 5, 4), (-3, 2, 1), 140, 1e-12),
    "plates": (PLATES, (12, 10, 3), (0, 0, 1), 360, 1e-12),
    "sphere": (Sphere(5, (1, 2, 3)), (10, 10, 10), (-4, -3, -2), 125 * OF_BALL, 1e-12),
    "tube": (Cylinder(4, "z", (1, 2, 3)), (8, 8, 9), (-3, -2, 0), 144 * np.pi, 1e-12),
    "drum": (
        (Cylinder(4, "y", (1, 2, 3)), *FLOOR_OF_TUBE),
        (8, 4, 8),
        (-3, 1, -1),
        64 * np.pi,
        1e-12,
    ),
    "ball": (
        Sphere(2, (35, -20, 8.5), inside=False),
        (12, 10, 9),
        (0, 0, 0),
        1080 - 8 * OF_BALL,
        1e-12,
    ),
    "ball in the floor": (
        (BoxWall((9, 9, 9)), Sphere(2, (5, 4, 0), inside=False)),
        (9, 9, 9),
        (0, 0, 0),
        729 - 4 * OF_BALL,
        1e-12,
    ),
    "dome": ((Sphere(2, (0, 0, 0)), Plane((1, 0, 0), (1, 0, 0))), None, None, np.pi * 5 / 3, 1e-6),
    "half a tube": (
        (Cylinder(2, "z", (0, 0, 0)), Plane((0, 0, 0), (1, 0, 0))),
        (2, 4, 9),
        None,
        18 * np.pi,
        1e-6,
    ),
    "two tubes": (
        (Cylinder(2, "z", (0, 0, 0)), Cylinder(2, "x", (0, 0, 0))),
        (4, 4, 4),
        None,
        128 / 3,
        1e-4,
    ),
}


def test_box_and_volume(loose) -> None:
    """phi is over the volume that walls leave free."""
    for name, (walls, box, origin, volume, rel) in SCENES.items():
        packing = loose.replace(box=BOX, walls=walls)
        if box is not None:
            assert packing.box.diagonal() == pytest.approx(box), name
        if origin is not None:
            assert packing.origin == pytest.approx(origin), name
        assert packing.volume == pytest.approx(volume, rel=rel), name
        assert packing.phi == pytest.approx(OF_BALL * np.sum(packing.radii**3) / volume, rel=rel)


def test_volume_that_is_found_by_chance() -> None:
    """Balls that cross each other, a round wall and the boundary, in a tilted box too."""
    rng = np.random.default_rng(1)
    for walls, box in (
        (
            (
                Sphere(2, (1, 1, 1), inside=False),
                Sphere(2.5, (2, 3, 2), inside=False),
                Sphere(1, (6, 5, 5), inside=False),
            ),
            TILTED,
        ),
        (
            (Sphere(4, (5, 5, 5)), Sphere(2, (2, 5, 4), inside=False), Plane((0, 0, 3), (1, 0, 2))),
            BOX,
        ),
        (
            (
                Cylinder(4, "y", (5, 5, 5)),
                Sphere(2, (2, 5, 4), inside=False),
                Sphere(1.5, (3, 6, 5), inside=False),
            ),
            BOX,
        ),
    ):
        packing = ld.Packing(np.full((1, 3), 5.0), 0.1, box, walls=walls)
        tried = packing.origin + rng.random((50_000, 3)) @ packing.box
        inside = (
            (containers.Distances(packing.walls, packing.box)(tried)[1] > 0.0).all(axis=0).mean()
        )
        part = packing.volume / np.prod(packing.box.diagonal())
        assert part == pytest.approx(inside, abs=5 * np.sqrt(part * (1 - part) / len(tried)))


def test_places_between_walls(loose) -> None:
    walls = (Cylinder(5, "z", (1, 2, 0)), *PLATES, Sphere(1, (2, 2, 2), inside=False))
    packing = loose.between(walls, seed=3)
    x, y, z = packing.positions.T
    assert np.hypot(x - 1, y - 2).max() < 5
    assert z.min() > 1
    assert z.max() < 4
    assert np.linalg.norm(packing.positions - 2, axis=1).min() > 1
    assert not np.array_equal(packing.positions, loose.between(walls, seed=4).positions)
    dense = packing.at(0.6)
    factor = (packing.phi / 0.6) ** (1 / 3)
    assert dense.phi == pytest.approx(0.6)
    tube = np.array([1, 2, 0, 0, 0, 1 / factor, 5])
    assert dense.walls[0]._values == pytest.approx(tube * factor)
    assert dense.walls[3]._values == pytest.approx(np.array([2, 2, 2, 1]) * factor)


def test_stretched_walls() -> None:
    """A piston in a tube; other walls stay round, and nothing is sheared."""
    tube = (Cylinder(2, "z", (1, 2, 3)), *PLATES)
    short = BOX * [1, 1, 0.5]
    assert containers.stretched(tube, BOX, short) == (
        Cylinder(2, "z", (1, 2, 1.5)),
        Plane((0, 0, 0.5), (0, 0, 1)),
        Plane((5, 9, 2), (0, 0, -2)),
    )
    leaning = Plane((1, 1, 1), (1, 2, 3))._stretched(2.0, 0.5, 1.5)
    along = np.array([1, 1, 1]) + 0.7 * np.array([3, 0, -1])
    assert (along * [2, 0.5, 1.5] - leaning.origin) @ leaning.normal == pytest.approx(0, abs=1e-14)
    for walls, new, told in (
        (tube, BOX * [1, 0.9, 1], "cylinder 1 must stay round: .* 1 along x and 0.9 along y$"),
        ([Sphere(1, (0, 0, 0), inside=False)], short, "ball 1 must stay round: .* and 0.5 along z"),
        (PLATES, np.diag([12.0, 10.0, 9.0]) + np.eye(3, k=-1), "cannot be sheared"),
    ):
        with pytest.raises(ParameterError, match=told):
            containers.stretched(walls, BOX, new)


def test_free_motions() -> None:
    """Of all particles together, and that they keep their distances from the walls."""
    sphere, hub, off = (
        Sphere(4, (1, 2, 3)),
        Sphere(1, (1, 2, 3), inside=False),
        Sphere(1, (1, 2, 4), inside=False),
    )
    tube = Cylinder(4, "z", (1, 2, 3))
    scenes = {
        (): 3,
        PLATES: 2,
        (sphere,): 3,
        (sphere, hub): 3,
        (sphere, off): 1,
        (sphere, Plane((1, 2, 3), (0, 1, 1))): 1,
        (tube,): 2,
        (tube, *PLATES): 1,
        (tube, off): 1,
        (tube, Sphere(1, (2, 2, 3), inside=False), *PLATES): 0,
        BoxWall((9, 9, 9)).parts: 0,
        (hub,): 0,
        (*PLATES, hub): 0,
    }
    x = np.array([[1.5, 2.5, 3.7], [0.3, 1.2, 2.2]])
    for walls, count in scenes.items():
        assert free_motions(walls, 3) == count, walls
        found = motions(walls, x)
        assert found.shape == (count, 2, 3)
        if walls and count:
            out, _ = containers.Distances(walls, BOX)(x)
            assert np.abs(np.einsum("mna,wna->mwn", found, out)).max() < 1e-12


def test_sections() -> None:
    """What a plane cuts, by the distances of its points."""
    walls = (
        Sphere(4, (5, 5, 5)),
        Sphere(1.5, (3, 5, 4), inside=False),
        Plane((0, 0, 3), (1, 0, 2)),
    )
    flat = section_between(walls, BOX, 4.5)
    assert flat is not None
    x = np.column_stack([1 + 8 * np.random.default_rng(1).random((200, 2)), np.full(200, 4.5)])
    free = (containers.Distances(walls, BOX)(x)[1] > 0).all(axis=0)
    in_plane = (containers.Distances(flat, BOX[:2, :2])(x[:, :2])[1] > 0).all(axis=0)
    assert 20 < free.sum() < 180
    assert (free == in_plane).all()
    assert section_between(walls, BOX, 9.5) is None
    assert section_between(PLATES, BOX, 0.5) is None
    assert section_between(PLATES, BOX, 2.0) == []


def some(walls: object, box: object = BOX) -> ld.Packing:
    return ld.Packing([[5, 5, 5]], 0.5, box, walls=walls)


WRONG: dict[str, tuple[Callable[[], object], str]] = {
    "floor": (lambda: some(PLATES[:1]), "leave the room open: .* a `BoxWall`$"),
    "filled": (
        lambda: free_room((*BoxWall((5, 5, 5)).parts, Sphere(9, (2, 2, 2), inside=False)), BOX),
        "fill the room",
    ),
    "no numbers": (
        lambda: free_room((Sphere(5, (0, 0, 0)), Sphere(1e300, (2, 4, 0))), BOX),
        "walls are too large to compute the volume between them: one has the value 1e\\+300",
    ),
    "tilted": (lambda: some(PLATES, TILTED), "must be rectangular, not tilted by 3"),
    "fit": (
        lambda: containers.check_fit([*PLATES, Sphere(3, (5, 5, 3), inside=False)], BOX, 2.1),
        "ball 3 does not fit .* a sphere around it .* along y",
    ),
    "outside": (
        lambda: containers.check_centers(
            [Cylinder(3, "z", (0, 0, 0))], BOX, np.array([[5.0, 5.0, 5.0]])
        ),
        "particle 0, .* is outside of cylinder 1",
    ),
}


def test_refusals() -> None:
    for make, message in WRONG.values():
        with refused(message):
            make()

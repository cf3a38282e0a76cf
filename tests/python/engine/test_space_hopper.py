"""Cones and posts in space: volumes, a hopper that holds its filling, files, what is refused."""

from dataclasses import replace
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from exact_balance import exactly_balanced
from lammps_deformable import BoxWall, Cone, Cylinder, Droplet, ParameterError, Plane
from lammps_deformable.state.contacts import free_motions
from programs import output

FLOOR, LID = Plane((0, 0, 0), (0, 0, 1)), Plane((0, 0, 9), (0, 0, -1))
HOPPER = (
    Cone((0, 0, -1.6), "z", np.arctan(0.75)),
    Cylinder(4.2, "z", (0, 0, 0)),
    FLOOR,
    LID,
)


def frustum(low: float, high: float, height: float) -> float:
    return np.pi / 3 * height * (low**2 + low * high + high**2)


ROOMS = {  # walls, their volume, and the motions that they leave free
    "hopper": (HOPPER, frustum(1.2, 4.2, 4) + np.pi * 4.2**2 * 5, 1),
    "heap": ((Cone((1, 2, 7.0), "-z", np.arctan(0.5)), FLOOR, LID), np.pi / 3 * 3.5**2 * 7, 1),
    "tip above the floor": (
        (Cone((0, 0, 5.0), "z", np.arctan(1)), FLOOR, LID),
        np.pi / 3 * 4**3,
        1,
    ),
    "post": (
        (BoxWall((8, 7, 6)), Cylinder(1.2, "z", (3, 4, 0), inside=False)),
        (56 - 1.44 * np.pi) * 6,
        0,
    ),
    "plates": ((FLOOR, LID, Cylinder(2, "z", (0, 0, 0), inside=False)), None, 0),
}


def packed(walls, phi=0.62, number=40) -> ld.Packing:
    start = ld.bidisperse(number, sizes=(0.5, 0.6), dimension=3, seed=2).between(walls)
    return start.at(phi).push_off()


def test_volumes_and_free_motions() -> None:
    for name, (walls, volume, free) in ROOMS.items():
        packing = ld.bidisperse(20, dimension=3, seed=1).between(walls)
        if volume is None:
            lx, ly, lz = packing.box.diagonal()
            volume = (lx * ly - 4 * np.pi) * lz
        assert packing.volume == pytest.approx(volume, rel=1e-12), name
        assert free_motions(packing.walls, 3) == free, name


@pytest.mark.parametrize("axis", "xz")
def test_a_post_in_a_periodic_box(axis: str) -> None:
    """It is one wherever it stands, and droplets touch its images."""
    start, found = packed([Cylinder(1.0, axis, (1, 2, 3), inside=False)]), []
    post, side = start.walls[0], float(start.box[0, 0])
    for cells in ((0, 0, 0), (1, 0, 1), (0, 1, 1)):
        image = replace(post, origin=tuple(np.add(post.origin, np.multiply(side, cells))))
        packing = start.replace(walls=(image,))
        with exactly_balanced(), ld.Simulation(packing, Droplet()) as sim:
            found.append(sim.state())
    volume = side**3 - np.pi * post.radius**2 * side
    assert [float(s.packing.volume) for s in found] == pytest.approx([volume] * 3, rel=1e-12)
    assert [s.energy for s in found] == pytest.approx([found[0].energy] * 3, rel=1e-9)
    assert found[0].contacts["j"].min() == -1
    assert found[0].wall_forces[0, "xyz".index(axis)] == 0.0


def test_a_hopper_holds_its_filling(tmp_path: Path) -> None:
    """Walls bear the weight, and the funnel most of it; the state goes on from files."""
    packing = packed((*HOPPER[:-1], Plane((0, 0, 12), (0, 0, -1))), 0.4)
    weight = 0.02
    down = {"gravity": (0, 0, -weight), "minimizer": "fire"}
    with exactly_balanced(), ld.Simulation(packing, Droplet(), **down) as sim:
        state = sim.relax(1e-8)
        state.save(tmp_path)
    total = state.wall_forces.sum(axis=0)
    assert total == pytest.approx([0, 0, -weight * len(packing)], abs=1e-6 * weight)
    cone, tube, floor, lid = state.wall_forces
    assert cone[2] < total[2] / 2
    assert tube[2] == 0.0
    assert floor[2] < 0.0
    assert not lid.any()
    touching = state.contacts["j"] < 0
    slanted = np.abs(state.contacts["normal"][touching][:, 2] + 0.6) < 1e-9
    assert slanted.sum() >= 3  # across the side of the cone
    lines = output("lmp", "-in", "in.lammps", "-log", "none", cwd=tmp_path).splitlines()
    head = next(n for n, line in enumerate(lines) if line.split()[:2] == ["Step", "PotEng"])
    assert float(lines[head + 1].split()[1]) == pytest.approx(state.energy, rel=1e-9)
    with exactly_balanced(), ld.Run(tmp_path).simulation() as sim:
        assert sim.walls == state.packing.walls
        assert sim.state().energy == pytest.approx(state.energy, rel=1e-9)


def test_a_funnel_is_stretched_along_its_axis() -> None:
    packing = packed(HOPPER)
    with ld.Simulation(packing, Droplet()) as sim:
        before = sim.walls[0]
        sim.deform(packing.box * [1, 1, 0.99])
        assert sim.walls[0].tip == pytest.approx(np.multiply(before.tip, [1, 1, 0.99]))
        assert sim.walls[0]._slope == pytest.approx(before._slope / 0.99)
        with pytest.raises(ParameterError, match="cone 1 must stay round"):
            sim.deform(packing.box * [0.99, 1, 1])


def test_refused_scenes() -> None:
    two = ld.Packing([[2, 2, 2], [6, 6, 6]], 0.5, [9, 9, 9])
    tilted = two.replace(box=[[9, 0, 0], [1, 9, 0], [0, 0, 9]])
    for packing, walls, told in (
        (
            two,
            [Cylinder(4, "z", (4, 4, 4), inside=False)],
            "post 1 does not fit into the periodic box",
        ),
        (two, [Cylinder(1, "z", (2, 2, 7), inside=False)], "particle 0, .* within post 1"),
        (two, [Cone((2, 2, -0.1), "z", np.arctan(1)), FLOOR], "leave the room open"),
        (
            two,
            [Cone((2, 2, -0.2), "z", np.arctan(0.5)), FLOOR, LID],
            "particle 1, .* outside of cone 1",
        ),
        (
            tilted,
            [Cylinder(1, "y", (4, 4, 4), inside=False)],
            "post 1 is not along an edge of the box",
        ),
    ):
        with pytest.raises(ParameterError, match=told):
            ld.Simulation(packing.replace(walls=walls), Droplet())
    with ld.Simulation(
        tilted.replace(walls=Cylinder(1, "x", (4, 4, 4), inside=False)), Droplet()
    ) as sim:
        assert sim.state().energy == 0.0

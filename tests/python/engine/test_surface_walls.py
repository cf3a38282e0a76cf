"""Walls of any outline in packings, simulations, files and pictures."""

from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import Droplet, FileError, ParameterError, Ring, SurfaceWall
from lammps_deformable.particles.containers import Distances
from meshes import CROSS, box, closed, turned, write_stl
from programs import output

ROOM = SurfaceWall([(0, 0), (8, 0), (8, 4), (4, 4), (4, 8), (0, 8)], inside=True)  # an L
POST = SurfaceWall(closed(0.7 * CROSS + 2.0))


def in_lammps(folder: Path) -> float:
    """The energy that the saved script finds."""
    lines = output("lmp", "-in", "in.lammps", "-log", "none", cwd=folder).splitlines()
    head = next(n for n, line in enumerate(lines) if line.split()[:1] == ["Step"])
    column = next(
        k for k, word in enumerate(lines[head].split()) if word in ("PotEng", "E_pair", "pe")
    )
    return float(lines[head + 1].split()[column])


def test_room_and_post_in_the_plane(tmp_path: Path) -> None:
    """Their area, a state at rest between them, its file, script and picture."""
    start = ld.bidisperse(30, seed=1).between([ROOM, POST])
    assert start.volume == pytest.approx(48.0 - 0.49 * 3.0, rel=1e-12)
    assert start.periodic == (False, False)
    with ld.Simulation(start.at(0.88).push_off(), Ring(kP=1.0)) as sim:
        state = sim.relax(1e-8)
    assert state.converged
    walls = state.contacts[state.contacts["j"] < 0]
    both = walls[walls["j"] == -1]["i"]
    assert len(both) > len(np.unique(both))  # several contacts with the room, in a corner
    for n in (0, 1):
        force = walls["force_vector"][walls["j"] == -1 - n].sum(axis=0)
        np.testing.assert_allclose(state.wall_forces[n], -force, rtol=0, atol=1e-9)
    state.save(tmp_path)
    with ld.Run(tmp_path).simulation() as sim:
        again = sim.state()
    assert again.packing.walls == state.packing.walls
    assert again.energy == pytest.approx(state.energy, rel=1e-9)
    assert in_lammps(tmp_path) == pytest.approx(state.energy, rel=1e-5)
    frame, obstacles = state.plot().collections[0].get_clip_path(), state.plot().collections[1]
    assert frame is not None
    assert len(obstacles.get_paths()[0].vertices) >= len(CROSS)


def test_box_of_triangles_is_a_box(tmp_path: Path) -> None:
    """Droplets between the same walls twice: jammed, compressed, and at rest."""
    triangles = box((0, 0, 0), (5, 5, 5))
    room = SurfaceWall(
        write_stl(tmp_path / "room.STL", turned(triangles), binary=True), inside=True
    )
    states = []
    for walls in ([room], [ld.BoxWall((5, 5, 5))]):
        start = ld.bidisperse(30, sizes=(0.5, 0.6), dimension=3, seed=1).between(walls).at(0.6)
        assert start.volume == pytest.approx(125 * (start.box[0, 0] / 5) ** 3)
        with ld.Simulation(start.push_off(), Droplet()) as sim:
            states.append(sim.relax(1e-7))
    one, other = states
    assert one.converged
    assert one.energy == pytest.approx(other.energy, rel=1e-9)
    np.testing.assert_allclose(one.positions, other.positions, rtol=0, atol=1e-6)
    assert one.pressure == pytest.approx(other.pressure, rel=1e-6)
    np.testing.assert_allclose(
        np.abs(one.wall_forces[0]), np.abs(other.wall_forces.sum(axis=0)), rtol=0, atol=1e-6
    )
    assert one.plot().figure is not None
    assert len(one.plot(slice=0.5 * one.box[2, 2]).collections) >= 1


@pytest.mark.parametrize("inside", [True, False])
@pytest.mark.parametrize("place", ["face", "edge", "corner"])
def test_a_center_in_the_solid_is_pushed_back(place: str, inside: bool) -> None:
    """Its height is negative, and the direction to the wall that of a center on the other side."""
    low, high = (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)
    room = Distances([SurfaceWall(box(low, high), inside=inside)], 10 * np.eye(3))
    out = {"face": (0, 0, 1), "edge": (0, 1, 1), "corner": (1, 1, 1)}[place]
    part = 0.05 if inside else -0.05
    x = np.where(out, 1 + part * np.array(out), (0.3, -0.2, 0.0))
    _, _, (direction, *_), (height, *_) = room.contacts(x[None], 0.5)
    foot = x + height * direction
    assert height < 0
    if inside or place == "face":  # from within an obstacle the nearest point is on a face
        np.testing.assert_allclose(foot, np.where(out, 1.0, x), rtol=0, atol=1e-12)
    assert np.abs(foot).max() == pytest.approx(1.0, abs=1e-12)


def test_soft_particles_touch_all_parts() -> None:
    """A jammed packing in the L is at rest with its walls: the energy is at a minimum."""
    jammed = ld.jam(ld.bidisperse(30, seed=2).between([ROOM, POST]).at(0.6))
    assert 0.6 < jammed.phi < 0.95
    with ld.Simulation(jammed.packing, ld.SoftContact()) as sim:
        state = sim.relax(1e-6)
    assert state.converged


def test_open_surface_leaves_the_room() -> None:
    """A chain across a box takes no area; particles are on both sides of it."""
    chain = SurfaceWall([(2, 2), (4, 5), (6, 2)])
    start = ld.bidisperse(24, seed=1).between([ld.BoxWall((8, 8)), chain])
    assert start.volume == pytest.approx(64.0)
    state = start.at(0.6).push_off()
    assert len(state.plot().collections[1].get_paths()[0].vertices) in (5, 4)


def test_walls_are_values(tmp_path: Path) -> None:
    assert eval(repr(ROOM)) == ROOM
    assert SurfaceWall(np.array(ROOM.corners), inside=True) == ROOM
    np.savetxt(tmp_path / "chain.csv", ROOM.corners, delimiter=",", header="x,y")
    assert SurfaceWall(tmp_path / "chain.csv", inside=True) == ROOM
    assert SurfaceWall(str(tmp_path / "chain.csv")) != ROOM
    assert (
        len({SurfaceWall(box((0, 0, 0), (1, 1, 1))), SurfaceWall(box((0, 0, 0), (1, 1, 1)))}) == 1
    )


def test_what_is_refused(tmp_path: Path) -> None:
    (tmp_path / "bad.csv").write_text("0 0\n1\n")
    triangles = box((0, 0, 0), (4, 4, 4))
    for make, error, message in (
        (lambda: SurfaceWall([1, 2]), ParameterError, "must be points .* not \\[1, 2\\]"),
        (lambda: SurfaceWall([(0, 0), (0, 0)]), ParameterError, "no length at segment 1"),
        (
            lambda: SurfaceWall(triangles[1:], inside=True),
            ParameterError,
            "a container must be closed",
        ),
        (
            lambda: SurfaceWall(tmp_path / "no.stl"),
            FileError,
            "no.stl', cannot be read: No such file",
        ),
        (lambda: SurfaceWall(tmp_path / "bad.csv"), FileError, "no point x y in line 2"),
        (
            lambda: ld.bidisperse(4).between(
                SurfaceWall([(0, 0), (4, 4), (4, 1), (0, 4)], inside=True)
            ),
            ParameterError,
            "must not cross or touch itself",
        ),
        (
            lambda: ld.bidisperse(4, dimension=3).between(
                [SurfaceWall(triangles, inside=True), ld.Cylinder(1, "z", (2, 2, 0), inside=False)]
            ),
            ParameterError,
            "is not known: let it be the only container",
        ),
        (
            lambda: ld.Simulation(
                ld.Packing([(1.0, 1.0)], 0.2, (9, 9), walls=SurfaceWall(closed(CROSS + 1.0))),
                Ring(),
            ),
            ParameterError,
            "is within surface",
        ),
    ):
        with pytest.raises(error, match=message):
            make()


def test_second_derivatives_are_refused() -> None:
    start = ld.bidisperse(16, seed=1).between(ROOM).at(0.9).push_off()
    with ld.Simulation(start, Ring()) as sim:
        state = sim.relax(1e-8)
    with pytest.raises(ParameterError, match="wall 1 is a SurfaceWall, of which second"):
        state.hessian()

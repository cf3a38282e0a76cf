"""Runs between walls: protocols, files and pictures."""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from exact_balance import exactly_balanced
from lammps_deformable import ParameterError, Plane, PolygonWall, Ring, Segment, Sphere
from lammps_deformable.state.recorded import write_state
from programs import output

from validation.finite_strain import bulk_modulus, shear_modulus

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("agg")

LMP = Path(sys.executable).parent / "lmp"
SCENE = (
    Sphere(6.0, (1.0, -2.0)),
    Sphere(1.0, (3.0, -2.0), inside=False),
    PolygonWall([(-2, -3), (0, -3), (0, -1), (-2, -1)]),
    Segment((0, 1), (1.5, 1)),
)
LAW = Ring(kP=3.0)


@pytest.fixture(scope="module", autouse=True)
def exact_states() -> Iterator[None]:
    """States that are read back agree with the former ones to rounding."""
    with exactly_balanced():
        yield


@pytest.fixture(scope="module")
def jammed() -> ld.Packing:
    return ld.jam(ld.bidisperse(40, seed=2).between(SCENE)).packing


@pytest.fixture(scope="module")
def run(jammed, tmp_path_factory) -> tuple[Path, list[ld.State]]:
    folder = tmp_path_factory.mktemp("run")
    with ld.Simulation(jammed, LAW) as sim:
        states: list[ld.State] = []
        how = {"record": folder, "callback": states.append}
        sim.compress(strain=0.03, steps=3, tolerance=1e-4, **how)
        return folder, states


def test_jammed_disks_touch_walls(jammed) -> None:
    assert 0.6 < jammed.phi < 0.9
    with ld.Simulation(jammed, ld.SoftContact()) as soft:
        state = soft.state()
    assert 1e-6 < state.pressure < 2.1e-6
    touched = {-1 - j for j in state.contacts["j"].tolist() if j < 0}
    assert {0, 2} <= touched
    assert state.rattlers.sum() < 8
    # the pressure is the derivative of the energy by the free area
    energies, areas = [], []
    for factor in (1 - 1e-9, 1 + 1e-9):
        with ld.Simulation(jammed.at(jammed.phi / factor**2), ld.SoftContact()) as soft:
            energies.append(soft.state().energy)
            areas.append(soft.state().packing.volume)
    slope = -np.diff(energies) / np.diff(areas)
    # energies are known to 1e-16 of their terms, which changes the slope by 1e-4
    assert slope == pytest.approx(state.pressure, rel=1e-3)


def test_compression_scales_walls_with_particles(jammed, run) -> None:
    _, states = run
    assert [s.packing.walls[0].radius for s in states] == pytest.approx(
        jammed.walls[0].radius * np.array([0.99, 0.98, 0.97])
    )
    assert (np.diff([s.pressure for s in states]) > 0).all()
    last = states[-1].packing
    assert last.volume / jammed.volume == pytest.approx(0.97**2)
    for wall, first in zip(last.walls, jammed.walls, strict=True):
        assert wall._values == pytest.approx(0.97 * np.array(first._values))


def test_saved_runs_are_read_back(run) -> None:
    """With every digit of the walls; replayed with those of each frame."""
    folder, states = run
    with ld.Run(folder).simulation() as sim:
        again = sim.state()
    assert again.packing.walls == states[-1].packing.walls
    assert again.energy == pytest.approx(states[-1].energy, rel=1e-12)
    replayed = ld.Run(folder)[1:]
    for one, other in zip(replayed, states, strict=True):
        assert one.energy == pytest.approx(other.energy, rel=1e-6)
        assert one.phi == pytest.approx(other.phi, rel=1e-12)
    lines = (folder / "trajectory.lammpstrj").read_text().splitlines()
    bounds = [line for line in lines if line.startswith("ITEM: BOX")]
    assert set(bounds) == {"ITEM: BOX BOUNDS ff ff pp"}


def test_interrupted_runs_are_resumed(run, tmp_path: Path) -> None:
    """From the state after a step, with the same numbers."""
    folder, states = run
    for file in folder.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    middle = states[0]
    summary = json.loads((folder / "summary.json").read_text())
    write_state(middle, tmp_path, summary["parameters"], frames=2)
    rest = ld.Run(tmp_path).resume()[2:]
    assert [state.energy for state in rest] == [state.energy for state in states[1:]]
    for name in ("packing.data", "summary.json", "in.lammps", "trajectory.lammpstrj"):
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes()


def test_lammps_runs_a_saved_state(run) -> None:
    folder, states = run
    lines = output("lmp", "-in", "in.lammps", "-log", "none", cwd=folder).splitlines()
    head = next(n for n, line in enumerate(lines) if line.split()[:2] == ["Step", "PotEng"])
    _, energy, _, pressure = map(float, lines[head + 1].split())
    state = states[-1]
    assert energy == pytest.approx(state.energy, rel=1e-12)
    # LAMMPS divides by the area of its box
    box = np.prod(state.packing.box.diagonal())
    assert pressure * box == pytest.approx(state.pressure * state.packing.volume, rel=1e-12)


@pytest.mark.parametrize("text", ['{"shape": "square"}', "3"])
def test_damaged_walls_in_a_summary(run, tmp_path: Path, text: str) -> None:
    folder, _ = run
    for name in ("packing.data", "summary.json"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    summary = json.loads((folder / "summary.json").read_text())
    summary["walls"] = [json.loads(text)]
    (tmp_path / "summary.json").write_text(json.dumps(summary))
    with pytest.raises(ld.FileError, match="cannot be read"):
        ld.Run(tmp_path).simulation()


def artists(state: ld.State) -> tuple[int, int]:
    """Shapes of obstacles and their corners, and corners of the frame, in a picture."""
    axes = state.plot(forces=True)
    walls = axes.collections[1].get_paths() if state.packing.walls else []
    (frame,) = axes.patches
    return len(walls), len(frame.get_xy())


def test_pictures(run, tmp_path: Path) -> None:
    """Obstacles with their images, within the outline of the container."""
    folder, states = run
    obstacles, corners = artists(states[-1])
    assert obstacles == 3
    assert corners > 1000
    start = ld.bidisperse(20, seed=1).between(Sphere(0.8, (0, 0), inside=False)).push_off()
    with ld.Simulation(start, LAW) as sim:
        assert artists(sim.state()) == (9, 5)
    with ld.Simulation(start.replace(walls=()), LAW) as sim:
        assert artists(sim.state()) == (0, 5)
    ld.Run(folder).movie(tmp_path / "movie.gif")
    assert (tmp_path / "movie.gif").stat().st_size > 10_000


def test_protocols_that_walls_allow_and_refuse() -> None:
    """A channel: it is compressed, and its particles move; it is not sheared."""
    sides = (Plane((0, 1), (0, 1)), Plane((0, 9), (0, -1)))
    start = ld.bidisperse(40, seed=1).between(sides).at(0.87).push_off()
    with ld.Simulation(start, LAW) as sim:
        state = sim.relax(1e-8)
        bulk = bulk_modulus(state, 1e-4)
        assert bulk.linear
        for refused, message in (
            (lambda: sim.shear(0.1)[1:], "walls are not sheared.* a plane"),
            (lambda: shear_modulus(state, 1e-3), "with walls cannot be sheared"),
            (lambda: sim.deform(sim.box @ [[1, 0], [0.1, 1]]), "with walls cannot be sheared"),
        ):
            with pytest.raises(ParameterError, match=message):
                refused()
        # a channel may be stretched in one direction
        sim.deform(sim.box * [[1, 1], [1, 0.999]])
        assert sim.state().pressure_tensor[1, 1] > state.pressure_tensor[1, 1]
        moved = sim.run(200, every=100, temperature=1e-6, seed=1)[1:]
        total = [each.energy + each.kinetic_energy for each in moved]
        assert total[-1] == pytest.approx(total[0], rel=1e-3)
    pillar = start.between((*sides, Sphere(0.1, (4, 4), inside=False)))
    with ld.Simulation(pillar, ld.SoftContact()) as soft:
        with pytest.raises(ParameterError, match="disk 3 must stay round"):
            soft.deform(soft.box * [[1, 1], [1, 0.9]])
        assert soft.walls == pillar.walls

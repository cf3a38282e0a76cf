"""Velocities, time and strain go on: through folders, restarts, replays and further calls."""

import re
from contextlib import nullcontext
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.state.state import State
from protocol_helpers import Stop, stop_after

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture(scope="module")
def packing() -> ld.Packing:
    """Dense, with radii of its own, which other files of LAMMPS have than those of species."""
    return ld.jam(ld.polydisperse(12, np.linspace(0.4, 0.7, 12), seed=2)).packing.at(0.9)


def moved(sim: ld.Simulation, seed: int | None = None) -> State:
    state = sim.run(200, every=100, timestep=0.01, temperature=1e-5, seed=seed)[-1]
    return state


def test_a_loaded_simulation_moves_on(packing: ld.Packing, tmp_path: Path) -> None:
    """As one that was never interrupted, to the rounding of a new neighbor list."""
    with ld.Simulation(packing, ld.Ring()) as sim:
        last = moved(sim, seed=3)
        last.save(tmp_path)
        expected = sim.run(200, every=100, timestep=0.01)[-1]
    assert last.time == pytest.approx(2.0)
    assert expected.time == pytest.approx(4.0)
    with ld.Run(tmp_path).simulation() as again:
        start = again.state()
        assert np.array_equal(start.velocities, last.velocities)
        assert start.velocities.any()
        assert (start.time, start.shear_strain) == (last.time, None)
        found = again.run(200, every=100, timestep=0.01)[-1]
    assert found.time == pytest.approx(4.0, rel=1e-12)
    np.testing.assert_allclose(found.packing.positions, expected.packing.positions, atol=1e-9)
    np.testing.assert_allclose(found.velocities, expected.velocities, rtol=0, atol=1e-9)


def test_lammps_reads_the_velocities(packing: ld.Packing, tmp_path: Path) -> None:
    with ld.Simulation(packing, ld.Ring()) as sim:
        last = moved(sim, seed=3)
    last.save(tmp_path)
    script = (tmp_path / "in.lammps").read_text()
    assert "velocity all create" not in script  # it would draw others
    with ld.Simulation(packing, ld.Ring()) as sim:
        lmp = sim.lmp
        lmp.command("clear")
        style = re.findall(r"^atom_style .*", script, re.MULTILINE)[0]
        boundary = "units lj\ndimension 2\natom_modify map yes\n"
        lmp.commands_string(f"{boundary}{style}\nread_data {tmp_path / 'packing.data'}")
        found = np.array(lmp.gather("v", 1, 3)).reshape(-1, 3)
        lmp.command(f"write_data {tmp_path / 'packing.data'}")  # rounds to 16 digits
    assert np.array_equal(found[:, :2], last.velocities)
    with ld.Run(tmp_path).simulation() as again:
        np.testing.assert_allclose(again.state().velocities, last.velocities, rtol=1e-14)


def test_restart_from_a_state(packing: ld.Packing) -> None:
    with ld.Simulation(packing, ld.Ring()) as sim:
        last = moved(sim, seed=3)
        sim.reset(last)
        again = sim.state()
        assert np.array_equal(again.velocities, last.velocities)
        assert again.time == last.time
        assert moved(sim).time == pytest.approx(4.0)
        sim.reset(last.packing)
        rest = sim.state()
        assert not rest.velocities.any()
        assert (rest.time, rest.shear_strain) == (0.0, None)


def test_time_goes_on_in_a_recorded_run(packing: ld.Packing, tmp_path: Path) -> None:
    """In the series, the Universe, ParaView's file and replays; relaxations take no time."""
    with ld.Simulation(packing, ld.Ring()) as sim:
        sim.run(200, every=100, timestep=0.01, temperature=1e-5, seed=3, record=tmp_path)
    with ld.Run(tmp_path).simulation() as sim:
        sim.run(300, every=100, timestep=0.01, record=tmp_path, mode="a")
        assert sim.relax().time == pytest.approx(5.0)
    expected = pytest.approx([0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    series = np.genfromtxt(tmp_path / "series.csv", delimiter=",", names=True)
    assert series["time"] == expected
    universe = ld.Run(tmp_path).to_mdanalysis()
    assert [frame.time for frame in universe.trajectory] == expected
    assert [state.time for state in ld.Run(tmp_path)] == expected
    ld.Run(tmp_path).export(tmp_path / "run.pvd")
    steps = re.findall('timestep="(.*?)"', (tmp_path / "run.pvd").read_text())
    assert [float(step) for step in steps] == expected


def test_strain_goes_on(tmp_path: Path) -> None:
    packing = ld.jam(ld.bidisperse(12, seed=2)).packing.at(0.9)
    law = ld.Ring()
    with ld.Simulation(packing, law) as sim:
        sim.shear(0.02, steps=2, record=tmp_path)
    with ld.Run(tmp_path).simulation() as sim:
        assert sim.shear_strain == 0.02
        sim.shear(-0.03, steps=3, record=tmp_path, mode="a")
    with ld.Run(tmp_path).simulation() as sim:
        last = sim.compress(strain=0.001)[-1]
        assert last.shear_strain == pytest.approx(-0.01)
    expected = pytest.approx([0.0, 0.01, 0.02, 0.01, 0.0, -0.01], abs=1e-15)
    series = np.genfromtxt(tmp_path / "series.csv", delimiter=",", names=True)
    assert series["shear_strain"] == expected
    assert [state.shear_strain for state in ld.Run(tmp_path)] == expected


def test_interrupted_shear_goes_on_with_its_strain(tmp_path: Path) -> None:
    packing = ld.jam(ld.bidisperse(12, seed=2)).packing.at(0.9)
    whole, cut, ended = tmp_path / "whole", tmp_path / "cut", pytest.raises(Stop)
    for folder in (whole, cut):
        with ld.Simulation(packing, ld.Ring()) as sim:
            sim.shear(0.02, record=folder, steps=2)
        with ld.Run(folder).simulation() as sim, nullcontext() if folder == whole else ended:
            stop = stop_after(1) if folder == cut else None
            sim.shear(0.02, steps=3, record=folder, mode="a", callback=stop)
    ld.Run(cut).resume()
    assert (cut / "series.csv").read_text() == (whole / "series.csv").read_text()
    assert (cut / "packing.data").read_text() == (whole / "packing.data").read_text()


@pytest.mark.parametrize("wrong", ["1 1.0 0.0 0\n", "1 one 0 0\n"])
def test_damaged_velocities(tmp_path: Path, wrong: str) -> None:
    packing = ld.bidisperse(2, phi=0.4, seed=1)
    with ld.Simulation(packing, ld.Ring()) as sim:
        sim.state().save(tmp_path)
    path = tmp_path / "packing.data"
    path.write_text(f"{path.read_text()}\nVelocities\n\n{wrong}")
    with pytest.raises(ld.FileError, match=r"packing\.data cannot be read"):
        ld.Run(tmp_path).simulation()

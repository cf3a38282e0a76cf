"""Recorded runs of droplets in three dimensions: resumed, replayed, and read by other programs."""

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import Droplet, Packing, State
from lammps_deformable.cli.main import app
from lammps_deformable.state.recorded import numbers_of
from protocol_helpers import Stop, stop_after

LAW = Droplet([1.0, 1.5])


@pytest.fixture(scope="module")
def start() -> Packing:
    """In a tilted box, where LAMMPS rounds centers as it wraps them."""
    loose = ld.bidisperse(16, sizes=(1.0, 1.2), dimension=3, tilt=0.3, seed=1)
    return ld.jam(loose, tolerance=1e-2).packing.at(0.68)


@pytest.fixture(scope="module")
def moved(start: Packing, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list]:
    """A run of a bath behind a shear, and its states."""
    folder = tmp_path_factory.mktemp("moved") / "run"
    with ld.Simulation(start, LAW) as sim:
        states = [replace(sim.state(), shear_strain=0.0)]
        sim.shear(0.02, steps=2, tolerance=1e-4, record=folder, callback=states.append)
        bath = {"temperature": 1e-3, "drag": 0.5, "every": 20, "seed": 3}
        sim.run(40, **bath, record=folder, mode="a", callback=states.append)
    return folder, states


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def compressed(**target: float) -> Callable[..., ld.Run]:
    return lambda sim, **how: sim.compress(steps=3, **target, **how)


PROTOCOLS = {
    "pressure": compressed(pressure=0.1),
    # through a flip of the box
    "shear": lambda sim, **how: sim.shear(0.4, steps=3, **how),
    "bath": lambda sim, **how: sim.run(90, every=30, temperature=1e-3, drag=0.5, seed=3, **how),
}


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_resumed_runs_are_those_that_were_not_interrupted(
    protocol: str, start: Packing, tmp_path: Path
) -> None:
    """Byte for byte."""
    with ld.Simulation(start, LAW) as sim:
        PROTOCOLS[protocol](sim, record=tmp_path / "whole")
    with ld.Simulation(start, LAW) as sim, pytest.raises(Stop):
        PROTOCOLS[protocol](sim, record=tmp_path / "broken", callback=stop_after(1))
    broken = ld.Run(tmp_path / "broken")
    assert len(broken) == 2
    assert len(broken.resume()) == 4
    assert contents(tmp_path / "broken") == contents(tmp_path / "whole")


def test_runs_go_on(start: Packing, tmp_path: Path) -> None:
    """With another protocol, which is interrupted too."""
    for name, stop in (("whole", 0), ("broken", 1)):
        with ld.Simulation(start, LAW) as sim:
            sim.compress(record=tmp_path / name, strain=0.01, tolerance=1e-4)
        with ld.Run(tmp_path / name).simulation() as sim:
            how = {
                "record": tmp_path / name,
                "mode": "a",
                "callback": stop_after(stop) if stop else None,
            }
            with pytest.raises(Stop) if stop else nullcontext():
                sim.shear(0.02, steps=2, tolerance=1e-4, **how)
    ld.Run(tmp_path / "broken").resume()
    assert contents(tmp_path / "broken") == contents(tmp_path / "whole")


def test_replayed_states(moved: tuple[Path, list]) -> None:
    """Evaluated again from all digits; forces are balanced to 1e-8."""
    folder, states = moved
    run = ld.Run(folder)
    assert len(run) == len(states) == 5
    for again, state in zip(run, states, strict=True):
        assert isinstance(again, State)
        assert again.law == LAW
        # LAMMPS rounds centers as it wraps them
        assert again.packing.positions == pytest.approx(state.packing.positions, abs=1e-14)
        assert np.array_equal(again.packing.box, state.packing.box)
        assert np.array_equal(again.velocities, state.velocities)
        assert (again.time, again.shear_strain) == (state.time, state.shear_strain)
        assert again.energy == pytest.approx(state.energy, rel=1e-9)
        assert again.loads == pytest.approx(state.loads, rel=1e-6)
        assert len(again.contacts) == len(state.contacts)
    assert run[-1].time > 0.0
    assert run[-1].temperature == states[-1].temperature > 0.0
    assert [state.shear_strain for state in run[1:3]] == [0.01, 0.02]


def test_tables_and_shapes(moved: tuple[Path, list], tmp_path: Path) -> None:
    pytest.importorskip("pandas")
    folder, states = moved
    run = ld.Run(folder)
    table = run.table(largest=lambda state: state.loads.max())
    for name in ("lz", "yz", "phi", "pressure", "shear_stress", "load", "temperature", "time"):
        numbers = [numbers_of(state)[name] for state in states]
        assert table[name].tolist() == pytest.approx(numbers, rel=1e-6)
    assert table["largest"].tolist() == pytest.approx([state.loads.max() for state in states], 1e-6)
    run.export(tmp_path / "run.pvd")
    run.export(tmp_path / "network.pvd", forces=True)
    assert len(list(tmp_path.glob("*.vtp"))) == 10


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_mdanalysis_reads_runs(moved: tuple[Path, list]) -> None:
    """A frame is `to_mdanalysis` of its state; `time` is that of the frame's number."""
    pytest.importorskip("MDAnalysis")
    folder, states = moved
    universe = ld.Run(folder).to_mdanalysis()
    assert universe.atoms.radii == pytest.approx(states[0].packing.radii)
    for frame, state in zip(universe.trajectory, states, strict=True):
        expected = state.to_mdanalysis().trajectory.ts
        assert frame.dimensions == pytest.approx(expected.dimensions, rel=1e-6)
        assert frame.positions == pytest.approx(expected.positions, abs=1e-5)
        assert frame.velocities == pytest.approx(expected.velocities, abs=1e-7)
        for name in ("load", "surface_area", "contacts"):
            assert frame.data[name] == pytest.approx(state._values(name), rel=1e-6)


def test_the_shell_keeps_runs_of_droplets(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its runs are resumed, gone on with, sheared and drawn."""
    monkeypatch.chdir(tmp_path)

    def shell(line: str) -> None:
        app(line.split(), standalone_mode=False)

    begun = "compress --law droplet --number 8 --strain 0.01 --tolerance 1e-4 --out"
    shell(f"{begun} whole --steps 2")
    assert Path("whole", "packing.png").exists()
    monkeypatch.setattr("lammps_deformable.cli.main._finish", lambda *_: None)  # takes seconds
    run = ld.Run("whole")
    assert len(run) == 3
    assert run[-1].law == Droplet()
    assert run.parameters["dimension"] == 3
    shell("compress --out whole --resume --dimension 3 --tension 1.0")  # nothing is left to do
    with pytest.raises(ld.ParameterError, match="begun with --dimension 3, not 2"):
        shell("compress --out whole --resume --dimension 2")
    shell("compress --out whole --append --strain 0.01 --steps 1 --tolerance 1e-4")
    assert len(run) == 4
    shell("plot whole --frame 1 --color-by load --slice 1 --out frame.png")
    shell("movie whole --slice 1 --out movie.gif")
    shell("shear whole --strain 0.01 --steps 1 --tolerance 1e-4 --out sheared")
    (before, after) = ld.Run("sheared")
    assert (before.shear_strain, after.shear_strain) == (0.0, 0.01)
    assert {"frame.png", "movie.gif"} <= {path.name for path in tmp_path.iterdir()}


def test_runs_keep_their_walls(tmp_path: Path) -> None:
    """Which are scaled with the box in each step."""
    walls = ld.BoxWall((6.0, 5.0, 5.0)).parts[:4]  # periodic along z
    loose = ld.bidisperse(12, sizes=(1.0, 1.2), dimension=3, seed=2)
    packing = loose.between(walls).at(0.6).push_off()
    for name, stop in (("whole", None), ("broken", stop_after(1))):
        states: list[State] = []
        with ld.Simulation(packing, LAW) as sim, pytest.raises(Stop) if stop else nullcontext():
            how = {"record": tmp_path / name, "callback": stop or states.append}
            sim.compress(strain=0.02, steps=2, tolerance=1e-4, **how)
        if not stop:
            whole = states
    states = whole
    ld.Run(tmp_path / "broken").resume()
    assert contents(tmp_path / "broken") == contents(tmp_path / "whole")
    again = ld.Run(tmp_path / "whole")[1]
    assert again.packing.walls == states[0].packing.walls != packing.walls
    assert again.wall_forces == pytest.approx(states[0].wall_forces, rel=1e-6, abs=1e-9)
    assert again.phi == pytest.approx(states[0].phi, rel=1e-14)

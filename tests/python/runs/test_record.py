"""Recorded runs: states have what was written, simulations go on, other programs read them."""

import csv
import json
import math
import pickle
from dataclasses import replace
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from programs import program
from protocol_helpers import written


@pytest.mark.parametrize(
    "law",
    [
        ld.Sector(kP=2.0),
        ld.Ring(kA=(2.0, float("inf")), kP=(float("inf"), 3.0), skin=0.05),
    ],
)
def test_tilted_packings_and_species_go_on(law: ld.Sector | ld.Ring, tmp_path: Path) -> None:
    jammed = ld.jam(ld.bidisperse(12, aspect=1.3, tilt=-0.4, seed=2)).packing
    with ld.Simulation(jammed.at(0.86), law) as sim:
        state = sim.state()
    state.save(tmp_path)
    with ld.Run(tmp_path).simulation() as sim:
        assert sim.law == law
        assert sim.state().energy == pytest.approx(state.energy, rel=1e-12)


def test_a_run_is_written_as_it_goes(jammed: ld.Packing, tmp_path: Path) -> None:
    seen: list[dict[str, str]] = []

    def read(_: ld.State) -> None:
        with (tmp_path / "series.csv").open() as file:
            seen.append(list(csv.DictReader(file))[-1])

    with ld.Simulation(jammed, ld.Ring()) as sim:
        run = sim.compress(strain=0.02, steps=2, record=tmp_path, callback=read)
        assert [float(row["phi"]) for row in seen] == [state.phi for state in run[1:]]
    with ld.Run(tmp_path).simulation() as sim:
        start, third = sim.run(1, record=tmp_path, mode="a", parameters={"note": "slow"})
    assert start.energy == run[2].energy
    with (tmp_path / "series.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [int(row["frame"]) for row in rows] == [0, 1, 2, 3]
    assert float(rows[3]["energy"]) == third.energy
    parameters = json.loads((tmp_path / "summary.json").read_text())["parameters"]
    assert (parameters["note"], parameters["protocol"]) == ("slow", "run")
    assert parameters["before"]["strain"] == 0.02
    assert (tmp_path / "trajectory.lammpstrj").read_text().count("ITEM: TIMESTEP") == 4


def test_states_have_what_was_recorded(jammed: ld.Packing, tmp_path: Path) -> None:
    """Without an evaluation: contacts are balanced to 1e-8 only. What was not is evaluated."""
    seen: list[ld.State] = []
    with ld.Simulation(jammed, ld.Ring()) as sim:
        run = sim.compress(strain=0.02, steps=2, record=tmp_path, callback=seen.append)
    for found, state in zip(run[1:], seen, strict=True):
        for name in ("energy", "pressure", "shear_stress", "residual", "phi", "converged"):
            assert getattr(found, name) == getattr(state, name)
        for name in ("volumes", "perimeters", "pressures", "n_contacts", "pressure_tensor"):
            assert np.array_equal(getattr(found, name), getattr(state, name)), name
        assert found._table is None
        assert found.coordination == state.coordination
        force = state.contacts["force"]
        assert found.contacts["force"] == pytest.approx(force, abs=1e-7 * force.max())
        assert found.energy == state.energy
        assert not hasattr(found, "loads")
    copy = pickle.loads(pickle.dumps(run[1]))
    assert np.array_equal(copy.rattlers, seen[0].rattlers)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_mdanalysis_reads_the_trajectory(tmp_path: Path) -> None:
    mdanalysis = pytest.importorskip("MDAnalysis")
    jammed = ld.jam(ld.bidisperse(16, tilt=-0.3, seed=4)).packing
    with ld.Simulation(jammed, ld.Ring()) as sim:
        states = sim.compress(strain=0.02, steps=2, record=tmp_path)
    universe = mdanalysis.Universe(
        str(tmp_path / "trajectory.lammpstrj"), format="LAMMPSDUMP", additional_columns=True, dt=1.0
    )
    assert len(universe.trajectory) == 3
    for frame, state in zip(universe.trajectory, states, strict=True):
        assert frame.data["area"] == pytest.approx(state.results["area"])
        assert frame.data["pressure"] == pytest.approx(state.pressures, rel=1e-5)
        assert frame.data["contacts"] == pytest.approx(state.n_contacts)
        assert frame.data["radius"] == pytest.approx(state.packing.radii)
        assert frame.positions[:, :2] == pytest.approx(state.packing.positions, abs=1e-5)
        (lx, _), (xy, ly) = state.packing.box
        vectors = frame.triclinic_dimensions[:2, :2]
        assert vectors == pytest.approx(np.array([[lx, 0.0], [xy, ly]]), rel=1e-5)


def test_shear_stress_of_a_series_resists(tmp_path: Path) -> None:
    """It is positive after the upper side has moved along x."""
    jammed = ld.jam(ld.bidisperse(16, seed=1)).packing
    with ld.Simulation(jammed.at(jammed.phi + 0.03), ld.Ring()) as sim:
        start = sim.relax()
        states = [start, *sim.shear(1e-3, steps=2, record=tmp_path / "run")[1:]]
    with (tmp_path / "run" / "series.csv").open(newline="") as file:
        stress = [float(row["shear_stress"]) for row in csv.DictReader(file)]
    assert stress == pytest.approx([-state.pressure_tensor[0, 1] for state in states], rel=1e-6)
    assert [state.shear_stress for state in states] == [
        -state.pressure_tensor[0, 1] for state in states
    ]
    assert stress[2] > stress[1] > stress[0]


def test_append_cuts_off_half_a_frame(jammed: ld.Packing, tmp_path: Path) -> None:
    with ld.Simulation(jammed, ld.Ring()) as sim:
        sim.compress(strain=0.01, record=tmp_path)
        trajectory = tmp_path / "trajectory.lammpstrj"
        whole = trajectory.read_text()
        trajectory.write_text(whole + whole[: len(whole) // 2])  # killed in the third frame
        assert len(ld.Run(tmp_path)) == 2
        sim.compress(strain=0.01, record=tmp_path, mode="a")
    text = trajectory.read_text()
    assert text.startswith(whole)
    assert text.count("ITEM: TIMESTEP") == 3
    assert 2 * len(text.splitlines()) == 3 * len(whole.splitlines())


def test_append_without_a_summary_is_refused(state: ld.State, tmp_path: Path) -> None:
    written([state], tmp_path)
    (tmp_path / "summary.json").unlink()
    with (
        ld.Simulation(state, state.law) as sim,
        pytest.raises(ld.FileError, match=r"summary\.json is missing"),
    ):
        sim.compress(strain=0.01, record=tmp_path, mode="a")


def test_a_row_stands_for_a_whole_frame(
    jammed: ld.Packing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The series does not count a frame that was not written completely."""

    def killed(*_: object) -> str:
        raise KeyboardInterrupt

    def next_is_killed(_: ld.State) -> None:
        monkeypatch.setattr("lammps_deformable.formats.store._dump_frame", killed)

    with ld.Simulation(jammed, ld.Ring()) as sim, pytest.raises(KeyboardInterrupt):
        sim.compress(strain=0.01, steps=2, record=tmp_path, callback=next_is_killed)
    with (tmp_path / "series.csv").open(newline="") as file:
        assert len(list(csv.DictReader(file))) == 2


@pytest.mark.parametrize(("left", "whole"), [(0.0, 0), (0.6, 1)])
def test_nothing_is_added_to_a_broken_trajectory(
    left: float, whole: int, state: ld.State, tmp_path: Path
) -> None:
    written([state, state], tmp_path)
    trajectory = tmp_path / "trajectory.lammpstrj"
    text = trajectory.read_text()
    cut = text[: int(left * len(text))]
    if cut:
        trajectory.write_text(cut)
    else:
        trajectory.unlink()
    message = rf"trajectory\.lammpstrj lacks frame {whole} of 2 recorded frames"
    with ld.Simulation(state, state.law) as sim, pytest.raises(ld.FileError, match=message):
        sim.compress(strain=0.01, record=tmp_path, mode="a")
    assert (trajectory.read_text() if cut else "") == cut
    assert len((tmp_path / "series.csv").read_text().splitlines()) == 3


def test_a_foreign_series_is_not_overwritten(state: ld.State, tmp_path: Path) -> None:
    (tmp_path / "series.csv").write_text("year,price\n1999,3\n")
    with ld.Simulation(state, state.law) as sim:
        for mode in "wa":
            with pytest.raises(ld.FileError, match=r"series\.csv is no series of states"):
                sim.compress(strain=0.01, record=tmp_path, mode=mode)
    assert "1999" in (tmp_path / "series.csv").read_text()


@pytest.mark.filterwarnings("ignore::lammps_deformable.StalledWarning")
def test_a_stalled_state_comes_back_stalled(jammed: ld.Packing, tmp_path: Path) -> None:
    with ld.Simulation(jammed.at(0.87), ld.Ring()) as sim:
        good, bad = sim.relax(), replace(sim.state(), converged=False)
        written([good, bad, good, bad], tmp_path / "run")
        bad.save(tmp_path / "saved")
    assert [(not state.converged) for state in ld.Run(tmp_path / "run")] == [False, True] * 2
    assert not ld.Run(tmp_path / "run")[-1].converged
    for name in ("run", "saved"):
        with pytest.warns(ld.StalledWarning, match=f"{name}' had stalled, at a residual"):
            ld.Run(tmp_path / name).simulation().close()


def test_parameters_come_back(state: ld.State, tmp_path: Path) -> None:
    """With their types; `test_strict_json` has more of them."""
    given = {"seed": np.int64(3), "kP": [math.inf, 1.0], "word": "inf", "none": None, "half": 0.5}
    state.save(tmp_path / "saved", given)
    with ld.Simulation(state, state.law) as sim:
        sim.compress(strain=0.01, record=tmp_path / "run", parameters=given)
    kept = given | {"seed": 3}
    assert ld.Run(tmp_path / "saved").parameters == kept
    found = ld.Run(tmp_path / "run").parameters
    assert {name: found[name] for name in kept} == kept
    for name in ("saved/summary.json", "run/summary.json"):
        json.loads((tmp_path / name).read_text(), parse_constant=lambda word: pytest.fail(word))


@pytest.mark.parametrize("damage", ["seed", {"a": {"word": 3}}])
def test_damaged_parameters(damage: object, state: ld.State, tmp_path: Path) -> None:
    state.save(tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    (tmp_path / "summary.json").write_text(json.dumps(summary | {"parameters": damage}))
    with pytest.raises(ld.FileError, match=r"summary\.json cannot be read"):
        _ = ld.Run(tmp_path).parameters


def test_a_run_goes_on_to_another_target(jammed: ld.Packing, tmp_path: Path) -> None:
    sim = ld.Simulation(jammed, ld.Ring())
    run = sim.compress(record=tmp_path, phi=0.86)
    before = len(run)
    sim = run.simulation()
    further = sim.compress(pressure=1e-3, steps=2, record=tmp_path, mode="a")
    assert further[-1].pressure == pytest.approx(1e-3, rel=1e-6)
    run = ld.Run(tmp_path)
    assert len(run) == before + 2
    assert run.parameters["pressure"] == 1e-3
    assert run.parameters["before"]["phi"] == 0.86
    with pytest.raises(ld.ParameterError, match="give one of strain, phi, pressure"):
        sim.compress(strain=0.01, phi=0.9, record=tmp_path, mode="a")
    same = sim.compress(pressure=1e-3, record=tmp_path, mode="a")
    assert (len(run), len(same)) == (before + 2, 1)
    assert len(run.resume()) == before + 2


@pytest.mark.parametrize("own", [False, True], ids=["species", "own radii"])
def test_soft_contacts(own: bool, tmp_path: Path) -> None:
    """Frames have what was computed, and LAMMPS finds the same stress by itself."""
    sizes = np.linspace(0.4, 0.6, 16) if own else [0.5, 0.6] * 8
    start = ld.jam(ld.polydisperse(16, sizes, phi=0.3, seed=2)).packing
    law = ld.SoftContact(k=2.0)
    with ld.Simulation(start, law) as sim:
        run = sim.compress(strain=0.02, steps=2, record=tmp_path / "run")
        state = sim.state()
    last = ld.Run(tmp_path / "run")[-1]
    assert (len(run), last.law) == (3, law)
    assert last.pressure == pytest.approx(state.pressure, rel=1e-12)
    assert last.forces == pytest.approx(state.forces, abs=1e-9)
    assert np.array_equal(last.n_contacts, state.n_contacts)
    assert ld.Run(tmp_path / "run").simulation().state().energy == pytest.approx(state.energy)
    done = program("lmp", "-in", "in.lammps", "-log", "none", cwd=tmp_path / "run")
    *_, pressure = done.stdout.partition(" Press")[2].splitlines()[1].split()
    assert float(pressure) == pytest.approx(state.pressure, rel=1e-9)

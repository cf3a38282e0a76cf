"""A slice of a run is one everywhere, and a folder stays where it was."""

import os
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> ld.Run:
    """Of a shear, in which contacts change."""
    folder = tmp_path_factory.mktemp("runs") / "run"
    with ld.Simulation(ld.jam(ld.bidisperse(16, seed=3)), ld.Ring()) as sim:
        return sim.shear(0.4, steps=5, record=folder)


@pytest.fixture(params=["folder", "memory"])
def either(request: pytest.FixtureRequest, run: ld.Run) -> ld.Run:
    return run if request.param == "folder" else ld.Run(list(run))


@pytest.mark.parametrize("part", [slice(3, 6), slice(None, None, 2), slice(None, None, -1)])
def test_numbers_are_those_of_the_run(either: ld.Run, part: slice) -> None:
    some, whole = either[part], either.table()
    for name, column in some.table().items():
        assert column.dtype == whole[name].dtype
        np.testing.assert_array_equal(column, whole[name][part])
    frames = whole["frame"][part]
    found = some.events()["frame"]
    assert len(found)
    assert np.isin(found, frames[1:]).all()  # those of the later state
    assert [state in some for state in either] == np.isin(whole["frame"], frames).tolist()
    assert [some.index(some[n]) for n in range(len(some))] == list(range(len(some)))
    assert some.count(either[3]) == (3 in frames)
    assert some[1:][0] in some


def test_a_state_that_is_not_there(run: ld.Run) -> None:
    with pytest.raises(ValueError, match="is no state of Run"):
        run[:2].index(run[4])
    assert "a word" not in run


def test_a_slice_says_what_it_is(run: ld.Run) -> None:
    name = f"Run({str(run.folder)!r})"
    assert repr(run[1:3]) == f"{name}[1:3]"
    assert repr(run[::2]) == f"{name}[0:6:2]"
    assert repr(run[::-1]) == f"{name}[5::-1]"
    for part in (run[1:3], run[::2], run[::-1]):
        again = eval(repr(part), {"Run": ld.Run})
        assert [state.energy for state in again] == [state.energy for state in part]


def test_a_slice_without_states_has_types(run: ld.Run) -> None:
    none, whole = run[0:0], run.table(most=lambda state: state.pressures.max())
    table = none.table(most=lambda state: state.pressures.max())
    assert {name: column.dtype for name, column in table.items()} == {
        name: column.dtype for name, column in whole.items()
    }
    events, some = none.events(), run.events()
    assert len(events["event"]) == 0
    assert {name: column.dtype for name, column in events.items()} == {
        name: column.dtype for name, column in some.items()
    }
    assert run[0].radii[events["i"]].size == 0


def test_mdanalysis_and_files_have_the_slice(run: ld.Run, tmp_path: Path) -> None:
    trajectory = run[1:5:2].to_mdanalysis().trajectory
    assert [frame.data["step"] for frame in trajectory] == [1, 3]
    assert trajectory[1].positions[:, :2] == pytest.approx(run[3].positions, abs=1e-5)
    run[1:5:2].export(tmp_path / "shapes.pvd")
    assert sorted(os.listdir(tmp_path)) == ["shapes.pvd", "shapes_0001.vtp", "shapes_0003.vtp"]


def test_a_run_that_is_turned_round_has_times() -> None:
    with ld.Simulation(ld.bidisperse(8, phi=0.5, seed=1).push_off(), ld.Ring()) as sim:
        run = sim.run(40, every=10, temperature=1e-6, timestep=0.1, seed=1)
    for one, other in zip(run.msd(), run[::-1].msd(), strict=True):
        assert one == pytest.approx(other)


def test_resume_gives_the_whole_run(run: ld.Run) -> None:
    assert len(run[1:3].resume()) == len(run)


def test_states_of_several_laws_share_a_table() -> None:
    jammed = ld.jam(ld.bidisperse(8, seed=1))
    with ld.Simulation(jammed, ld.Ring()) as sim:
        rings = sim.state()
    for states in ([jammed, rings], [rings, jammed]):
        shapes = ld.Run(states).table()["shape_parameter"]
        assert np.isnan(shapes).tolist() == [states[0] is jammed, states[1] is jammed]
    with pytest.raises(ld.ParameterError, match="a state of a table must be of the kind State"):
        ld.Run([1, 2]).table()


def test_a_folder_stays_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where a callback goes elsewhere."""
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(tmp_path)
    with ld.Simulation(ld.jam(ld.bidisperse(8, seed=1)), ld.Ring()) as sim:
        run = sim.compress(
            strain=0.01, steps=2, record="run", callback=lambda _: os.chdir(elsewhere)
        )
    assert (len(run), run.folder) == (3, tmp_path / "run")
    assert os.listdir(elsewhere) == []
    monkeypatch.setenv("HOME", str(tmp_path))
    assert ld.Run.exists("~/run")
    assert ld.Run("~/run")[-1] in run
    run[-1].save("~/state")
    run[-1].packing.export("~/packing.data")
    assert len(ld.Packing.from_file("~/packing.data")) == 8
    read = ld.State.from_file("~/run/trajectory.lammpstrj", "~/run/species.deformable")
    assert (len(read), read.dimension, read.walls) == (8, 2, ())
    assert np.array_equal(read.species, run[-1].species)
    assert os.listdir(elsewhere) == []


def test_a_movie_replaces_no_file(run: ld.Run, tmp_path: Path) -> None:
    path = tmp_path / "run.gif"
    path.write_text("precious")
    with pytest.raises(ld.FileError, match="is there already"):
        run[:1].movie(path)
    assert path.read_text() == "precious"
    run[:1].movie(path, mode="w")
    assert path.stat().st_size > 1000


def test_a_part_is_saved_as_a_run(either: ld.Run, tmp_path: Path) -> None:
    part = either[4:1:-1]
    saved = part.save(tmp_path / "part")
    assert len(saved) == 3
    assert [state in part for state in saved] == [True] * 3
    for name, column in saved.table().items():
        if name != "frame":
            np.testing.assert_array_equal(column, part.table()[name])
    told = part.parameters
    told.pop("start", None)
    assert saved.parameters == told
    assert saved.steps_done is None
    with saved.simulation() as sim:  # it goes on from the last state
        assert sim.packing.positions == pytest.approx(either[2].positions, rel=1e-12)
    with pytest.raises(ld.FileError, match=r"replace it with save\('.*part', mode='w'\)"):
        part.save(tmp_path / "part")
    assert len(part[:1].save(tmp_path / "part", mode="w")) == 1
    with pytest.raises(ld.ParameterError, match="over itself"):
        ld.Run(tmp_path / "part").save(tmp_path / "part", mode="w")
    with pytest.raises(ld.ParameterError, match="no states to save"):
        part[:0].save(tmp_path / "none")
    assert not (tmp_path / "none").exists()

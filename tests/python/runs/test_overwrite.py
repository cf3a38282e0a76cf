"""No writer replaces what is there unless it is asked to, and then nothing of it stays."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import pytest

S = ld.State
Writer = Callable[..., Any]

# In a folder of its own, whose name is also that of the run: what writes there.
RUNS: dict[str, Callable[[S, Path], Writer]] = {
    "save": lambda state, folder: lambda mode="x": state.save(folder, mode=mode),
    "compress": lambda state, folder: (
        lambda mode="x": sim(state).compress(record=folder, strain=0.01, mode=mode)
    ),
}
FILES: dict[str, Callable[[S, Path], Writer]] = {
    "a.vtp": lambda state, path: lambda mode="x": state.export(path, mode=mode),
    "a.pvd": lambda state, path: lambda mode="x": ld.Run([state]).export(path, False, mode),
    "a.gsd": lambda state, path: lambda **how: state.packing.export(path, **how),
    "a.data": lambda state, path: lambda **how: state.packing.export(path, **how),
}


def sim(state: S) -> Any:
    return ld.Simulation(state, state.law)


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize(("before", "name"), [("save", "compress"), ("compress", "save")])
def test_a_run_is_replaced_as_a_whole(name: str, before: str, state: S, tmp_path: Path) -> None:
    RUNS[before](state, tmp_path / "run")()
    write, kept = RUNS[name](state, tmp_path / "run"), contents(tmp_path)
    told = r"\A'[^\n]*run' holds a run: [^\n]*replace it with [^\n]*, or name another folder\Z"
    with pytest.raises(ld.FileError, match=told):
        write()
    assert contents(tmp_path) == kept
    write(mode="w")
    RUNS[name](state, tmp_path / "fresh")()
    replaced, fresh = (
        {path.name: path for path in folder.iterdir()}
        for folder in (tmp_path / "run", tmp_path / "fresh")
    )
    assert replaced.keys() == fresh.keys()
    for file, path in fresh.items():
        assert replaced[file].read_bytes() == path.read_bytes(), file
    run = ld.Run(tmp_path / "run")
    assert len(run) == {"save": 0}.get(name, 2)
    if len(run):
        # LAMMPS rounds centers as it wraps them
        found = run.simulation().state().packing.positions
        assert run[-1].packing.positions == pytest.approx(found, abs=1e-14)


@pytest.mark.parametrize(("name", "file"), [("save", "in.lammps"), ("compress", "setups.jsonl")])
def test_a_file_of_the_same_name(name: str, file: str, state: S, tmp_path: Path) -> None:
    """Such as the user's own script, in a folder without a run."""
    (tmp_path / file).write_text("mine")
    write = RUNS[name](state, tmp_path)
    with pytest.raises(ld.FileError, match=f"{file}' is there already: "):
        write()
    assert {path.name for path in tmp_path.iterdir()} == {file}
    assert (tmp_path / file).read_text() == "mine"


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_not_replaced(name: str, state: S, tmp_path: Path) -> None:
    write = FILES[name](state, tmp_path / name)
    write()
    kept = contents(tmp_path)
    told = rf"\A'[^\n]*{name}' is there already: [^\n]*replace it [^\n]*, or give "
    with pytest.raises(ld.FileError, match=told):
        write()
    assert contents(tmp_path) == kept
    (tmp_path / name).write_text("old")
    write(mode="w")
    assert contents(tmp_path).keys() == kept.keys()
    assert name == "a.gsd" or contents(tmp_path) == kept


def test_a_part_of_a_series_is_not_replaced(state: S, tmp_path: Path) -> None:
    (tmp_path / "a_0000.vtp").write_text("mine")
    with pytest.raises(ld.FileError, match=r"a_0000\.vtp' is there already"):
        ld.Run([state]).export(tmp_path / "a.pvd")
    assert (tmp_path / "a_0000.vtp").read_text() == "mine"

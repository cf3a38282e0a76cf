"""One at a time writes a run; whoever comes second is told so, and the run stays as it is."""

from pathlib import Path
from typing import Any

import lammps_deformable as ld
import pytest
from lammps_deformable.common import files
from protocol_helpers import Stop, stop_after
from refusals import refused

BUSY = r"\Athe run in '.*run' is being written, by another process or simulation: wait for it, "


def compress(state: ld.State, folder: Path, callback: Any = None, mode: str = "x") -> None:
    with ld.Simulation(state, state.law) as sim:
        sim.compress(strain=0.01, steps=3, record=folder, callback=callback, mode=mode)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_a_run_that_is_being_written_is_left_alone(state: ld.State, tmp_path: Path) -> None:
    compress(state, tmp_path / "alone" / "run")
    seen = []

    def intrude(_: ld.State) -> None:
        with refused(BUSY, ld.FileError):
            compress(state, tmp_path / "run", mode="w")
        if len(seen) < 2:  # the last step is on the disk by now
            with refused(BUSY, ld.FileError):
                ld.Run(tmp_path / "run").resume()
        seen.append(1)

    compress(state, tmp_path / "run", intrude)
    assert len(seen) == 3
    assert contents(tmp_path / "run") == contents(tmp_path / "alone" / "run")


def test_a_resumed_run_is_left_alone(state: ld.State, tmp_path: Path) -> None:
    run = tmp_path / "run"
    with pytest.raises(Stop):
        compress(state, run, stop_after(1))

    def intrude(state: ld.State) -> bool:
        with refused(BUSY, ld.FileError):
            ld.Run(run).resume()
        return True  # so that the run ends here

    ld.Run(run).resume(callback=intrude)
    assert len(ld.Run(run)) == 3


@pytest.mark.parametrize("mode", ["x", "a"])
def test_what_came_between_is_noticed(
    mode: str, state: ld.State, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another process ends its run between the look at the folder and the lock."""
    run, whole = tmp_path / "run", files.make_folder
    if mode == "a":
        compress(state, run)

    def late(folder: Path) -> Path:
        monkeypatch.undo()
        compress(state, run, mode=mode)
        return whole(folder)

    monkeypatch.setattr(files, "make_folder", late)
    told = {"x": "' holds a run: ", "a": "another process has gone on with the run in '.*run' "}
    with refused(told[mode], ld.FileError):
        compress(state, run, mode=mode)
    assert len(ld.Run(run)) == {"x": 4, "a": 7}[mode]


def test_a_lock_is_not_needed(
    state: ld.State, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on file systems that have none."""

    def no_locks(*_: int) -> None:
        raise OSError(38, "Function not implemented")

    monkeypatch.setattr("fcntl.flock", no_locks)
    compress(state, tmp_path / "run")
    assert len(ld.Run(tmp_path / "run")) == 4

"""Independent calls in several processes, and their results after an interruption."""

import math
import os
import re
import threading
import warnings
from pathlib import Path

import pytest
from lammps_deformable import ParameterError, __version__
from lammps_deformable.cli import main as cli
from lammps_deformable.parallel import call_once, parallel_map
from lammps_deformable.versions import machine

from validation.report.paper import regular, ring_in_walls, squeeze


def test_results_keep_their_order() -> None:
    assert parallel_map(math.sqrt, [(n * n,) for n in range(20)], workers=2) == list(range(20))
    assert parallel_map(math.sqrt, [(4.0,)]) == [2.0]
    assert parallel_map(math.sqrt, []) == []
    squares = (n * n for n in range(3))
    assert parallel_map(math.sqrt, zip(squares), workers=2) == [0, 1, 2]


def test_processes_run_lammps_and_use_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    run = (regular(4), [0.02], ring_in_walls(24, 100.0), False)
    here = squeeze(*run)[0]
    for [there] in parallel_map(squeeze, [run, run], workers=2):
        assert there.shape_error("ring") == here.shape_error("ring")
    assert set(parallel_map(os.getenv, [("OMP_NUM_THREADS",)] * 2, workers=2)) == {"1"}
    assert os.environ["OMP_NUM_THREADS"] == "7"
    assert os.getpid() not in parallel_map(os.getpid, [()] * 2, workers=2)


def test_one_worker_is_this_process() -> None:
    assert parallel_map(os.getpid, [()] * 2, workers=1) == [os.getpid()] * 2


@pytest.mark.parametrize("workers", [1, 2])
def test_errors_come_through(workers: int) -> None:
    with pytest.raises(ValueError, match="math domain error"):
        parallel_map(math.sqrt, [(1.0,), (-1.0,), (4.0,)], workers)


def test_no_more_processes_than_cores_that_may_be_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {3})
    assert parallel_map(os.getpid, [()] * 2) == [os.getpid()] * 2
    assert machine()["cores"] == 1


def test_a_process_that_dies_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(cli, "app", lambda: parallel_map(os._exit, [(1,)] * 2, workers=2))
    monkeypatch.setattr(warnings, "showwarning", warnings.showwarning)  # main replaces it
    with warnings.catch_warnings(), pytest.raises(SystemExit):
        cli.main()
    last = capsys.readouterr().err.splitlines()[-1]
    assert re.match(r"error: a process of _exit died, EXIT\(1\).*: it crashed, or was killed", last)


def test_no_workers() -> None:
    with pytest.raises(ParameterError, match="at least 1, not 0"):
        parallel_map(math.sqrt, [(1.0,)], workers=0)


def test_what_cannot_be_called() -> None:
    lock = threading.Lock()
    message = r"\A<lambda> cannot be called in other processes: TypeError: [^\n]*'_thread.lock'"
    with pytest.raises(ParameterError, match=message):
        parallel_map(lambda n: lock, [(1,), (2,)], workers=2)
    with pytest.raises(ParameterError, match=r"arguments of each call .*tuple, .*, not 2\.5"):
        parallel_map(math.sqrt, [2.5, 1.0])  # type: ignore[list-item]
    with pytest.raises(ParameterError, match="arguments must be of the kind Iterable, not 3"):
        parallel_map(math.sqrt, 3)  # type: ignore[arg-type]
    with pytest.raises(ParameterError, match="function must be one, not 3"):
        parallel_map(3, [(1,)])  # type: ignore[arg-type]
    with pytest.raises(ParameterError, match="workers must be a whole number, not '2'"):
        parallel_map(math.sqrt, [(1.0,)], workers="2")  # type: ignore[arg-type]


def inverse(value: float, folder: str) -> float:
    """Leaves a mark in a folder when it is called."""
    with Path(folder, f"calls-{value:g}").open("a") as file:
        file.write("x")
    return 1.0 / value


def calls(folder: Path) -> dict[str, int]:
    return {path.name: len(path.read_text()) for path in folder.glob("calls-*")}


@pytest.mark.parametrize("workers", [1, 2])
def test_an_interrupted_map_goes_on(tmp_path: Path, workers: int) -> None:
    """Results that are kept are not computed again; neither are those of another map."""
    keep = tmp_path / "kept"
    runs = [(value, str(tmp_path)) for value in (1.0, 2.0, 0.0, 4.0)]
    with pytest.raises(ZeroDivisionError):
        parallel_map(inverse, runs, workers, keep=keep)
    del runs[2]
    results: list[float] = []
    for _ in range(2):
        assert parallel_map(inverse, runs, workers, each=results.append, keep=keep) == [
            1,
            0.5,
            0.25,
        ]
    assert sorted(results) == [0.25, 0.25, 0.5, 0.5, 1, 1]
    assert calls(tmp_path) == {"calls-1": 1, "calls-2": 1, "calls-0": 1, "calls-4": 1}
    assert [path.name for path in keep.iterdir()] == [__version__]


def test_calls_are_known_by_function_and_arguments(tmp_path: Path) -> None:
    for value in (2.0, 4.0, 2.0):
        assert call_once(tmp_path, inverse, value, str(tmp_path)) == 1.0 / value
        assert call_once(tmp_path, inverse, value, folder=str(tmp_path)) == 1.0 / value
        assert call_once(tmp_path, math.sqrt, value) == math.sqrt(value)
    assert calls(tmp_path) == {"calls-2": 1, "calls-4": 1}

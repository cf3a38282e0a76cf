"""Independent calls in several processes."""

import math
import os
import re
import threading
import warnings

import pytest
from lammps_deformable import ParameterError
from lammps_deformable.cli import main as cli
from lammps_deformable.common.parallel import parallel_map
from lammps_deformable.common.versions import machine

from validation.report.paper import regular, ring_in_walls, squeeze


def test_results_keep_their_order() -> None:
    assert parallel_map(math.sqrt, [n * n for n in range(20)], workers=2) == list(range(20))
    assert parallel_map(math.sqrt, [4.0]) == [2.0]
    assert parallel_map(math.sqrt, []) == []
    squares = (n * n for n in range(3))
    assert parallel_map(math.sqrt, squares, workers=2) == [0, 1, 2]


def test_processes_run_lammps_and_use_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    run = (regular(4), [0.02], ring_in_walls(24, 100.0), False)
    here = squeeze(*run)[0]
    for [there] in parallel_map(lambda call: squeeze(*call), [run, run], workers=2):
        assert there.shape_error("ring") == here.shape_error("ring")
    assert set(parallel_map(os.getenv, ["OMP_NUM_THREADS"] * 2, workers=2)) == {"1"}
    assert os.environ["OMP_NUM_THREADS"] == "7"
    assert os.getpid() not in parallel_map(lambda n: os.getpid(), [1, 2], workers=2)


def test_no_more_processes_than_cores_that_may_be_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {3})
    assert parallel_map(lambda n: os.getpid(), [1, 2]) == [os.getpid()] * 2
    assert machine()["cores"] == 1


def test_a_process_that_dies_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(cli, "app", lambda **_: parallel_map(os._exit, [1, 1], workers=2))
    monkeypatch.setattr(warnings, "showwarning", warnings.showwarning)  # main replaces it
    with warnings.catch_warnings(), pytest.raises(SystemExit):
        cli.main()
    last = capsys.readouterr().err.splitlines()[-1]
    assert re.match(r"error: a process of _exit died, EXIT\(1\).*: it crashed, or was killed", last)


def test_what_cannot_be_copied() -> None:
    lock = threading.Lock()
    message = r"\A<lambda> or an item cannot be copied .*'_thread.lock'.*: make simulations in "
    with pytest.raises(ParameterError, match=message):
        parallel_map(lambda n: lock, [1, 2], workers=2)
    with pytest.raises(TypeError, match=r"cannot pickle '_thread\.lock'"):
        parallel_map(lambda n: threading.Lock(), [1, 2], workers=2)
    with pytest.raises(ParameterError, match="workers must be a whole number, not '2'"):
        parallel_map(math.sqrt, [1.0], workers="2")  # type: ignore[arg-type]

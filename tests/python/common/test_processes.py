"""Processes of `parallel_map`: scripts and notebooks, variables of MPI, errors, interruptions."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import nbclient
import nbformat
import pytest
from lammps_deformable.common.parallel import parallel_map
from programs import PATIENT, program

PAGE = Path(__file__).parents[3] / "docs" / "cookbook.md"
(ROW,) = [line for line in PAGE.read_text().splitlines() if "parallel_map" in line]
COOKBOOK = "\n".join(
    ["from lammps_deformable import *\nimport numpy", *re.findall(r"`([^`]+)`", ROW)]
)
COOKBOOK = COOKBOOK.replace("jackknife(", "print(*jackknife(") + ")"

# In a script without a guard: where calls are, a function and a class of the script, a constant.
SCRIPT = (
    COOKBOOK
    + """
import os, sys
OFFSET = 10
class Odd(Exception):
    def __init__(self, value, reason):
        super().__init__(reason)
def halves(value):
    if value % 2:
        raise Odd(value, "it is odd")
    return OFFSET + value // 2, os.getpid(), os.environ.get("PMI_RANK")
class Halves:
    def of(self, value):
        return halves(value)[0]
print(parallel_map(Halves().of, [2, 4], workers=2))
found = parallel_map(halves, [2, 4], workers=2)
print([value for value, *_ in found], {rank for *_, rank in found})
print(os.getpid() in {pid for _, pid, _ in found})  # one may make both calls
print(parallel_map(lambda value: value + OFFSET, [1, 2], workers=2))
parallel_map(halves, [2, 3], workers=2)
"""
)


def check(said: str, error: str) -> None:
    phi, spread, *rest = said.split(maxsplit=2)
    assert (0.8 < float(phi) < 0.88, 0.0 < float(spread) < 0.05) == (True, True)
    expected = ["[11, 12]", "[11, 12] {None}", "False", "[11, 12]"]
    assert rest[0].splitlines() == expected
    assert "RuntimeError: Odd: it is odd\nin the call halves(3)" in error
    assert re.search(r", line \d+, in halves\n", error)


def test_a_script_without_a_guard(tmp_path: Path) -> None:
    """Also where variables of mpiexec or srun are there, which processes must not inherit."""
    (tmp_path / "script.py").write_text(SCRIPT)
    result = program("python", "script.py", cwd=tmp_path, ranks=1, PMI_ANY="1")
    assert result.returncode != 0
    check(result.stdout, result.stderr)
    assert "resource_tracker" not in result.stderr


def test_a_cell_of_a_notebook(tmp_path: Path) -> None:
    cell = nbformat.v4.new_code_cell(SCRIPT)
    notebook = nbformat.v4.new_notebook(cells=[cell])
    client = nbclient.NotebookClient(
        notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": tmp_path}}
    )
    with pytest.raises(nbclient.exceptions.CellExecutionError) as raised:
        client.execute()
    streams = [out for out in cell.outputs if out.output_type == "stream"]
    said = "".join(out.text for out in streams if out.name == "stdout")
    check(said, re.sub(r"\x1b\[[\d;]*m", "", str(raised.value)))


def test_lambdas_on_ranks(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(
        "import lammps_deformable as ld\n"
        "print(ld.parallel_map(lambda value: value + 1, [1, 2, 3]))\n"
    )
    result = program("python", "-m", "mpi4py", "script.py", cwd=tmp_path, ranks=2, timeout=60)
    assert result.stdout.count("[2, 3, 4]") == 2, result.stderr


def inverse(value: float) -> float:
    return 1.0 / value


@pytest.mark.parametrize("workers", [1, 2])
def test_errors_note_the_call(workers: int) -> None:
    with pytest.raises(ZeroDivisionError) as caught:
        parallel_map(inverse, [2.0, 0.0], workers=workers)
    if sys.version_info >= (3, 11):
        assert caught.value.__notes__ == ["in the call inverse(0.0)"]
    if workers == 2:
        assert "Traceback (most recent call last)" in str(caught.value.__cause__)


LONG = """
import os, lammps_deformable as ld
def run(seed):
    packing = ld.jam(ld.bidisperse(24, seed=seed)).packing
    with ld.Simulation(packing, ld.Ring()) as sim:
        open(f"pid-{os.getpid()}", "w").close()
        sim.run(10**9, every=100, temperature=1e-7, keep=False)
ld.parallel_map(run, [1, 2, 3], workers=2)
"""


@pytest.mark.parametrize("group", [False, True], ids=["as a notebook", "as a terminal"])
def test_an_interruption_ends_the_processes(group: bool, tmp_path: Path) -> None:
    """The signal of a notebook reaches one process, that of a terminal all of them."""
    (tmp_path / "script.py").write_text(LONG)
    with subprocess.Popen(
        [sys.executable, "script.py"],
        cwd=tmp_path,
        env=os.environ | PATIENT,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as run:
        began = time.monotonic()
        while len(pids := [int(path.name[4:]) for path in tmp_path.glob("pid-*")]) < 2:
            assert run.poll() is None
            assert time.monotonic() < began + 60
            time.sleep(0.05)
        (os.killpg if group else os.kill)(run.pid, signal.SIGINT)
        _, error = run.communicate(timeout=30)
    assert run.returncode != 0
    assert error.rstrip().endswith("KeyboardInterrupt")
    assert "resource_tracker" not in error
    for pid in pids:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)

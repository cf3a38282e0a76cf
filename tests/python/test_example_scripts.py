"""The Python examples run as they stand and say what their logs say."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
BIN = Path(sys.executable).parent


def output(*command: str, cwd: Path) -> np.ndarray:
    """Numbers that a script prints, one row a line of the same form as the last."""
    result = subprocess.run(
        [str(BIN / command[0]), *command[1:]],
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    return numbers(result.stdout)


def numbers(text: str) -> np.ndarray:
    rows = [re.findall(r" (\d\S*)", line) for line in text.splitlines() if line.startswith("phi")]
    return np.array(rows, dtype=float)


def test_compress_says_what_its_log_says(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    shutil.copy(EXAMPLES / "compress" / "compress.py", tmp_path)
    phi, pressure, z = output("python", "compress.py", cwd=tmp_path).T
    expected = numbers((EXAMPLES / "compress" / "compress.log").read_text()).T
    # where a packing jams depends on the last digit, so another processor may find another one
    assert phi == pytest.approx(expected[0], abs=0.02)
    assert z == pytest.approx(expected[2], abs=0.3)
    assert (np.diff(pressure) > 0).all()
    assert (tmp_path / "packing.png").stat().st_size > 10_000
    assert (tmp_path / "run" / "summary.json").exists()


def test_compress_mpi_gives_the_same_on_two_ranks(tmp_path: Path) -> None:
    shutil.copy(EXAMPLES / "mpi" / "compress_mpi.py", tmp_path)
    serial = output("python", "compress_mpi.py", cwd=tmp_path)
    command = ("mpiexec", "-n", "2", str(BIN / "python"), "-m", "mpi4py", "compress_mpi.py")
    assert len(serial) == 2
    assert output(*command, cwd=tmp_path) == pytest.approx(serial, rel=1e-4)

"""Rings with given forces side by side, in vectors of every width, against single ones."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SOURCE = HERE.parents[1] / "src"

MEMORY = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
slow = pytest.mark.slow  # checks of memory take half a minute to compile


@pytest.mark.parametrize(
    ("lanes", "checks"),
    [(4, []), *(pytest.param(n, MEMORY, marks=slow) for n in (2, 4, 8))],
    ids=["4", "2-checked", "4-checked", "8-checked"],
)
def test_force_lanes(tmp_path, lanes, checks):
    """To 1e-12 of the largest entry; with the compiler's checks of memory, where it has them."""
    compiler = shutil.which(os.environ.get("CXX", "g++"))
    assert compiler, "the plugin was built by a compiler that is not here: name it by CXX"
    program, source = tmp_path / "lanes", str(HERE / "force_lanes.cpp")
    command = [compiler, "-std=c++17", "-O0", "-Wno-psabi", "-fno-math-errno"]
    command += [f"-DDEFORMABLE_LANES={lanes}", f"-I{SOURCE}", source]
    for flags in (checks, []):
        done = subprocess.run([*command, *flags, "-o", program], capture_output=True, text=True)
        if done.returncode == 0:
            break
    assert done.returncode == 0, done.stderr
    done = subprocess.run([program], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 30_000

"""The kernels under the compiler's checks of memory and arithmetic."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SOURCE = HERE.parents[1] / "src"
CASES = json.loads((HERE.parent / "data" / "kernel_cases.json").read_text())["cases"]
FLAGS = ["-std=c++17", "-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]


@pytest.fixture(scope="module")
def sanitized(tmp_path_factory):
    """The compiled program, where the compiler has its sanitizers installed."""
    folder = tmp_path_factory.mktemp("sanitized")
    compiler = shutil.which(os.environ.get("CXX", "g++"))
    assert compiler, "the plugin was built by a compiler that is not here: name it by CXX"
    empty = folder / "empty.cpp"
    empty.write_text("int main() {}")
    probe = [compiler, *FLAGS, str(empty), "-o", str(folder / "empty")]
    if subprocess.run(probe, capture_output=True).returncode != 0:
        # a package of their own for some compilers; nothing else of the tests needs them
        pytest.skip(f"{compiler} lacks the libraries of -fsanitize=address,undefined")
    program = folder / "sanitize"
    source = str(HERE / "sanitize.cpp")
    command = [compiler, *FLAGS, "-Wall", "-Wextra", f"-I{SOURCE}", source, "-o", str(program)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return program


def test_kernels(sanitized):
    lines = []
    for case in CASES:
        lines.append(f"{case['radius']} {len(case['angle'])}")
        lines += [f"{a} {b}" for a, b in zip(case["angle"], case["indentation"], strict=True)]
    done = subprocess.run(
        [sanitized], input="\n".join(lines), capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr[-3000:]
    assert int(done.stdout.split()[0]) > 5000

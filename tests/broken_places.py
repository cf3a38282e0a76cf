"""Which tests notice a mistake: the product with some lines broken, one at a time.

    .venv/bin/python tests/broken_places.py build/broken          # all places
    .venv/bin/python tests/broken_places.py build/broken 3 17     # some of them

The package is built once, into the folder given (a minute). There the environment variable
BROKEN_PLACE chooses the place that is broken. The tests are those of its subject: the whole suite
notices more. CONTRIBUTING.md has what came out.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from programs import BIN, program

ROOT = Path(__file__).parents[1]
# of each place four lines: file, an expression (\n for a new line), what takes its place, tests
TABLE = (ROOT / "tests/data/broken_places.txt").read_text()
PLACES = [place.strip().splitlines() for place in TABLE.split("\n\n")]
SWITCH = """#pragma once
#include <cstdlib>
static const int BROKEN_PLACE =
    std::getenv("BROKEN_PLACE") ? std::atoi(std::getenv("BROKEN_PLACE")) : 0;
"""


def with_switches(source: Path) -> None:
    """Each place becomes a choice between the two expressions."""
    (source / "src/core/broken_place.h").write_text(SWITCH)
    for number, (name, old, new, _) in enumerate(PLACES, 1):
        is_python = name.endswith(".py")
        file = source / ("python/lammps_deformable" if is_python else "src") / name
        text, old = file.read_text(), old.replace(r"\n", "\n")
        assert text.count(old) == 1, (name, old)
        if is_python:
            chosen = f"__import__('os').environ.get('BROKEN_PLACE') == '{number}'"
            text = text.replace(old, f"(({new}) if {chosen} else ({old}))")
        else:
            text = text.replace(old, f"(BROKEN_PLACE == {number} ? ({new}) : ({old}))")
            text = '#include "broken_place.h"\n' + text
        file.write_text(text)


def build(folder: Path) -> Path:
    """The folder with the package."""
    package, source = folder / "package", folder / "source"
    if package.exists():
        return package
    shutil.rmtree(source, ignore_errors=True)
    listed = subprocess.check_output(["git", "ls-files"], cwd=ROOT, text=True)
    for file in listed.splitlines():
        (source / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / file, source / file)
    with_switches(source)
    options = ("-q", "--no-build-isolation", "--no-deps", "-w", folder, source)
    path = f"{BIN}:{os.environ['PATH']}"
    done = program("python", "-m", "pip", "wheel", *options, cwd=folder, PATH=path, timeout=3600)
    assert done.returncode == 0, done.stderr
    shutil.unpack_archive(next(folder.glob("*.whl")), package, "zip")
    return package


def noticed(package: Path, number: int, tests: list[str]) -> str:
    """How many tests fail and pass."""
    options = ("-q", "-n", "2", "-m", "not slow", "--tb=no", "-rN", *tests)
    broken = {"PYTHONPATH": str(package), "BROKEN_PLACE": str(number)}
    done = program("python", "-m", "pytest", *options, cwd=ROOT / "tests", timeout=3600, **broken)
    return re.sub(r"(, \d+ warnings?)? in .*", "", done.stdout.splitlines()[-1])


if __name__ == "__main__":
    into = Path(sys.argv[1]).resolve()
    into.mkdir(parents=True, exist_ok=True)
    package = build(into)
    for number in map(int, sys.argv[2:] or range(1, len(PLACES) + 1)):
        name, _, _, tests = PLACES[number - 1]
        print(number, name, noticed(package, number, tests.split()), flush=True)

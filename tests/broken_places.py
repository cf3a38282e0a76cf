"""Which tests notice a mistake: the product with some lines broken, one at a time.

    .venv/bin/python tests/broken_places.py build/broken          # all places
    .venv/bin/python tests/broken_places.py build/broken 3 17     # some of them
    .venv/bin/python tests/broken_places.py build/broken --cover times.txt

The package is built once, into the folder given (some minutes). There the environment variable
BROKEN_PLACE chooses the place that is broken. The tests are those of its subject: the whole suite
notices more. What came out goes into data/broken_places.csv, the names of the tests that notice a
place into data/noticed_by.json, and what pytest said into the folder, a file for each place.

With --cover nothing is run: it reads what `pytest --durations=0 -vv` has printed, and tells which
tests together notice all places, in the least time that a greedy choice finds. Others of the same
subjects may go, as far as places tell: each is one mistake, and a test may notice others.
"""

import argparse
import csv
import json
import os
import re
import shutil
import signal
import subprocess
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from programs import BIN, PATIENT, program

ROOT = Path(__file__).parents[1]
TESTS = ROOT / "tests"
RESULTS = TESTS / "data/broken_places.csv"
NAMES = TESTS / "data/noticed_by.json"
# of each place five lines: what is broken, the file, an expression (\n for a new line), what takes
# its place, and patterns of test files
TABLE = (TESTS / "data/broken_places.txt").read_text()
PLACES = [place.strip().splitlines() for place in TABLE.split("\n\n")]
SWITCH = """#pragma once
#include <cstdlib>
static const int BROKEN_PLACE =
    std::getenv("BROKEN_PLACE") ? std::atoi(std::getenv("BROKEN_PLACE")) : 0;
"""
LIMIT = 300  # s; a mistake may make ranks wait for each other


def with_switches(source: Path) -> None:
    """Each place becomes a choice between the two expressions."""
    (source / "src/broken_place.h").write_text(SWITCH)
    for number, (_, name, old, new, _) in enumerate(PLACES, 1):
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


def build(folder: Path, change: Callable[[Path], None], *options: str) -> Path:
    """The folder with the package, built from a copy of the source that is changed first."""
    package, source = folder / "package", folder / "source"
    if package.exists():
        return package
    shutil.rmtree(source, ignore_errors=True)
    listed = subprocess.check_output(["git", "ls-files"], cwd=ROOT, text=True)
    for file in listed.splitlines():
        (source / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / file, source / file)
    change(source)
    words = ("-q", "--no-build-isolation", "--no-deps", "-w", folder, source, *options)
    for_tests = ("-C", "cmake.define.DEFORMABLE_FOR_TESTS=ON")
    path = f"{BIN}:{os.environ['PATH']}"
    done = program(
        *("python", "-m", "pip", "wheel", *words, *for_tests), cwd=folder, PATH=path, timeout=3600
    )
    assert done.returncode == 0, done.stderr
    shutil.unpack_archive(next(folder.glob("*.whl")), package, "zip")
    return package


def files_of(patterns: str) -> list[str]:
    """The files of these patterns, which must have some each."""
    found: dict[str, None] = {}
    for pattern in patterns.split():
        files = sorted(each for each in TESTS.glob(pattern) if each.name.startswith("test_"))
        assert files, f"no tests are {pattern}"
        found |= dict.fromkeys(str(file.relative_to(TESTS)) for file in files)
    return list(found)


def end(variable: str) -> None:
    """Tests with this variable, and what they have started, which may have left their session."""
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # it has ended, or is another user's
            if f"{variable}\0".encode() in (process / "environ").read_bytes():
                os.kill(int(process.name), signal.SIGKILL)


def results_of(
    package: Path, chosen: tuple[str, str], words: Sequence[str], said: Path, limit: float
) -> tuple[list[str], int]:
    """Which fast tests fail, of how many, with a variable that chooses what is broken.

    Args:
        package: where it was built.
        chosen: the variable and its value.
        words: for pytest.
        said: a file for what pytest prints.
        limit: seconds; tests that wait for ever are one.
    """
    with said.open("w") as file:
        run = subprocess.Popen(
            [str(BIN / "python"), "-m", "pytest", "-v", "-m", "not slow", "--tb=line", *words],
            cwd=TESTS,
            env=os.environ | PATIENT | {"PYTHONPATH": str(package), chosen[0]: chosen[1]},
            stdout=file,
            stderr=subprocess.STDOUT,
        )
        try:
            run.wait(limit)
        except subprocess.TimeoutExpired:
            end("=".join(chosen))
            file.write("\n[gw0] FAILED and the rest, which does not end\n")
    each = r"^\[gw\d+\].* (PASSED|FAILED|ERROR) (.+?) *$"
    whole_file = r"^(ERROR) (\S+\.py)(?: - .*)?$"  # which cannot be imported
    told = [
        found for line in (each, whole_file) for found in re.findall(line, said.read_text(), re.M)
    ]
    failed = {test for result, test in told if result != "PASSED"}
    return sorted(failed), len({test for _, test in told})


def noticed(package: Path, number: int, said: Path) -> tuple[list[str], int]:
    """Which tests of its subject notice the place, of how many."""
    words = ("-n", "1", *files_of(PLACES[number - 1][-1]))
    return results_of(package, ("BROKEN_PLACE", str(number)), words, said, LIMIT)


def write_results(results: dict[int, tuple[list[str], int]]) -> None:
    """Into the tables, whose columns `before` and other places stay as they are."""
    names = json.loads(NAMES.read_text()) if NAMES.exists() else {}
    names |= {PLACES[number - 1][0]: tests for number, (tests, _) in results.items()}
    NAMES.write_text(json.dumps(dict(sorted(names.items())), indent=0) + "\n")
    former = {}
    if RESULTS.exists():
        with RESULTS.open(newline="") as file:
            former = {row["what"]: row for row in csv.DictReader(file)}
    columns = ("file", "what", "before", "of", "now", "of now")
    with RESULTS.open("w", newline="") as file:
        rows = csv.DictWriter(file, columns, lineterminator="\n")
        rows.writeheader()
        for number, (what, name, *_) in enumerate(PLACES, 1):
            row = former.get(what, {}) | {"file": name, "what": what}
            if number in results:
                row["now"], row["of now"] = str(len(results[number][0])), str(results[number][1])
            rows.writerow(row)


def cover(times: str) -> None:
    """Print tests that notice all places together, and the others that notice some.

    Args:
        times: what `pytest --durations=0 -vv` has printed.
    """
    found = re.findall(
        r"^([\d.]+)s (?:setup|call|teardown) +(?:tests/)?(\S.*)$", times, re.MULTILINE
    )
    seconds: dict[str, float] = {}
    for time, test in found:
        seconds[test] = seconds.get(test, 0.0) + float(time)
    by_test: dict[str, set[str]] = {}
    for place, tests in json.loads(NAMES.read_text()).items():
        for test in tests:
            by_test.setdefault(test, set()).add(place)
    left, needed = set().union(*by_test.values()), []
    while left:
        best = max(
            by_test, key=lambda test: len(by_test[test] & left) / (0.01 + seconds.get(test, 0.0))
        )
        needed.append(best)
        left -= by_test[best]
    for title, tests in (
        ("These notice all places that are noticed:", needed),
        ("These notice no further place:", sorted(set(by_test) - set(needed))),
    ):
        print(f"{title} {len(tests)}, {sum(seconds.get(test, 0.0) for test in tests):.0f} s")
        for test in sorted(tests, key=lambda test: -seconds.get(test, 0.0)):
            print(f"{seconds.get(test, 0.0):8.2f} s  {len(by_test[test]):3}  {test}")


if __name__ == "__main__":
    summary, _, usage = __doc__.partition("\n\n")
    words = argparse.ArgumentParser(
        description=summary, epilog=usage, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    words.add_argument("folder", type=Path, help="where the package is built")
    words.add_argument("numbers", type=int, nargs="*", help="of places; all if there are none")
    words.add_argument("--cover", type=Path, metavar="TIMES", help="print which tests suffice")
    given = words.parse_args()
    if given.cover:
        cover(given.cover.read_text())
        raise SystemExit
    numbers = given.numbers or range(1, len(PLACES) + 1)
    if not 1 <= min(numbers) <= max(numbers) <= len(PLACES):
        words.error(f"places have the numbers 1 to {len(PLACES)}")
    into = given.folder.resolve()
    into.mkdir(parents=True, exist_ok=True)
    package, results = build(into, with_switches), {}
    for number in numbers:
        results[number] = noticed(package, number, into / f"{number}.txt")
        write_results({number: results[number]})  # what is done stays, if it is interrupted
        what, name, *_ = PLACES[number - 1]
        print(
            f"{number} {name}, {what}: {len(results[number][0])} of {results[number][1]}",
            flush=True,
        )

"""How many mistakes that nobody chose the fast tests notice: drawn in the C++ and in the Python.

    .venv/bin/python tests/random_mistakes.py build/mistakes --without 2 10 13

An expression is drawn first, each as likely as any other, and then a mistake in it: another sign,
operator or comparison, min for max, a constant 1 % or an index one larger, a term less, arguments
that are swapped. The package is built once with all of them; the environment variable MISTAKE
chooses. The tests of the broken places of its file, then those of its folder run until one fails.
Results go into data/random_mistakes.csv; its column `judged` is written by hand, and what is
noticed does not run again. Draws that do not compile are left out by number. They follow from the
seed and the sources: those of the table are of commit f09dc453.
"""

import argparse
import ast
import copy
import csv
import random
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from broken_places import PLACES, ROOT, TESTS, build, files_of, results_of

SWITCH = """#pragma once
#include <cstdlib>
static const int MISTAKE = std::getenv("MISTAKE") ? std::atoi(std::getenv("MISTAKE")) : 0;
"""
RESULTS = TESTS / "data/random_mistakes.csv"
COLUMNS = ("number", "file", "line", "old", "new", "noticed by", "judged")
LIMIT = 1200  # s
UNTOUCHED = (ast.JoinedStr, ast.match_case)
# the tests of a folder of the sources, in the order in which they run
FOLDERS = {
    "src/styles": ("lammps",),
    "src/polygons": ("core", "lammps"),
    "src/solver": ("solver", "lammps"),
    "src": ("core", "solver", "lammps"),
    "python": ("python",),
}
# what takes the place of an operator, with the spaces around it
SWAPPED = {" + ": " - ", " * ": " / ", " < ": " <= ", " > ": " >= ", " == ": " != "}
SWAPPED |= {" && ": " || ", "std::min(": "std::max(", "smaller(": "larger("}
OPERATORS = SWAPPED | {new: old for old, new in SWAPPED.items()}
IN_PYTHON = {ast.Add: ast.Sub, ast.Mult: ast.Div, ast.Lt: ast.LtE, ast.Gt: ast.GtE}
IN_PYTHON |= {ast.Eq: ast.NotEq, ast.And: ast.Or}
IN_PYTHON |= {new: old for old, new in IN_PYTHON.items()}
NAMES = {"min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum"}


@dataclass(frozen=True)
class Mistake:
    """Text of a file from a place on, and what takes its place."""

    file: str
    start: int
    line: int
    old: str
    new: str


def without_comments(text: str) -> str:
    """The same length, with spaces for comments and strings."""
    pattern = r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|^[ \t]*#[^\n]*'
    return re.sub(
        pattern,
        lambda found: re.sub(r"[^\n]", " ", found[0]),
        text,
        flags=re.DOTALL | re.MULTILINE,
    )


def expressions(text: str) -> Iterator[tuple[int, str]]:
    """What C++ assigns, returns and asks for, where a choice may stand."""
    for found in re.finditer(r"(?:return|(?<=[\w\])] )[-+*/]?=) ([^;{}]+);", text):
        line = text[text.rfind("\n", 0, found.start()) + 1 : found.start()]
        if not re.search(r"\b(constexpr|static|using|template|for|operator)\b", line):
            yield found.start(1), found[1]
    for found in re.finditer(r"\b(?:if|while) \(", text):
        end, depth = found.end(), 1
        while depth:
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            end += 1
        yield found.end(), text[found.end() : end - 1]


def changes(old: str) -> list[str]:
    """All mistakes in an expression of C++."""
    found = []
    for operator, other in OPERATORS.items():
        for at in re.finditer(re.escape(operator), old):
            found.append(old[: at.start()] + other + old[at.end() :])
    for at in re.finditer(r"(?<![\w.])(?!0\.0\b)\d+\.\d*(?:e-?\d+)?", old):
        found.append(f"{old[: at.start()]}1.01 * {at[0]}{old[at.end() :]}")
    for at in re.finditer(r"\[([^][]+)\]", old):
        found.append(f"{old[: at.start()]}[{at[1]} + 1]{old[at.end() :]}")
    for at in re.finditer(r" [+-] (?:[\w.:]|->|\[[^]]*\]|\([^()]*\)| [*/] )+", old):
        found.append(old[: at.start()] + old[at.end() :])
    for at in re.finditer(r"((?<!max|min|ler|ger)\()([^(),]+), ([^(),]+)(?=[,)])", old):
        found.append(f"{old[: at.start()]}{at[1]}{at[3]}, {at[2]}{old[at.end() :]}")
    return found


def in_cpp(file: Path) -> list[tuple[int, str, list[str]]]:
    text, plain = file.read_text(), without_comments(file.read_text())
    found = [(start, old, changes(old)) for start, old in expressions(plain)]
    return [each for each in found if each[2] and text.startswith(each[1], each[0])]


def changed(node: ast.expr) -> list[ast.expr]:
    """All mistakes in this node of Python, not in what it contains."""
    made = []

    def add(**fields: object) -> None:
        other = copy.deepcopy(node)
        for name, value in fields.items():
            setattr(other, name, value)
        made.append(other)

    match node:
        case ast.BinOp(left, op, _):
            if type(op) in IN_PYTHON:
                add(op=IN_PYTHON[type(op)]())
            if isinstance(op, ast.Add | ast.Sub):
                made.append(left)
        case ast.Compare(ops=[op]) if type(op) in IN_PYTHON:
            add(ops=[IN_PYTHON[type(op)]()])
        case ast.BoolOp(op=op):
            add(op=IN_PYTHON[type(op)]())
        case ast.Constant(value) if type(value) is int:
            add(value=value + 1)
        case ast.Constant(value) if type(value) is float and value:
            add(value=1.01 * value)
        case ast.Call(func=ast.Name(id=name)) if name in NAMES:
            add(func=ast.Name(NAMES[name]))
        case ast.Call(func=ast.Attribute(value, name)) if name in NAMES:
            add(func=ast.Attribute(value, NAMES[name]))
        case ast.Call(args=[first, second, *rest]) if not isinstance(first, ast.Starred):
            add(args=[second, first, *rest])
    return made


def in_python(file: Path) -> list[tuple[int, str, list[str]]]:
    """Nodes of functions, not of annotations and texts."""
    source = file.read_text()
    assert source.isascii(), "columns count bytes"
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    found = []

    def walk(node: ast.AST) -> None:
        for name, value in ast.iter_fields(node):
            for each in value if isinstance(value, list) else [value]:
                if not isinstance(each, ast.AST) or isinstance(
                    each, ast.JoinedStr | ast.match_case
                ):
                    continue
                if name in ("annotation", "returns", "decorator_list"):
                    continue
                if isinstance(each, ast.expr) and changed(each):
                    at = starts[each.lineno - 1] + each.col_offset
                    old = source[at : starts[each.end_lineno - 1] + each.end_col_offset]
                    found.append((at, old, [ast.unparse(other) for other in changed(each)]))
                walk(each)

    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef):
            for each in node.body:
                walk(each)
    return list({(at, old): (at, old, new) for at, old, new in found}.values())


def draw(seed: int, number: int) -> dict[int, Mistake]:
    """First of the C++, then of the Python, `number` each; no two share text."""
    generator, mistakes = random.Random(seed), {}
    for folder, endings, read in (
        ("src", ("*.h", "*.cpp"), in_cpp),
        ("python/lammps_deformable", ("*.py",), in_python),
    ):
        files = sorted(path for ending in endings for path in (ROOT / folder).rglob(ending))
        places = [(file, *place) for file in files for place in read(file)]
        for file, start, old, new in generator.sample(places, number):
            text = file.read_text()
            mistakes[len(mistakes) + 1] = Mistake(
                file.relative_to(ROOT).as_posix(),
                start,
                text.count("\n", 0, start) + 1,
                text[start : start + len(old)],
                generator.choice(new),
            )
    return mistakes


def with_choices(source: Path, mistakes: dict[int, Mistake]) -> None:
    """Each mistake becomes a choice; the last of a file first, as places count from its begin."""
    for number, each in sorted(mistakes.items(), key=lambda item: -item[1].start):
        file = source / each.file
        text = file.read_text()
        end = each.start + len(each.old)
        assert text[each.start : end] == each.old, each
        chosen = f"MISTAKE == {number}"
        if file.suffix == ".py":
            chosen = f"__import__('os').environ.get('MISTAKE') == '{number}'"
            choice = f"(({each.new}) if {chosen} else ({each.old}))"
        else:
            choice = f"({chosen} ? ({each.new}) : ({each.old}))"
        text = text[: each.start] + choice + text[end:]
        file.write_text(text)
    (source / "src/mistake.h").write_text(SWITCH)
    for name in {each.file for each in mistakes.values() if not each.file.endswith(".py")}:
        file = source / name
        file.write_text('#include "mistake.h"\n' + file.read_text())


def tests_of(mistake: Mistake) -> list[list[str]]:
    """Those of the broken places of its file first, then those of its folder."""
    patterns = [place[-1] for place in PLACES if mistake.file.endswith(f"/{place[1]}")]
    room = re.match(r"python/lammps_deformable/(\w+)/", mistake.file)
    own = [f"python/{room[1]}"] if room and (TESTS / "python" / room[1]).is_dir() else []
    folder = next(folder for folder in FOLDERS if mistake.file.startswith(folder))
    groups = [files_of(" ".join(patterns)), own, *([each] for each in FOLDERS[folder])]
    return [group for group in groups if group]


def first_that_fails(package: Path, number: int, groups: list[list[str]], into: Path) -> str:
    """The first test that notices the mistake, and passes without it; empty if none does."""
    said, without = into / f"{number}.txt", ("MISTAKE", "0")
    words = ["-n", "2", "--maxfail", "1", "--dist", "loadfile", "--no-loadscope-reorder"]
    for group in groups:
        while True:
            chosen = ("MISTAKE", str(number))
            failed, _ = results_of(package, chosen, (*words, *group), said, LIMIT)
            if not failed:
                break
            file = failed[0].partition("::")[0]
            if not (TESTS / file).exists():  # the rest does not end
                return failed[0]
            if not results_of(package, without, ("-n", "1", failed[0]), into / "0.txt", LIMIT)[0]:
                return failed[0]
            words += ["--deselect", f"tests/{failed[0]}"]
    return ""


def read_rows(mistakes: dict[int, Mistake]) -> dict[int, dict[str, str]]:
    """What is known of each."""
    former = {}
    if RESULTS.exists():
        with RESULTS.open(newline="") as file:
            former = {(row["file"], row["old"], row["new"]): row for row in csv.DictReader(file)}
    rows = {}
    for number, each in mistakes.items():
        row = {"number": str(number), "file": each.file, "line": str(each.line)}
        row |= {"old": " ".join(each.old.split()), "new": " ".join(each.new.split())}
        known = former.get((row["file"], row["old"], row["new"]), {})
        rows[number] = row | {name: known.get(name, "") for name in ("noticed by", "judged")}
    return rows


def write(rows: dict[int, dict[str, str]]) -> None:
    with RESULTS.open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(rows[number] for number in sorted(rows))


if __name__ == "__main__":
    summary, _, usage = __doc__.partition("\n\n")
    words = argparse.ArgumentParser(
        description=summary, epilog=usage, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    words.add_argument("folder", type=Path, help="where the package is built")
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--number", type=int, default=18, help="of draws in each language")
    words.add_argument("--without", type=int, nargs="*", default=[], help="draws that are left out")
    words.add_argument("--show", action="store_true", help="print the draws, and do nothing else")
    given = words.parse_args()
    mistakes = draw(given.seed, given.number)
    for number in given.without:
        del mistakes[number]
    if given.show:
        for number, each in mistakes.items():
            print(f"{number} {each.file}:{each.line}\n    {each.old}\n    {each.new}")
        raise SystemExit
    into = given.folder.resolve()
    into.mkdir(parents=True, exist_ok=True)
    again = ("-C", f"build-dir={into}/build")  # after a draw that does not compile
    package = build(into, lambda source: with_choices(source, mistakes), *again)
    rows = read_rows(mistakes)
    for number, each in mistakes.items():
        if not rows[number]["noticed by"]:
            rows[number]["noticed by"] = first_that_fails(package, number, tests_of(each), into)
            write(rows)
            print(number, each.file, rows[number]["noticed by"] or "noticed by none", flush=True)

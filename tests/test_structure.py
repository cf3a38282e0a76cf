"""The structure of the package: modules import each other without circles."""

import ast
import shutil
from collections import Counter
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import lammps_deformable as ld
from broken_places import with_switches

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "python" / "lammps_deformable"


def imports_of(text: str) -> Iterator[str]:
    """Modules of the package that a module loads when it is imported."""
    for node in ast.parse(text).body:
        if isinstance(node, ast.ImportFrom) and node.level == 1:
            yield from [node.module] if node.module else [alias.name for alias in node.names]


def circle(graph: dict[str, set[str]]) -> list[str]:
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_imports_have_no_circle() -> None:
    graph = {path.stem: set(imports_of(path.read_text())) for path in PACKAGE.glob("[!_]*.py")}
    assert circle(graph) == []
    graph["errors"] = {"packing"}
    assert "errors" in circle(graph)


def test_no_module_hides_a_name() -> None:
    """`ld.jam` would be the module `jam` once that is imported."""
    assert {path.stem for path in PACKAGE.glob("*.py")} & set(ld.__all__) == set()


def test_no_two_files_of_tests_have_one_name() -> None:
    """pytest imports them by their names alone."""
    names = Counter(path.name for path in (ROOT / "tests").rglob("test_*.py"))
    assert {name for name, count in names.items() if count > 1} == set()


def test_broken_places_are_in_the_source(tmp_path: Path) -> None:
    for folder in ("src", "python"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    with_switches(tmp_path)


def test_no_rank_stops_alone() -> None:
    """What one rank finds out is refused (refusals.h), so that others do not wait for it."""
    sources = [*(ROOT / "src").rglob("*.cpp"), *(ROOT / "src").rglob("*.h")]
    assert [file.name for file in sources if "error->one" in file.read_text()] == []

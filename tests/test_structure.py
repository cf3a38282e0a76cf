"""The structure of the package: modules import each other without circles."""

import ast
import re
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


def names_in_lammps(text: str) -> set[str]:
    """Classes and structs that a header defines in the namespace of LAMMPS."""
    blocks = re.findall(r"^namespace LAMMPS_NS \{\n(.*?)^\}    // namespace", text, re.M | re.S)
    names = re.findall(
        r"^(?:class|struct|enum|using|inline \w+) (\w+)(?! *;)\b", "\n".join(blocks), re.M
    )
    return {name for name in names if "Deformable" not in name}


def test_only_styles_are_in_the_namespace_of_lammps() -> None:
    """Where packages of LAMMPS have names of their own, such as PairList."""
    forward = {"lammps_min.h", "lammps_names.h"}  # what LAMMPS defines
    headers = [file for file in (ROOT / "src").rglob("*.h") if file.name not in forward]
    found = {file.name: names_in_lammps(file.read_text()) for file in headers}
    assert {name: names for name, names in found.items() if names} == {}
    wrong = (
        "namespace LAMMPS_NS {\n\nclass PairList : Pointers {\n};\n\n}    // namespace LAMMPS_NS"
    )
    assert names_in_lammps(wrong) == {"PairList"}


def test_guards_are_ours() -> None:
    """LAMMPS' own begin with LMP_."""
    headers = (ROOT / "src").rglob("*.h")
    guards = [re.findall(r"^#ifndef (\w+)", file.read_text(), re.M)[0] for file in headers]
    assert [guard for guard in guards if not guard.startswith("DEFORMABLE_")] == []

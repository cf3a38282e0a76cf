"""The structure of the package: modules import each other without circles."""

import ast
import re
import shutil
from collections import Counter
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import lammps_deformable as ld
from broken_places import with_switches

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "python" / "lammps_deformable"


# Each may import those before it. The objects of users have methods that later rooms do: their
# modules import these where they are called, and nobody else does.
ROOMS = (
    *("common", "particles", "formats", "state", "pictures", "engine", "protocols", "runs"),
    *("reference", "cli"),
)
FACADES = {
    *("particles.packing", "state.state", "state.modes", "engine.simulation"),
    "protocols.recording",
}


def imports_of(text: str, name: str, inside: bool = True) -> set[str]:
    """Modules of the package that a module of this name imports, also inside of functions or not.

    Those of types only do not count.
    """
    tree = ast.parse(text)
    of_types = {
        node
        for choice in ast.walk(tree)
        if isinstance(choice, ast.If) and "TYPE_CHECKING" in ast.unparse(choice.test)
        for node in ast.walk(choice)
    }
    found = set()
    for node in ast.walk(tree) if inside else tree.body:
        if not isinstance(node, ast.ImportFrom) or not node.level or node in of_types:
            continue
        folder = name.split(".")[: -node.level]
        path = [*folder, node.module] if node.module else folder
        found |= {".".join([*path, alias.name]) for alias in node.names} | {".".join(path)}
    return found


def modules() -> dict[str, str]:
    """Texts of the modules by their names within the package."""
    return {f"{path.parent.name}.{path.stem}": path.read_text() for path in PACKAGE.glob("*/*.py")}


def circle(graph: dict[str, set[str]]) -> list[str]:
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def arrows_up(name: str, text: str) -> list[str]:
    """Imports of a module from a room behind its own."""
    room = ROOMS.index(name.partition(".")[0])
    found = imports_of(text, name, inside=name not in FACADES)
    others = {each for each in found if each.partition(".")[0] in ROOMS}
    return sorted(each for each in others if ROOMS.index(each.partition(".")[0]) > room)


def test_rooms_import_those_before_them() -> None:
    assert {path.name for path in PACKAGE.iterdir() if path.is_dir()} >= set(ROOMS)
    found = {name: arrows_up(name, text) for name, text in modules().items()}
    assert {name: arrows for name, arrows in found.items() if arrows} == {}
    inside = "def f():\n    from ..engine.relax import rest\n"
    assert "engine.relax" in arrows_up("state.contacts", inside)
    assert arrows_up("state.state", inside) == []
    assert "engine.relax" in arrows_up("state.state", "from ..engine.relax import rest")


def test_imports_have_no_circle() -> None:
    texts = modules()
    graph = {
        name: imports_of(text, name, inside=name not in FACADES) & set(texts)
        for name, text in texts.items()
    }
    assert circle(graph) == []
    graph["common.errors"] = {"particles.packing"}
    assert "common.errors" in circle(graph)


def test_no_room_hides_a_name() -> None:
    """`ld.jam` would be a room `jam` once that is imported."""
    assert set(ROOMS) & set(ld.__all__) == set()


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
    forward = {"lammps_min.h", "lammps_names.h", "lammps_release.h"}  # what LAMMPS defines
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

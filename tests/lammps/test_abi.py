"""A plugin that was built for another LAMMPS warns and registers no styles."""

import os
import shutil
import subprocess
from importlib import metadata
from pathlib import Path

import lammps_deformable_plugin as plugin
import pytest
from lammps_deformable import core

(LIBRARY,) = Path(plugin.directory()).glob("*plugin.so")
STYLES = (
    "pair style plugin deformable/ring",
    "deformable/sector",
    "deformable/edge",
    "fix style plugin deformable/wall",
    "deformable/polygon",
    "deformable/stick",
    "compute style plugin deformable/contact",
)


def installed(package, name):
    """The file of this name in a package, not a launcher of it."""
    (file,) = (f for f in metadata.files(package) if f.name == name and "bin" not in f.parts)
    return Path(file.locate()).resolve()


def raw_lmp(folder, script, **environment):
    """Run LAMMPS' own program, without Python, with the plugins of a folder."""
    (folder / "in.script").write_text(script)
    paths = {
        "LAMMPS_PLUGIN_PATH": str(folder),
        "LD_LIBRARY_PATH": str(installed("mpich", "libmpi.so.12").parent),
    }
    return subprocess.run(
        [installed("lammps", "lmp"), "-in", "in.script", "-log", "none"],
        cwd=folder,
        env=os.environ | paths | environment,
        capture_output=True,
        text=True,
        timeout=60,
    )


def test_plugin_fits_the_lammps_of_this_environment(tmp_path):
    shutil.copy(LIBRARY, tmp_path)
    done = raw_lmp(tmp_path, "plugin list")
    assert done.returncode == 0, done.stdout + done.stderr
    assert all(style in done.stdout for style in STYLES)
    assert done.stderr == ""


YEAR, MONTH, DAY = map(int, core.lammps_wheel.split(".")[:3])
RELEASE = 10000 * YEAR + 100 * MONTH + DAY

# Another host: LAMMPS' functions that tell what it is, loaded before those of LAMMPS.
HOST = """
#include <cstdlib>
#include <cstring>
const char *commit() asm("_ZN9LAMMPS_NS6LAMMPS14git_descriptorEv");
const char *commit() { return std::getenv("HOST_COMMIT"); }
extern "C" int lammps_version(void *) { return std::atoi(std::getenv("HOST_RELEASE")); }
extern "C" int lammps_extract_setting(void *, const char *what)
{
  return std::strcmp(what, "tagint") == 0 ? std::atoi(std::getenv("HOST_TAGINT")) : -1;
}
"""


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    folder = tmp_path_factory.mktemp("host")
    (folder / "host.cpp").write_text(HOST)
    compiler = shutil.which(os.environ.get("CXX", "g++"))
    assert compiler, "the plugin was built by a compiler that is not here: name it by CXX"
    library = folder / "host.so"
    subprocess.run(
        [compiler, "-shared", "-fPIC", folder / "host.cpp", "-o", library], check=True, timeout=60
    )
    return library


@pytest.mark.parametrize(
    ("commit", "release", "tagint", "words"),
    [
        (core.lammps_version, RELEASE, 4, None),
        ("(unknown)", RELEASE, 4, None),
        ("stable_update9", RELEASE, 4, "(stable_update9): its styles are not available, install"),
        ("(unknown)", 20200303, 4, "but this is LAMMPS 3Mar2020: its styles are not available"),
        (core.lammps_version, RELEASE, 8, "-D LAMMPS_SIZES=bigbig"),
    ],
    ids=[
        "same",
        "no commit",
        "other commit",
        "other release",
        "bigbig",
    ],
)
def test_what_the_plugin_compares(commit, release, tagint, words, host, tmp_path):
    """A LAMMPS from a tarball does not know its commit: then the release decides."""
    shutil.copy(LIBRARY, tmp_path)
    told = {"HOST_COMMIT": commit, "HOST_RELEASE": str(release), "HOST_TAGINT": str(tagint)}
    done = raw_lmp(tmp_path, "plugin list", LD_PRELOAD=str(host), **told)
    assert done.returncode == 0, done.stdout + done.stderr
    if words is None:
        assert all(style in done.stdout for style in STYLES)
        assert done.stderr == ""
    else:
        assert not any(style in done.stdout for style in STYLES)
        (line,) = done.stderr.splitlines()
        assert line.startswith("WARNING: lammps-deformable")
        for needed in (words, core.lammps_version):
            assert needed in line
        if tagint == 4:
            assert f"install lammps[mpi]=={core.lammps_wheel} or rebuild" in line


def test_fixes_outlive_their_plugin(tmp_path):
    """LAMMPS before 22Jul2025 unloads plugins before it deletes fixes, as does `plugin clear`."""
    shutil.copy(LIBRARY, tmp_path)
    script = """
    dimension 2
    region box block 0 4 0 4 -0.5 0.5
    create_box 1 box
    mass * 1
    pair_style deformable/ring
    fix walls all deformable/wall box
    plugin clear
    """
    done = raw_lmp(tmp_path, script)
    assert done.returncode == 0, done.stdout + done.stderr

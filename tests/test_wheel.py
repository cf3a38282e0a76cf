"""What `make wheel` builds: one wheel for many Pythons, which needs no compiler, and its source."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).parents[1]
STABLE = (3, 12)  # from here on nanobind's modules have the stable ABI


def test_workflows_call_targets_of_the_makefile():
    targets = re.findall(r"^\.PHONY: (.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE)
    files = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
    calls = {name for file in files for name in re.findall(r"\bmake (\S+)", file.read_text())}
    assert len(files) == 4
    assert calls == {"docs", "test-slow", ".venv/installed-test"}
    assert calls - {".venv/installed-test"} <= set(targets[0].split())
    assert ".ci/run" in (ROOT / ".github" / "workflows" / "tests.yml").read_text()


def interpreters() -> dict[tuple[int, int], Path]:
    """Pythons of this machine that the package supports, by their versions."""
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    named = [shutil.which(f"python3.{minor}") for minor in range(10, 20)]
    found = {}
    for path in [*filter(None, named), *pyenv.glob("versions/*/bin/python3"), sys.executable]:
        ask = "import sys, ensurepip, venv; print(*sys.version_info[:2])"
        told = subprocess.run([path, "-c", ask], capture_output=True, text=True)
        if told.returncode == 0:
            found[tuple(map(int, told.stdout.split()))] = Path(path)
    return {version: path for version, path in sorted(found.items()) if version >= (3, 10)}


@pytest.fixture(scope="module")
def pythons():
    """Version that builds, and the newest one that can use the result."""
    found = interpreters()
    stable = [version for version in found if version >= STABLE]
    return (stable[0], stable[-1]) if stable else (sys.version_info[:2],) * 2


@pytest.fixture(scope="module")
def dist(pythons, tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    python = interpreters()[pythons[0]]
    command = ["make", "wheel", f"PYTHON={python}", f"WHEEL={folder}/wheel", f"DIST={folder}/dist"]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=1800)
    assert result.returncode == 0, result.stdout + result.stderr
    return folder / "dist"


@pytest.mark.slow
def test_tags_of_the_wheel(dist, pythons):
    """`manylinux` is auditwheel's word; nothing of LAMMPS or MPI is inside."""
    (wheel,) = dist.glob("*.whl")
    name = "cp{}{}".format(*pythons[0])
    tags = "cp312-abi3" if pythons[0] >= STABLE else f"{name}-{name}"
    assert re.fullmatch(rf"lammps_deformable-[\d.]+-{tags}-manylinux_2_\d+_\w+\.whl", wheel.name)
    libraries = [Path(file).name for file in ZipFile(wheel).namelist() if ".so" in file]
    assert sorted(file.split(".")[0] for file in libraries) == ["core", "deformableplugin"]


@pytest.mark.slow
def test_the_source_has_what_is_compiled_and_installed_and_tests(dist):
    (source,) = dist.glob("*.tar.gz")
    with tarfile.open(source) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    folders = ["cmake", "potentials", "python", "src"]
    listed = subprocess.run(
        ["git", "ls-files", *folders], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert set(listed.stdout.split()) <= names
    documents = {"CHANGELOG.md", "CITATION.cff", "LICENSE", "README.md"}
    files = {"CMakeLists.txt", "PKG-INFO", "pyproject.toml"}
    assert {name.partition("/")[0] for name in names if name} == {
        *folders,
        "tests",
        *documents,
        *files,
    }


@pytest.mark.slow
def test_the_wheel_in_a_new_environment_without_a_compiler(dist, pythons, tmp_path):
    """Of another Python, if there is one: `lmp`, `python` and `deformable` work."""
    environment = tmp_path / "environment"
    subprocess.run([interpreters()[pythons[1]], "-m", "venv", environment], check=True)
    # nothing of this environment, and no compiler, even where one is installed
    kept = {
        k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "LD_LIBRARY_PATH", "CXX")
    }
    path = {"PATH": str(environment / "bin")}
    assert shutil.which("c++", path=path["PATH"]) is None

    def run(*command: str) -> str:
        result = subprocess.run(
            [environment / "bin" / command[0], *command[1:]],
            cwd=tmp_path,
            env=kept | path,
            capture_output=True,
            text=True,
            timeout=600,
        )
        assert result.returncode == 0, result.stdout + result.stderr
        return result.stdout

    (wheel,) = dist.glob("*.whl")
    run("python", "-m", "pip", "install", "--quiet", "--only-binary", ":all:", str(wheel))
    version = "{}.{}".format(*pythons[1])
    code = (
        "import lammps_deformable as ld, sys; print(*sys.version_info[:2], sep='.');"
        "print(ld.core); print(ld.core.simd_levels()[0])"
    )
    first, module, lowest = run("python", "-c", code).splitlines()
    assert first == version
    assert lowest == "plain"
    assert ("abi3" in module) == (pythons[0] >= STABLE)
    assert str(environment) in module

    page = (ROOT / "docs" / "start.md").read_text()
    (script,) = re.findall(r"```lammps\n(.*?)```", page, re.DOTALL)
    (tmp_path / "in.soft").write_text(script)
    assert "Loop time" in run("lmp", "-in", "in.soft")
    run("deformable", "info")
    run("deformable", "jam", "--number", "16", "--seed", "1", "--out", "jam")
    assert (tmp_path / "jam" / "summary.json").is_file()

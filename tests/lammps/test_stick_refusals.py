"""Errors of fix deformable/stick."""

import pytest
from lammps import lammps
from test_refusals import refuses
from test_stick import PLANE, SPHERES, STICK, Beads


def test_three_dimensions():
    space = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    space.commands_string(f"region wall block 0 1 0 1 0 1\ncreate_box 1 wall\nmass 1 1\n{STICK}")
    with refuses("Fix stick .*'dimension 2'"):
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
    "no pair style": (PLANE, "Fix stick .*'radius'", ""),
    "no range": (PLANE, r"Fix stick .*: atom 2 at \(0.1, -0.25\) has no radius.* 'radius'", HYBRID),
    "respa": ("run_style respa 2 2 pair 1\n" + PLANE, "Fix stick .*respa"),
    "outside": (
        "region wall plane 0 0 0 0 1 0\n",
        r"Fix stick .*: atom 2 at \(0.1, -0.25\) is outside .*'wall'",
    ),
    "on the surface": (
        "region wall plane 0 0.5 0 0 -1 0\n",
        r"Fix stick .*: atom 1 at \(0, 0.5\) .*on the surface .*'wall'",
    ),
    "slope": ("region wall plane 0 0.55 0 0 -1 0.3\n", "atom 1 at .*'wall'.* not perpendicular"),
    "three faces": (
        "region wall block -0.05 0.05 -1 0.55 -0.5 0.5\ngroup far id 2\ndelete_atoms group far\n",
        "atom 1 at .*more than two faces .*'wall'",
    ),
    "faces alike": (ALIKE, "atom 1 at .*two faces .*'wall' .*'side in'"),
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
    with refuses("Region 'wall' of fix stick"):
        beads.energy()


def test_force_that_is_not_finite():
    with refuses(r"atom 1 at \(0.95, 0\) .*force"):
        Beads(
            [(0.95, 0.0)], PLANE + "fix stick all deformable/stick wall 1.0 radius 1e200"
        ).energy()

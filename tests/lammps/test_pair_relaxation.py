"""Balanced contacts in motion: pairs that open or close are relaxed before all are corrected."""

import numpy as np
import pytest
from contact_rows import of_compute_pair
from lammps_deformable import core
from laws import BALANCED
from moved import Moved
from scene import PACKINGS, Scene

EDGE = PACKINGS[0]["L"] + 0.55  # a room a little larger than the packing's box
WALLS = f"""
change_box all x final -0.55 {EDGE} y final -0.55 {EDGE}
region walls block -0.55 {EDGE} -0.55 {EDGE} -0.5 0.5
fix walls all deformable/wall walls
"""
MANY = "unfix shape\nreplicate 10 10 1"  # 2400 rings in five blocks
SCENES = {
    "rigid": (("small", "large"), "p p p", MANY),
    "soft": (("both", "bothlarge"), "p p p", MANY),
    "walls": (("small", "large"), "f f p", WALLS),
}


def moving(species, boundary, commands):
    """A scene after its first steps, in which forces have no history."""
    scene = Scene.packing(PACKINGS[0], BALANCED, species, boundary=boundary)
    scene.run(commands)
    scene.run("velocity all create 3e-6 4711 loop geom\nfix move all nve\ntimestep 0.05")
    scene.run("thermo 1\nrun 20 post no")
    return scene


@pytest.mark.parametrize("name", ["rigid", "soft"])  # between walls it is enough anyway
def test_one_correction_is_enough(name):
    """In each step some contacts open or close. Without relaxation it takes three evaluations."""
    scene = moving(*SCENES[name])
    found = []
    for _ in range(60):
        scene.run("run 1 pre no post no")
        found.append(of_compute_pair(scene))
    evaluations, imbalance = np.array(found).T
    assert evaluations.mean() <= 2.1
    assert imbalance.max() <= 1e-8


@pytest.mark.parametrize("name", SCENES)
def test_levels_agree_to_the_last_bit(name, monkeypatch):
    forces = []
    for level in core.simd_levels():
        monkeypatch.setenv("DEFORMABLE_SIMD", level)
        scene = moving(*SCENES[name])
        assert of_compute_pair(scene)[0] == 2  # one correction, after relaxation
        forces.append(scene.gather("f", 3))
    for force in forces[1:]:
        np.testing.assert_array_equal(force, forces[0])


@pytest.mark.parametrize(("ranks", "tolerance"), [(1, 1e-8), (2, 1e-6), (2, 1e-10)])
def test_forces_are_those_from_scratch(ranks, tolerance, tmp_path):
    """Of 6144 rings in twelve blocks: each rank has some that are far from the border."""
    rings = 16 * 16 * len(PACKINGS[0]["x"])
    moved = Moved(
        ranks,
        tmp_path,
        grid="* * 1",
        copies=16,
        movers=f"1:{rings}",
        temperature=1e-5,
        steps=30,
        tolerance=tolerance,
    )
    assert moved.error <= 10 * tolerance

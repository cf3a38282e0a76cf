"""Balanced contacts in motion: pairs that open or close are relaxed before all are corrected."""

import numpy as np
import pytest
from balanced import DEFAULT, of_compute_pair
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


@pytest.mark.parametrize(("species", "boundary", "commands"), SCENES.values(), ids=SCENES)
def test_one_correction_is_enough(species, boundary, commands):
    """In each step some contacts open or close. Without relaxation it takes three evaluations."""
    scene = Scene.packing(PACKINGS[0], DEFAULT, species, boundary=boundary)
    scene.run(commands)
    scene.run("velocity all create 1e-5 4711 loop geom\nfix move all nve\ntimestep 0.05")
    scene.run("thermo 1\nrun 20 post no")  # forces have no history at first
    found = []
    for _ in range(60):
        scene.run("run 1 pre no post no")
        found.append(of_compute_pair(scene))
    evaluations, imbalance = np.array(found).T
    assert evaluations.mean() <= 2.1
    assert imbalance.max() <= 1e-8

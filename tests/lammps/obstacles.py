"""Scenes of walls that point at particles, and their energies."""

import numpy as np
from laws import LAWS
from scene import Scene

ROOM = (-9, 9, -9, 9)

PILLARS = {
    "square": "region pillar block -1 1 -1 1 INF INF side out",
    "slanted": "region pillar prism -1 1 -1 1 INF INF 0.7 0 0 side out",
    "disk": "region pillar cylinder z 0 0 0.8 INF INF side out",
    "ball": "region pillar sphere 0.1 -0.2 0 0.8 side out",
    "segment": "region pillar block 0 0 -1 1 INF INF side out",
    "thin": "region pillar block -0.01 0.01 -1 1 -0.5 0.5 side out",
    "triangle": """
        region low plane 0 -0.8 0 0 -1 0
        region left plane -0.6 0.2 0 -1 0.6 0
        region right plane 0.7 0 0 1 0.5 0
        region pillar union 3 low left right""",
    "wedge": """
        region up plane -0.5 0 0 0.5 1 0
        region down plane -0.5 0 0 0.5 -1 0
        region pillar intersect 2 up down side out""",
}
WALL = "fix pillar all deformable/wall pillar\n"


def scene_of(x, species, law, walls, **options):
    return Scene(x, species, ROOM, LAWS.get(law, law), boundary="f f p", commands=walls, **options)


def kinetic(scene):
    """Of particles of mass 1."""
    return 0.5 * (scene.gather("v", 3) ** 2).sum()


def total(scene):
    return scene.lmp.get_thermo("pe") + kinetic(scene)


def energies(scene, calls, steps):
    """Total energies between runs of so many steps."""
    found = [total(scene)]
    for _ in range(calls):
        scene.run(f"run {steps} post no")
        found.append(total(scene))
    return found


def given(scene, fix="wall"):
    """The work of walls so far."""
    return scene.lmp.extract_fix(fix, 0, 0)


def assert_walls_do_the_work(scene, part):
    """Total energy changes by the work of the walls, which is as large as the energy."""
    scene.run("velocity all create 0.002 125\nfix move all nve\ntimestep 0.0125\nrun 0")
    assert given(scene) == 0
    before, found, most = total(scene), [], 0.0
    for _ in range(10):
        scene.run("run 3200 post no")
        found.append(total(scene) + given(scene))
        most = max(most, abs(given(scene)))
    assert most > 0.1 * before
    scale = max(kinetic(scene), before, most)
    assert np.abs(np.array(found) - before).max() < part * scale

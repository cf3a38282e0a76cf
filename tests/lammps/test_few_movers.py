"""Balanced contacts where only a few rings of many move."""

import numpy as np
import pytest
from contact_rows import of_compute_pair
from laws import BALANCED
from materials import radii_of
from moved import Moved
from scene import PACKINGS, Scene

TOLERANCE = 1e-8
COPIES = 10  # of a packing of 24 in each direction: several blocks of 512 rings
MOVERS = (2, 9, 20)  # of one copy
# ranks, their grid, and how far the rings that move are from the border of two ranks
CASES = [(1, "1 1 1", 0), (2, "2 1 1", 1), (2, "1 2 1", 0)]


@pytest.mark.parametrize(("ranks", "grid", "away"), CASES)
def test_few_rings_that_move(ranks, grid, away, tmp_path):
    """The forces are those of the same places from scratch; away from the border of two ranks."""
    copy = (COPIES // 2 + away) * (COPIES + 1)
    movers = [len(PACKINGS[0]["x"]) * copy + rest for rest in MOVERS]
    moved = Moved(
        ranks,
        tmp_path,
        grid=grid,
        copies=COPIES,
        movers=" ".join(map(str, movers)),
        temperature=1e-3,
        steps=12,
        tolerance=TOLERANCE,
    )
    assert moved.evaluations[1:].max() <= 5  # forces have no history at first
    assert moved.evaluations[4:].max() <= 4
    assert moved.error <= 10 * TOLERANCE


def test_two_rings_that_touch_alone():
    """All rings shrink until none touches; then two are large again. No force tells compliances."""
    case = PACKINGS[0]
    radii = radii_of(case)
    style = f"{BALANCED} radius atom"
    scene = Scene.packing(case, style, ("any", "any"), radii=radii)
    scene.run("unfix shape\nneighbor 0.5 bin\nreplicate 8 8 1\nrun 8 post no")
    atoms = scene.lmp.numpy
    radius, ids, x = (atoms.extract_atom(name) for name in ("radius", "id", "x"))
    large = np.array(radius).ravel()
    middle = scene.lmp.extract_setting("nlocal") // 2
    gap = np.hypot(*(x - x[middle])[:, :2].T) - large - large[middle]
    gap[ids == ids[middle]] = np.inf
    two = np.isin(ids, [ids[middle], ids[np.argmin(gap[: 2 * middle])]])
    for touching in (two & False, two):
        radius[:] = np.where(touching, large, 0.7 * large).reshape(np.shape(radius))
        scene.run("run 1 pre no post no")
    evaluations, imbalance = of_compute_pair(scene)
    assert evaluations <= 3
    assert imbalance <= 1e-8

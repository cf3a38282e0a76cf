"""Which contacts of droplets are found: those that bulges reach, up to the bound of their load.

Beside the droplets there is one far away, so small that no margin of the list of near pairs helps
to find them.
"""

import numpy as np
import pytest
from deformable import core
from droplet_walls import SIDE, at_walls, faces
from droplets import CASES, Droplets, dense

M = 0.269  # at this cosine from a contact droplets bulge most
ANGLE = np.arange(3) * 2 * np.pi / 3


def around(turned, m):
    """Three unit vectors at the cosine m from z."""
    flat = np.sqrt(1 - m * m) * np.array([np.cos(ANGLE + turned), np.sin(ANGLE + turned)])
    return np.column_stack([*flat, np.full(3, m)])


def test_a_wall_that_only_the_largest_bulge_reaches(tmp_path):
    """Three walls push a droplet against a fourth one, across a gap of 0.98 of the bound."""
    normals, gap = np.vstack([around(0.0, M), [0, 0, 1]]), 0.115
    force = 8 * np.pi * 0.1 / 3
    near = core.droplet(normals, [force] * 3 + [0]).indentation
    assert 1.1 * 0.1 < gap < -near[3] < 1.177 * 0.1
    case = {"x": [[0, 0, 0], [0, 0, -3]], "box": [SIDE] * 3, "low": -0.5 * SIDE}
    case |= {"radius": [1.0, 0.01], "tension": [1.0, 1.0]}
    walls = faces(normals, [*(1 - near[:3]), 1 + gap])
    rows = at_walls(Droplets(case, tmp_path, commands=walls, boundary="f f f"))
    assert len(rows) == 4
    assert rows[:, 2].min() == pytest.approx(-gap)
    theory = core.droplet(rows[:, 8:11], rows[:, 4])
    assert theory.indentation == pytest.approx(rows[:, 2], abs=1e-9)


def pushed(distance, gap):
    """Two droplets, each pushed toward the other by three others."""
    top = np.array([0, 0, 2 + gap])
    below, above = distance * around(0.0, M), top + distance * around(np.pi / 3, -M)
    x = np.vstack([np.zeros(3), top, below, above, [4, 4, -4]])
    case = {"x": x, "box": [12.0] * 3, "low": -6.0}
    return case | {"radius": [1.0] * 8 + [0.01], "tension": [1.0] * 9}


def test_a_gap_that_both_bulges_fill(tmp_path):
    """It is 0.96 of the bound. Before, bulges were smaller."""
    case = pushed(1.8, 0.105)
    energy, force, contacts = dense(case)
    assert np.count_nonzero(contacts) == 7
    scene = Droplets(pushed(1.9, 0.105), tmp_path)
    assert len(scene.contacts()) == 12
    assert scene.energy_at(case["x"]) == pytest.approx(energy, rel=1e-11)
    assert scene.force == pytest.approx(force, abs=1e-10)
    rows = scene.contacts()
    assert rows[(rows[:, 0] == 1) & (rows[:, 1] == 2), 11] == pytest.approx([2.105])


@pytest.mark.parametrize("number", [0, 1, 3])
def test_newtons_method_squares_its_error(number, tmp_path):
    """From forces that know nothing of each other, by the compliances of all."""
    assert Droplets(CASES[number], tmp_path).outputs()[2] <= 4

"""Which contacts of droplets are found: those that bulges reach, up to the bound of their load.

Beside the droplets there is one far away, so small that no margin of the list of near pairs helps
to find them.
"""

import numpy as np
import pytest
from droplet_walls import CUBE, ORIGIN, SCENES, SIDE, at_walls, faces, walled
from droplets import CASES, EXACT, Droplets, dense
from lammps_deformable import core
from polyhedra import FACES

M = 0.269  # at this cosine from a contact droplets bulge most
ANGLE = np.arange(3) * 2 * np.pi / 3


def around(turned, m):
    """Three unit vectors at the cosine m from z."""
    flat = np.sqrt(1 - m * m) * np.array([np.cos(ANGLE + turned), np.sin(ANGLE + turned)])
    return np.column_stack([*flat, np.full(3, m)])


def test_a_wall_that_only_the_largest_bulge_reaches(tmp_path):
    """Three walls push a droplet against a fourth one, across a gap of 0.95 of the bound."""
    normals, gap = np.vstack([around(0.0, M), [0, 0, 1]]), 0.01118
    force = 8 * np.pi * 0.01 / 3
    near = core.droplet(normals, [force] * 3 + [0]).indentation
    assert 1.1 * 0.01 < gap < -near[3] < 1.177 * 0.01
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
    """It is 0.95 of the bound. Before, bulges were smaller."""
    case = pushed(1.95, 0.01677)
    energy, force, contacts = dense(case)
    assert np.count_nonzero(contacts) == 7
    scene = Droplets(pushed(1.98, 0.01677), tmp_path)
    assert len(scene.contacts()) == 12
    assert scene.energy_at(case["x"]) == pytest.approx(energy, rel=1e-11)
    assert scene.force == pytest.approx(force, abs=1e-10)
    rows = scene.contacts()
    assert rows[(rows[:, 0] == 1) & (rows[:, 1] == 2), 11] == pytest.approx([2.01677])


@pytest.mark.parametrize("number", [0, 3])
def test_corrections_are_nearly_those_of_newtons_method(number, tmp_path):
    """From no forces at all, to 1e-12. They leave out what facets that move do to compliances."""
    assert Droplets(CASES[number], tmp_path).outputs()[2] <= 18


def test_droplets_that_grow_meet(tmp_path):
    """At rest, between two neighbor lists, so that only their radii say that they are near."""
    case = {"x": [[3, 3, 3], [3, 3, 5.6]], "box": [12.0] * 3}
    case |= {"radius": [1.4] * 2, "tension": [1.0] * 2}
    scene = Droplets(
        case,
        tmp_path,
        style=f"{EXACT} radius atom",
        atoms="sphere 1",
        commands="set group all diameter 2\nneigh_modify every 1000 delay 0 check no\n",
    )
    assert scene.energy == 0.0
    scene.run("variable size equal 2+0.08*step\nfix grow all adapt 1 atom diameter v_size\nrun 9")
    grown = scene.energy
    scene.run("unfix grow\nrun 0")
    assert grown == pytest.approx(scene.energy, rel=1e-11)
    assert grown > 1e-3


def test_a_wall_that_comes_near(tmp_path):
    """To a droplet at rest, between two neighbor lists."""
    walls = "variable top equal 2-0.02*step\nfix walls all deformable/wall zlo -0.98 zhi v_top\n"
    case = {"x": [[0, 0, 0]], "box": [SIDE] * 3, "low": -0.5 * SIDE}
    case |= {"radius": [1.0], "tension": [1.0]}
    once = "neigh_modify every 1000 delay 0 check no\n"
    scene = Droplets(case, tmp_path, commands=walls + once, boundary="f f f")
    scene.run("fix still all move linear 0 0 0\nrun 51")
    rows = at_walls(scene)
    assert rows[:, 11] == pytest.approx([0.98, 0.98])
    assert core.droplet(rows[:, 8:11], rows[:, 4]).indentation == pytest.approx([0.02] * 2)


@pytest.mark.parametrize(
    ("name", "load", "beyond"),
    [("bcc", 0.39, 0), ("bcc", 0.41, 1), ("sc", 0.29, 0), ("sc", 0.31, 1)],
)
def test_loads_up_to_the_end_of_the_model(name, load, beyond, tmp_path):
    """Beyond 0.4, or 0.05 of each contact, the droplet counts as one of those."""
    count = len(FACES[name])
    at = core.droplet(FACES[name], np.full(count, 8 * np.pi * load / count)).indentation[0]
    scene = walled(ORIGIN, faces(FACES[name], 1 - at), tmp_path)
    assert at_walls(scene)[:, 4].sum() / (8 * np.pi) == pytest.approx(load)
    assert scene.outputs()[0] == beyond


def test_reach_of_all(tmp_path):
    """A load needs its bulge as reach, and no more; the share that is used is said."""
    load = 0.2
    at = core.droplet(FACES["sc"], np.full(6, 8 * np.pi * load / 6)).indentation[0]
    walls = faces(FACES["sc"], 1 - at)
    scene = walled(ORIGIN, walls, tmp_path, style=f"{EXACT} reach 0.24")
    assert scene.outputs()[1] == pytest.approx(1.177 * load / 0.24)
    with pytest.raises(Exception, match=r"load of atom 1 is 0\.2, but 'reach 0.23' covers"):
        walled(ORIGIN, walls, tmp_path, style=f"{EXACT} reach 0.23")


def test_energies_of_droplets_are_those_of_all(tmp_path):
    """However well contacts are balanced: what is left of overlaps is shared, too."""
    scene = walled(CUBE, SCENES["block"], tmp_path, style="deformable/droplet balance 0.1 100")
    assert scene.outputs()[3] > 1e-6
    assert scene.sums()[0] == pytest.approx(scene.energy, rel=1e-13)


# Plates press a droplet, so that its sides bulge by 0.02.
PRESSED = {"x": [[0, 0, 0], [0, 3, 3]], "box": [SIDE] * 3, "low": -0.5 * SIDE}
PRESSED |= {"radius": [1.0, 0.01], "tension": [1.0, 1.0]}
PLATES = "group one id 1\nfix plates one deformable/wall zlo -0.9 zhi 0.9\n"
ONCE = "neigh_modify every 1000 delay 0 check no\nfix still all move linear 0 0 0\n"


def test_a_wall_that_comes_near_a_bulge(tmp_path):
    """Across a gap, between two neighbor lists."""
    walls = "variable side equal 1.05-0.005*step\nfix walls one deformable/wall xhi v_side\n"
    scene = Droplets(PRESSED, tmp_path, commands=PLATES + walls + ONCE, boundary="f f m")
    assert len(at_walls(scene)) == 2
    scene.run("run 7")
    rows = at_walls(scene)
    assert sorted(rows[:, 11]) == pytest.approx([0.9, 0.9, 1.015])
    assert core.droplet(rows[:, 8:11], rows[:, 4]).indentation == pytest.approx(rows[:, 2])


def test_work_across_a_gap(tmp_path):
    """A ball that moves toward the side of a droplet gives it energy before they would touch."""
    walls = "variable place equal 1.53-0.0005*step\n"
    walls += "region walls sphere v_place 0 0 0.5 side out\nfix walls one deformable/wall walls\n"
    scene = Droplets(PRESSED, tmp_path, commands=PLATES + walls + ONCE, boundary="f f m")
    before = scene.energy
    scene.run("run 60")
    given = scene.lmp.extract_fix("walls", 0, 0)
    assert at_walls(scene)[:, 11].max() == pytest.approx(1.0)
    assert scene.energy > 1.001 * before
    assert given == pytest.approx(before - scene.energy, rel=1e-2)


def test_droplets_that_move_toward_each_other(tmp_path):
    """Both of them, so that a part of what the list has to spare belongs to each."""
    case = {"x": [[0, 0, -1.055], [0, 0, 1.055]], "box": [12.0] * 3, "low": -6.0}
    case |= {"radius": [1.0, 1.0], "tension": [1.0, 1.0]}
    scene = Droplets(case, tmp_path, commands="neigh_modify every 1000 delay 0 check no")
    scene.run("group one id 1\ngroup two id 2\ntimestep 0.01\nfix up one move linear 0 0 1")
    scene.run("fix down two move linear 0 0 -1\nrun 7")
    found = scene.energy
    scene.run("run 0")
    assert found == pytest.approx(scene.energy, rel=1e-11)
    assert found > 1e-5

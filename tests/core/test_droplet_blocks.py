"""Second derivatives of the energy of a droplet, against differences of first derivatives."""

import numpy as np
import pytest
from lammps_deformable import core
from polyhedra import random_normals
from scipy.optimize import brentq
from test_droplet_kernel import changes

RADIUS, TENSION = 1.3, 0.7
WALLS = {"neighbors": None, "flat": 0.0, "outside": 0.6, "inside": -0.4}


def scene(z, wall, seed):
    """Sides of one droplet with these forces, the first one of a wall: rows of `droplet_blocks`."""
    rng = np.random.default_rng(seed)
    distance = rng.uniform(1.8, 3.0, z)
    sides = np.zeros((z, 6))
    sides[:, :3] = distance[:, None] * random_normals(z, seed)
    sides[:, 3], sides[:, 4] = 1.0 / distance, 0.5
    sides[:, 5] = rng.uniform(0.05, 1.0, z)
    sides[:, 5] *= 8 * np.pi * 0.1 * RADIUS * TENSION / sides[:, 5].sum()  # of the load 0.1
    if wall is not None:
        sides[0, 3:5] = wall, 1.0
    return sides


def indentations(sides):
    return core.droplet(sides[:, :3], sides[:, 5], RADIUS, TENSION).indentation


def moved(sides, step):
    """The sides after a step of their variables: vectors, indentations and with them forces."""
    new, step = sides.copy(), step.reshape(-1, 4)
    new[:, :3] += step[:, :3]
    new[:, 3] = 1.0 / np.linalg.norm(new[:, :3], axis=1)
    for n in np.flatnonzero(sides[:, 4] == 1.0):
        old, distance = sides[n, :3], np.linalg.norm(sides[n, :3])
        normal, lever = old / distance, np.inf
        vector = normal * (distance + normal @ step[n, :3])
        if sides[n, 3] != 0.0:  # the vector to a center, about which it turns
            lever = 1.0 / sides[n, 3]
            arm = normal * lever + step[n, :3]
            vector = arm - arm / np.linalg.norm(arm) * np.sign(lever) * (lever - distance)
            lever = np.sign(lever) * np.linalg.norm(arm)
        new[n, :3], new[n, 3] = vector, 1.0 / lever
    closer = [np.linalg.norm(each[:, :3], axis=1) for each in (sides, new)]
    wanted = indentations(sides) + sides[:, 4] * (closer[0] - closer[1]) + step[:, 3]
    for _ in range(20):
        there = core.droplet(new[:, :3], new[:, 5], RADIUS, TENSION)
        new[:, 5] += np.linalg.solve(there.compliance, wanted - there.indentation)
    return new


def blocks(sides):
    return core.droplet_blocks([[len(sides), RADIUS, TENSION]], sides)


def dense(found):
    row, column, value = found.hessian()
    matrix = np.zeros((found.gradient.size,) * 2)
    np.add.at(matrix, (row, column), value)
    return matrix


@pytest.mark.parametrize(
    ("z", "wall"), [(1, "flat"), (2, "inside"), (7, "outside"), (13, "neighbors"), (13, "flat")]
)
def test_derivatives(z, wall):
    sides = scene(z, WALLS[wall], seed=z)
    found, droplet = blocks(sides), core.droplet(sides[:, :3], sides[:, 5], RADIUS, TENSION)
    assert found.energy == pytest.approx(droplet.energy, rel=1e-13)
    assert found.gradient[3::4] == pytest.approx(sides[:, 5], rel=1e-15)
    start = np.zeros(4 * z)
    first = changes(lambda x: blocks(moved(sides, x)).energy, start, 1e-4)
    assert found.gradient == pytest.approx(first, abs=1e-10 * np.abs(first).max())
    second = changes(lambda x: blocks(moved(sides, x)).gradient, start, 1e-4)
    matrix = dense(found)
    assert matrix == pytest.approx(matrix.T, abs=1e-14 * np.abs(matrix).max())
    assert matrix == pytest.approx(second, abs=1e-8 * np.abs(second).max())


def test_droplets_come_one_after_the_other():
    one, two = scene(5, None, 1), scene(8, None, 2)
    both = core.droplet_blocks(
        [[5, RADIUS, TENSION], [0, 1.0, 1.0], [8, RADIUS, TENSION]], np.vstack([one, two])
    )
    assert both.energy == pytest.approx(blocks(one).energy + blocks(two).energy)
    matrix = dense(both)
    assert (matrix[:20, :20] == dense(blocks(one))).all()
    assert (matrix[20:, 20:] == dense(blocks(two))).all()
    assert not matrix[20:, :20].any()


def test_errors():
    for droplet, change, message in (
        ([6, 1, 1], {}, "fewer rows"),
        ([4, 1, 1], {}, "more rows"),
        ([5, 0, 1], {}, "radius of droplet 0"),
        ([5, 1, np.inf], {}, "tension of droplet 0"),
        ([5, 1, 1], {(2, 0): np.nan}, "vector 2"),
        ([5, 1, 1], {(4, 5): 0.0}, "force of side 4"),
    ):
        sides = scene(5, None, seed=1)
        for place, value in change.items():
            sides[place] = value
        with pytest.raises(ValueError, match=message):
            core.droplet_blocks([droplet], sides)
        with pytest.raises(ValueError, match="6 numbers"):
            core.droplet_blocks([droplet], sides[:, :5])


def test_a_droplet_that_moves_without_a_force():
    """Between two plates at a load of 0.145 the energy is not convex any more."""
    sides = np.array([[0, 0, 1.7, 0.6, 0.5, 1.0], [0, 0, -1.7, 0.6, 0.5, 1.0]])

    def difference(force):
        both = core.droplet(sides[:, :3], [force, force]).compliance[0]
        return both[0] - both[1]

    force = brentq(difference, 1.5, 2.0, xtol=1e-15)
    assert 2 * force / (8 * np.pi) == pytest.approx(0.145, abs=1e-3)
    sides[:, 5] = 1.01 * force
    assert np.isfinite(dense(core.droplet_blocks([[2, 1, 1]], sides))).all()
    sides[:, 5] = force
    with pytest.raises(ValueError, match="droplet 0 is beyond the model"):
        core.droplet_blocks([[2, 1, 1]], sides)

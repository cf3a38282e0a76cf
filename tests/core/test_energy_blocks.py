"""Second derivatives by the vectors to neighbors, against differences of first derivatives."""

from itertools import product

import numpy as np
import pytest
from lammps_deformable import core
from turns import in_turn

INF = float("inf")
# kA, kP, skin, tension
STIFFNESS = {
    "perimeter": (2.0, INF, 0.0, 0.0),
    "finite": (1.0, 0.3, 0.02, 0.0),
    "area": (INF, 1.0, 0.0, 0.0),
    "bubble": (1.0, 0.1, 0.0, 0.2),
    "droplet": (INF, 0.0, 0.0, 1.0),
}
VARIABLES = {"radical": 2, "balanced": 3}
WALLS = {"neighbors": None, "flat": 0.0, "corner": 1.0, "inside": -0.4}


def scene(law, stiffness, wall, seed):
    """One particle among five sides, all of them indented by 2 to 6 %, one of them a wall."""
    rng = np.random.default_rng(seed)
    angle = np.arange(5) * 2 * np.pi / 5 + rng.uniform(-0.2, 0.2, 5)
    sides = np.zeros((5, 5))
    sides[:, 3] = rng.uniform(0.6, 1.6, 5)
    if wall is not None:
        sides[2, 3] = 0.0
    distance = 1.0 + sides[:, 3] - rng.uniform(0.04, 0.12, 5) * np.where(sides[:, 3], 1.0, 0.5)
    sides[:, 0], sides[:, 1] = distance * np.cos(angle), distance * np.sin(angle)
    sides[:, 2] = 1.0 / distance
    if wall is not None:
        sides[2, 2] = wall / distance[2]
    if law != "radical":
        sides[:, 4] = rng.uniform(-0.01, 0.01, 5)
    kA, kP, skin, tension = STIFFNESS[stiffness]
    return np.array([[5, 1.0, kA, kP, skin, tension]]), sides


def moved(sides, law, step):
    """The sides after a step of the local variables; a wall's direction turns as it is curved."""
    new, step = sides.copy(), step.reshape(5, -1)
    new[:, :2] += step[:, :2]
    new[:, 2] = 1.0 / np.hypot(*new[:, :2].T)
    new[:, 4 : 2 + VARIABLES[law]] += step[:, 2:]
    for n in np.flatnonzero(sides[:, 3] == 0.0):
        old, distance = sides[n, :2], np.hypot(*sides[n, :2])
        normal = old / distance
        if sides[n, 2] == 0.0:  # a flat wall
            vector = normal * (distance + normal @ step[n, :2])
        else:  # the vector to the center of a circle of this radius, about which it turns
            lever = 1.0 / sides[n, 2]
            arm = normal * lever + step[n, :2]
            vector = arm - arm / np.hypot(*arm) * np.sign(lever) * (lever - distance)
            new[n, 2] = np.sign(lever) / np.hypot(*arm)
        new[n, :2] = vector
        new[n, 2] = 0.0 if sides[n, 2] == 0.0 else new[n, 2]
    return new


def gradient(law, particles, sides):
    return core.ring_blocks(law, particles, sides).gradient


def dense(blocks):
    row, column, value = blocks.hessian()
    found = np.zeros((blocks.gradient.size,) * 2)
    np.add.at(found, (row, column), value)
    return found


def differences(function, size, step):
    """Central differences along each variable, with an error of the fourth order."""
    columns = []
    for direction in np.eye(size):
        near, far = (
            (function(h * direction) - function(-h * direction)) / (2 * h) for h in (step, 2 * step)
        )
        columns.append((4 * near - far) / 3)
    return np.array(columns)


# each law with each stiffness, and the walls in turn
CASES = in_turn(product(VARIABLES, STIFFNESS), WALLS)


@pytest.mark.parametrize(("law", "stiffness", "wall"), CASES)
def test_ring(law, stiffness, wall):
    particles, sides = scene(law, stiffness, WALLS[wall], seed=len(law + stiffness + wall))
    blocks, size = core.ring_blocks(law, particles, sides), 5 * VARIABLES[law]
    assert (blocks.force > 0).all()

    def energy(step):
        return core.ring_blocks(law, particles, moved(sides, law, step)).energy

    first = differences(energy, size, 1e-4)
    scale = np.abs(blocks.gradient).max()
    assert blocks.gradient == pytest.approx(first, abs=1e-8 * scale)
    second = differences(lambda step: gradient(law, particles, moved(sides, law, step)), size, 1e-5)
    found = dense(blocks)
    assert found == pytest.approx(found.T, abs=1e-15 * np.abs(found).max())
    assert found == pytest.approx(second, abs=1e-8 * np.abs(second).max())


@pytest.mark.parametrize("stiffness", ["finite", "bubble", "area"])
@pytest.mark.parametrize("law", VARIABLES)
def test_parameters(law, stiffness):
    """kA, kP, skin and tension as variables, beside a wall."""
    particles, sides = scene(law, stiffness, 0.0, seed=3)
    blocks = core.ring_blocks(law, particles, sides, parameters=True)
    alone = core.ring_blocks(law, particles, sides)
    assert blocks.energy == alone.energy
    own, size = 5 * 5, blocks.gradient.size
    assert size == own + 6
    found = dense(blocks)
    assert found == pytest.approx(found.T, abs=1e-14 * np.abs(found).max())
    for column, variable in ((2, 1), (3, 2), (4, 3), (5, 4)):
        value = particles[0, column]
        if value in (0.0, INF):
            continue
        h = 1e-4 * value
        ends = [
            core.ring_blocks(law, particles + step * np.eye(6)[column], sides, parameters=True)
            for step in (-h, h)
        ]
        slope = (ends[1].energy - ends[0].energy) / (2.0 * h)
        assert blocks.gradient[own + variable] == pytest.approx(slope, rel=1e-6)
        rates = (ends[1].gradient - ends[0].gradient) / (2.0 * h)
        assert found[own + variable] == pytest.approx(rates, abs=1e-6 * np.abs(rates).max())


def test_contacts_that_bear_nothing_have_no_part():
    particles, sides = scene("radical", "finite", None, seed=1)
    sides[1, :2] *= 1.5
    sides[1, 2] /= 1.5
    blocks = core.ring_blocks("radical", particles, sides)
    assert blocks.force[1] == 0
    found = dense(blocks)
    assert not found[2:4].any()
    assert not blocks.gradient[2:4].any()
    without = core.ring_blocks("radical", particles - np.eye(6)[0], np.delete(sides, 1, 0))
    assert blocks.energy == pytest.approx(without.energy, rel=1e-13)


@pytest.mark.parametrize("stiffness", ["finite", "droplet"])
def test_curved_lines_that_are_straight(stiffness):
    """Energy, and derivatives by shifts, as those of balanced lines at the same places."""
    particles, sides = scene("balanced", stiffness, None, seed=7)
    balanced = core.ring_blocks("balanced", particles, sides)
    angle = np.arctan2(sides[:, 1], sides[:, 0])
    given = np.column_stack([sides[:, :4], balanced.force, angle, np.zeros(5)])
    curved = core.curved_blocks(particles, given)
    assert curved.energy == pytest.approx(balanced.energy, rel=1e-11)
    assert (curved.force == balanced.force).all()
    assert curved.gradient[2::5] == pytest.approx(balanced.gradient[2::3], rel=1e-12)
    found, expected = dense(curved), dense(balanced)[2::3, 2::3]
    assert found == pytest.approx(found.T, abs=1e-14 * np.abs(found).max())
    assert found[2::5, 2::5] == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


def test_curved_lines_that_bear_nothing_have_no_part():
    particles, sides = scene("balanced", "finite", None, seed=7)
    given = np.column_stack([sides[:, :4], np.zeros((5, 3))])
    blocks = core.curved_blocks(particles, given)
    assert blocks.energy == 0.0
    assert not dense(blocks).any()
    assert not blocks.gradient.any()


def test_disks():
    """A neighbor, a flat and a round wall: U = o^2/2."""
    rng = np.random.default_rng(2)
    x, y = rng.uniform(0.5, 0.8, (2, 3))
    turns = np.array([1.0 / np.hypot(x[0], y[0]), 0.0, 1.3])
    blocks = core.disk_blocks(np.column_stack([x, y]), turns, np.full(3, 1.2))
    overlap, direction = 1.2 - np.hypot(x, y), np.column_stack([x, y]) / np.hypot(x, y)[:, None]
    assert blocks.energy == pytest.approx(0.5 * np.sum(overlap**2))
    assert blocks.gradient.reshape(3, 3)[:, :2] == pytest.approx(-overlap[:, None] * direction)
    assert blocks.gradient[2::3] == pytest.approx(overlap)
    across = direction[:, ::-1] * [-1, 1]
    exact = np.einsum("ca,cb->cab", direction, direction)
    exact -= (overlap * turns)[:, None, None] * np.einsum("ca,cb->cab", across, across)
    found = dense(blocks)
    for c in range(3):
        block = found[3 * c : 3 * c + 3, 3 * c : 3 * c + 3]
        assert block[:2, :2] == pytest.approx(exact[c])
        assert block[2] == pytest.approx([*-direction[c], 1.0])
    assert np.count_nonzero(found) == 27
    with pytest.raises(ValueError, match="vector 0"):
        core.disk_blocks([[0.0, 0.0]], [1.0], [1.0])
    with pytest.raises(ValueError, match="contact"):
        core.disk_blocks([[1.0, 0.0]], [1.0], [1.0, 1.0])


def test_errors():
    for change, message in (
        ({"law": "sector"}, "sector"),
        ({"particles": [[6, 1, 1, 1, 0, 0]]}, "fewer rows"),
        ({"particles": [[4, 1, 1, 1, 0, 0]]}, "more rows"),
        ({"particles": [[np.nan, 1, 1, 1, 0, 0]]}, "particle 0"),
        ({"particles": [[5, 1, -1, 1, 0, 0]]}, "kA"),
        ({"sides": np.zeros((5, 4))}, "5 numbers"),
        ({"sides": np.full((5, 5), [0.1, 0, 10, 1.5, 0])}, "side 0"),
    ):
        particles, sides = scene("radical", "finite", None, seed=1)
        given = {"law": "radical", "particles": particles, "sides": sides} | change
        with pytest.raises(ValueError, match=message):
            core.ring_blocks(**given)

"""Forces and virials are the derivatives of the energy."""

import numpy as np
import pytest
from scene import PACKINGS, Scene, box_walls

STEP = 1e-6
BOX = (-3, 3, -3, 3)


def assert_forces(scene, x, step=STEP):
    """Central differences for every coordinate, to 1e-7 of the largest force.

    F ~ a^3 with indentations a ~ 0.01: the third derivative leaves step^2/a^2 = 1e-8. Rounding
    leaves 1e-16 U/step, and U is about F a: 1e-12.
    """
    force = scene.evaluate(x).force
    numerical = np.zeros_like(force)
    for index in np.ndindex(x.shape):
        up, down = x.copy(), x.copy()
        up[index] += step
        down[index] -= step
        numerical[index] = -(scene.energy(up) - scene.energy(down)) / (2 * step)
    np.testing.assert_allclose(force, numerical, rtol=0, atol=1e-7 * np.abs(force).max())
    return force


PAIRS = {
    "sector": ("sector", ("small", "large")),
    "sector, two stiffnesses": ("sector", ("small", "soft")),
    "sector, area conserved": ("sector", ("fixed", "fixedlarge")),
    "sector, one of each": ("sector", ("fixed", "large")),
    "radical": ("ring contact radical", ("small", "large")),
    "radical, two stiffnesses": ("ring contact radical", ("small", "soft")),
    "radical, finite stiffness": ("ring contact radical", ("both", "bothlarge")),
    "radical, area conserved": ("ring contact radical", ("fixed", "fixedlarge")),
    "radical, a skin beside kP = inf": ("ring contact radical", ("small", "skinned")),
}
pairs = pytest.mark.parametrize(("law", "species"), PAIRS.values(), ids=PAIRS)


@pairs
def test_packing(law, species):
    """Particles pushed off their places by up to a per cent of their size."""
    case = PACKINGS[1]  # loose enough for sectors that keep their area
    scene = Scene.packing(case, f"deformable/{law}", species)
    push = np.random.default_rng(1).uniform(-0.005, 0.005, (case["N"], 2))
    assert_forces(scene, np.array(case["x"]) + push)


def test_one_contact():
    """A pair with one contact each, and a chain whose ends have one and whose middle has two."""
    x = np.array([[-2, -1], [-1.1, -0.9], [-1.5, 1], [-0.6, 1.2], [0.28, 0.9]])
    species = ["small", "small", "small", "small", "small"]
    force = assert_forces(Scene(x, species, BOX, "deformable/sector"), x)
    assert (np.hypot(*force.T) > 1e-3).all()


@pytest.mark.parametrize("other", ["small", "large", "soft", "fixedlarge"])
def test_one_contact_is_a_soft_disk(other):
    """U = k/2 (1 - d/(R_i + R_j))^2, once a pair, k the mean of both."""
    radius = 0.5 if other == "small" else 0.7
    k = {"soft": 0.3, "fixedlarge": 2.0}.get(other, 1.0)
    x = np.array([[0, 0], [0.6, 0.8]]) * 0.95 * (0.5 + radius)
    scene = Scene(x, ["small", other], BOX, "deformable/sector")
    assert scene.energy() == pytest.approx(0.5 * (1 + k) / 2 * 0.05**2, rel=1e-12)
    assert_forces(scene, x)


WALLS = {
    "flat": box_walls(-0.965, 0.97, -0.96, 0.967),
    "round": """
        region walls cylinder z 0 0 1.16 -0.5 0.5
        fix walls all deformable/wall walls""",
    "a round pillar": """
        region walls cylinder z 0 0 0.2 -0.5 0.5 side out
        fix walls all deformable/wall walls""",
    "round and flat": """
        region round cylinder z 0 0 1.16 -0.5 0.5
        region flat block -0.965 EDGE EDGE EDGE EDGE EDGE
        fix round all deformable/wall round
        fix flat all deformable/wall flat""",
}


@pytest.mark.parametrize("walls", WALLS.values(), ids=WALLS)
@pytest.mark.parametrize("law", ["sector", "ring contact radical reach 0.2"])
def test_walls(law, walls):
    """Four particles that touch each other and the wall."""
    x = np.array([[-0.481, -0.477], [0.483, -0.479], [0.478, 0.482], [-0.479, 0.479]])
    species = ["small", "small", "weak", "small"]
    scene = Scene(x, species, BOX, f"deformable/{law}", boundary="f f p", commands=walls)
    contacts = scene.evaluate().shape["contacts"]
    assert (contacts > 2).all()  # two neighbors and the wall
    assert_forces(scene, x)


def test_ring_where_a_contact_appears():
    """At the very position where the outline begins to touch a neighbor: no jump of the force."""
    case = PACKINGS[0]
    scene = Scene.packing(case, "deformable/ring contact radical")
    start = np.array(case["x"])
    direction = np.zeros_like(start)
    direction[3] = [0.6, 0.8]

    def contacts(s):
        return scene.evaluate(start + s * direction).shape["contacts"].sum()

    switches = 0
    path = np.linspace(-0.05, 0.05, 21)
    count = [contacts(s) for s in path]
    for low, high in [(path[k], path[k + 1]) for k in range(20) if count[k] != count[k + 1]]:
        below = contacts(low)
        while high - low > 1e-14:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if contacts(middle) == below else (low, middle)
        before, after = (scene.evaluate(start + s * direction).force for s in (low, high))
        largest = np.abs(before).max()
        np.testing.assert_allclose(before, after, rtol=0, atol=1e-10 * largest)

        # The slope of the force has a kink here. It changes by p dL/da ~ 4 kA S, about 10 F, which
        # the difference averages: an error of 10 step/4 of F. The rounding of U ~ F a/4 is less.
        step = 1e-8
        numerical = (
            scene.energy(start + (low - step) * direction)
            - scene.energy(start + (low + step) * direction)
        ) / (2 * step)
        assert (before * direction).sum() == pytest.approx(numerical, abs=1e-7 * largest)
        switches += 1
    assert switches >= 5


def test_ring_work_along_a_path_of_switching_contacts():
    """The integral of the force is the energy difference, whichever contacts come and go."""
    case = PACKINGS[1]
    scene = Scene.packing(case, "deformable/ring contact radical")
    start = np.array(case["x"])
    direction = np.random.default_rng(3).normal(size=start.shape)
    path, step = np.linspace(0, 0.03, 1201, retstep=True)
    states = [scene.evaluate(start + s * direction) for s in path]
    assert len({tuple(state.shape["contacts"]) for state in states}) > 10

    slope = np.array([(state.force * direction).sum() for state in states])
    work = step * (slope.sum() - 0.5 * (slope[0] + slope[-1]))
    # the trapezoid rule errs by step^2/12 times the change of the force's own slope
    error = step**2 / 12 * np.abs(np.diff(slope, 2)).sum() / step
    assert work == pytest.approx(states[0].energy - states[-1].energy, abs=2 * error)


STRAINS = {
    "isotropic": np.eye(2),
    "xx": np.diag([1.0, 0.0]),
    "yy": np.diag([0.0, 1.0]),
    "xy": np.array([[0.0, 1.0], [0.0, 0.0]]),
}


def assert_virial(scene, length, strain):
    """Central differences for a strain of a box of width and height `length`, to 1e-7."""
    virial = scene.evaluate().virial
    (xx, yy, xy), energy = virial, {}
    for step in (STEP, -STEP):
        h = np.eye(2) + step * strain
        scene.run(
            f"change_box all x final 0 {length * h[0, 0]:.17g} y final 0 {length * h[1, 1]:.17g} "
            f"xy final {length * h[0, 1]:.17g} remap units box"
        )
        energy[step] = scene.energy()
        back = f"x final 0 {length} y final 0 {length} xy final 0"
        scene.run(f"change_box all {back} remap units box")
    numerical = -(energy[STEP] - energy[-STEP]) / (2 * STEP)
    expected = np.sum(strain * np.array([[xx, xy], [xy, yy]]))
    # strains of 1e-6 move contacts by 1e-6: as for forces
    assert numerical == pytest.approx(expected, abs=1e-7 * np.abs(virial).max())


@pairs
@pytest.mark.parametrize("strain", STRAINS.values(), ids=STRAINS)
def test_virial_is_the_response_to_strain(law, species, strain):
    case = PACKINGS[1]
    assert_virial(Scene.packing(case, f"deformable/{law}", species, tilt=0.0), case["L"], strain)

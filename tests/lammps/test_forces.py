"""Forces and virials of all laws and materials are the derivatives of the energy."""

import numpy as np
import pytest
from derivatives import assert_forces, assert_virial
from laws import DIRECT, EXACT, LAWS, RADICAL, RING_LAWS, ring_laws
from materials import packing, pushed
from scene import BOX, FOUR, PACKINGS, ROOM_OF_FOUR, Scene
from turns import in_turn

CASE = PACKINGS[1]  # loose enough for sectors that keep their area; it has rattlers
SCENES = [
    *(("sector", material) for material in ("two stiffnesses", "one of each", "radii of atoms")),
    *(("radical", material) for material in ("rings", "all species", "radii of atoms")),
    *(("balanced", material) for material in ("all species", "soft radii of atoms")),
    *(("curved", material) for material in ("rings", "all species")),
]
scenes = pytest.mark.parametrize(("law", "material"), SCENES)


@scenes
def test_forces(law, material):
    assert_forces(packing(CASE, EXACT[law], material), pushed(CASE))


@pytest.mark.parametrize(("law", "material"), [case for case in SCENES if "atoms" not in case[1]])
def test_virial_is_the_response_to_strain(law, material):
    scene = packing(CASE, EXACT[law], material, tilt=0.0)
    scene.x = pushed(CASE)
    assert_virial(scene, CASE["L"])


@pytest.mark.parametrize(("law", "material"), SCENES[1::3])
def test_sums(law, material):
    """Of energies, forces and virials, with either way in which LAMMPS adds the virial.

    They are sums of 24 particles' worth of rounded terms; others are of forces in balance to 1e-12.
    """
    state, by_pairs = (
        packing(CASE, EXACT[law], material, commands=words).evaluate(pushed(CASE))
        for words in ("", "pair_modify nofdotr")
    )
    rounding = 1e-14 if law in DIRECT else 1e-13
    assert state.atom_energy.sum() == pytest.approx(state.energy, rel=rounding)
    atol = 10 * rounding * np.abs(state.atom_virial).max()
    np.testing.assert_allclose(state.atom_virial.sum(0), state.virial, rtol=0, atol=atol)
    np.testing.assert_allclose(by_pairs.virial, state.virial, rtol=0, atol=atol)
    assert np.abs(state.force.sum(0)).max() <= rounding * np.abs(state.force).sum()


@ring_laws
def test_state_without_memory(law):
    """The state depends on the present positions only."""
    case = PACKINGS[0]
    x, scene = pushed(case), packing(case, EXACT[law], "all species")
    fresh = packing(case, EXACT[law], "all species").evaluate(x)
    rng = np.random.default_rng(5)
    for size in (0.05, 0.02, 0.06):
        scene.evaluate(np.array(case["x"]) + rng.uniform(-size, size, x.shape))
    again = scene.evaluate(x)
    assert again.energy == pytest.approx(fresh.energy, rel=1e-12)
    largest = np.abs(fresh.force).max()
    np.testing.assert_allclose(again.force, fresh.force, rtol=0, atol=1e-10 * largest)


# ---- single contacts of the sector law ----


def test_one_contact():
    """A pair with one contact each, and a chain whose ends have one and whose middle has two."""
    x = np.array([[-2, -1], [-1.1, -0.9], [-1.5, 1], [-0.6, 1.2], [0.28, 0.9]])
    force = assert_forces(Scene(x, ["small"] * 5, BOX, LAWS["sector"]), x)
    assert (np.hypot(*force.T) > 1e-3).all()


@pytest.mark.parametrize("other", ["soft", "fixedlarge"])
def test_one_contact_is_a_soft_disk(other):
    """U = k/2 (1 - d/(R_i + R_j))^2, once a pair, k the mean of both."""
    radius, k = 0.7, {"soft": 0.3, "fixedlarge": 2.0}[other]
    x = np.array([[0, 0], [0.6, 0.8]]) * 0.95 * (0.5 + radius)
    scene = Scene(x, ["small", other], BOX, LAWS["sector"])
    assert scene.energy() == pytest.approx(0.5 * (1 + k) / 2 * 0.05**2, rel=1e-12)
    assert_forces(scene, x)


# ---- walls ----

WALLS = {
    "flat": ROOM_OF_FOUR,
    "round": """
        region walls cylinder z 0 0 1.16 -0.5 0.5
        fix walls all deformable/wall walls""",
    "a round pillar": """
        region walls cylinder z 0 0 0.2 -0.5 0.5 side out
        fix walls all deformable/wall walls""",
    "round and flat": """
        region round cylinder z 0 0 1.16 -0.5 0.5
        region flat block -0.965 EDGE EDGE EDGE EDGE EDGE
        fix walls all deformable/wall round
        fix flat all deformable/wall flat""",
}
RINGS, DROPLETS, ANY = "small weak both fixed", "drop small firm strong", "any any any any"
FOURS = [(law, kind) for law in RING_LAWS for kind in (RINGS, DROPLETS, ANY)]
FOURS += [("sector", kind) for kind in ("small small weak small", ANY)]
BETWEEN = in_turn(FOURS, WALLS)


@pytest.mark.parametrize(("law", "species", "walls"), BETWEEN)
def test_walls(law, species, walls):
    """Four particles that touch each other and the wall, which bears what they do not."""
    style, radii = EXACT[law], None
    if species == ANY:
        style, radii = f"{style} radius atom", [0.5, 0.49, 0.505, 0.497]
    options = {"boundary": "f f p", "commands": WALLS[walls], "radii": radii}
    scene = Scene(FOUR, species.split(), BOX, style, **options)
    force = assert_forces(scene, FOUR)
    assert (scene.evaluate(FOUR).shape["contacts"] > 2).all()  # two neighbors and the wall
    on_walls = scene.force_on_wall("walls")
    if "flat all" in WALLS[walls]:
        on_walls += scene.force_on_wall("flat")
    atol = 1e-11 * np.abs(force).max()
    np.testing.assert_allclose(on_walls, -force.sum(0), rtol=0, atol=atol)


# ---- contacts that come and go ----


def test_ring_where_a_contact_appears():
    """At the very position where the outline begins to touch a neighbor: no jump of the force."""
    case = PACKINGS[0]
    scene = Scene.packing(case, RADICAL)
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
    scene = Scene.packing(CASE, RADICAL)
    start = np.array(CASE["x"])
    direction = np.random.default_rng(3).normal(size=start.shape)
    path, step = np.linspace(0, 0.03, 1201, retstep=True)
    states = [scene.evaluate(start + s * direction) for s in path]
    assert len({tuple(state.shape["contacts"]) for state in states}) > 10

    slope = np.array([(state.force * direction).sum() for state in states])
    work = step * (slope.sum() - 0.5 * (slope[0] + slope[-1]))
    # the trapezoid rule errs by step^2/12 times the change of the force's own slope
    error = step**2 / 12 * np.abs(np.diff(slope, 2)).sum() / step
    assert work == pytest.approx(states[0].energy - states[-1].energy, abs=2 * error)

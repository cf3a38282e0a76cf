"""Balanced contacts: scenes with a known answer."""

import lammps_deformable as ld
import numpy as np
import pytest
from contact_rows import of_compute_pair
from derivatives import assert_forces
from lammps_deformable.engine.lammps import gather
from laws import BALANCED, EXACT, LAWS, RADICAL, balanced_laws
from scene import BOX, PACKINGS, Scene, polygon_walls
from test_refusals import refuses


def squeezed(species, places, top, style):
    """Particles of radius 0.5 in a column between two walls at 0 and `top`."""
    walls = "\n".join(
        f"region {name} plane 0 {y!r} 0 0 {n} 0\nfix {name} all deformable/wall {name}"
        for name, y, n in (("bottom", 0.0, 1), ("top", float(top), -1))
    )
    x = np.column_stack([np.zeros(len(places)), places])
    return Scene(x, species, BOX, style, boundary="p f p", commands=walls)


def test_stiff_on_soft():
    """kA a^3 is the same on both sides: S = pi a^2 between parallel lines, L = pi a."""
    stiff, soft, overlap = 1.0, 0.3, 0.03
    a = overlap / (1 + (stiff / soft) ** (1 / 3))
    b = overlap - a
    scene = squeezed(
        ["small", "weak"], [0.5 - a, 1.5 - a - overlap], 2 - 2 * overlap, EXACT["balanced"]
    )
    state = scene.evaluate()
    deficit = np.pi * np.array([a, b]) ** 2
    expected = 0.5 * np.array([stiff, soft]) * deficit**2
    np.testing.assert_allclose(state.atom_energy, expected, rtol=1e-11)
    np.testing.assert_allclose(state.shape["pressure"], [stiff, soft] * deficit, rtol=1e-11)
    force = stiff * np.pi**2 * a**3
    assert scene.force_on_wall("bottom")[1] == pytest.approx(-force, rel=1e-11)
    # at rest, which on the radical axis they are not
    assert np.abs(state.force).max() <= 1e-11 * force
    assert scene.force_on_wall("top")[1] == pytest.approx(force, rel=1e-11)


def test_one_contact():
    """A pair alone: L = a/G(0), S = a^2/2G(0), so kA a^3 is the same on both sides."""
    x = np.array([[0.0, 0.0], [0.97, 0.0]])
    ratio = (1 / 0.3) ** (1 / 3)
    a = 0.03 / (1 + ratio)
    state = Scene(x, ["small", "weak"], BOX, EXACT["balanced"]).evaluate()
    per_green = 4 * np.pi / 3
    assert state.atom_energy[0] == pytest.approx(0.5 * (0.5 * per_green * a**2) ** 2, rel=1e-11)
    assert state.force[0, 0] == pytest.approx(-0.5 * per_green**2 * a**3, rel=1e-11)


@balanced_laws
def test_pairs_that_come_apart(law, tmp_path):
    """No force remains, few evaluations are needed, and there is no warning."""
    log = tmp_path / "log"
    x = np.array([[0.0, 0.0], [0.97, 0.0]])
    scene = Scene(x, ["small", "weak"], BOX, LAWS[law], log=log)
    assert scene.energy() > 0
    for gap in (1e-9, 1e-4, 1e-3, 0.01, 0.1):
        scene.evaluate(np.array([[0.0, 0.0], [1.0 + gap, 0.0]]))
        evaluations, imbalance = of_compute_pair(scene)
        assert scene.energy() == 0.0
        assert evaluations <= 3
        assert imbalance == 0.0
    assert "not balanced" not in log.read_text()


def test_many_small_neighbors():
    """Thirty around one, at different distances."""
    theta = 2 * np.pi * np.arange(30) / 30
    distance = 1.115 + 0.004 * np.cos(5 * theta)
    x = np.vstack([np.column_stack([np.cos(theta), np.sin(theta)]) * distance[:, None], [[0, 0]]])
    scene = Scene(x, ["tiny"] * 30 + ["unit"], BOX, EXACT["balanced"] + " reach 0.4")
    assert scene.evaluate().shape["contacts"][30] > 20
    assert_forces(scene, x)


@balanced_laws
def test_rattler_in_a_cage(law):
    """A small particle among six that touch each other: free, then touched by one of them."""
    theta = np.arange(6) * np.pi / 3
    cage = 1.36 * np.column_stack([np.cos(theta), np.sin(theta)])
    species = ["large", "soft"] * 3 + ["small"]
    for place, touches in ((0.0, False), (0.17, True)):
        scene = Scene(np.vstack([cage, [[place, 0.02]]]), species, BOX, EXACT[law])
        state = scene.evaluate()
        assert (state.shape["contacts"][:6] >= 2).all()
        assert (state.shape["contacts"][6] > 0) == touches
        assert of_compute_pair(scene)[1] <= 1e-12


@balanced_laws
def test_periodic_images(law):
    """Two particles that touch each other and their own images from both sides."""
    x, box = np.array([[0.3, 0.2], [0.8, 1.05]]), (0, 0.985, 0, 1.7)
    scene = Scene(x, ["small", "weak"], box, EXACT[law])
    state = scene.evaluate()
    assert (state.shape["contacts"] >= 4).all()
    # the same, nine times
    cells = [(i, j) for i in range(3) for j in range(3)]
    many = np.vstack([x + np.array(c) * [0.985, 1.7] for c in cells])
    wide = Scene(many, ["small", "weak"] * 9, (0, 3 * 0.985, 0, 3 * 1.7), EXACT[law]).evaluate()
    assert state.energy == pytest.approx(wide.energy / 9, rel=1e-11)
    np.testing.assert_allclose(state.force, wide.force[:2], rtol=0, atol=1e-11 * state.virial.max())


@pytest.mark.parametrize(
    ("law", "species"), [("balanced", ("fixed", "fixedlarge")), ("curved", ("drop", "droplarge"))]
)
def test_after_an_error(law, species):
    """Particles without room leave no trace in the calls that follow."""
    roomy = "change_box all x scale 1.06 y scale 1.06 remap"
    scene = Scene.packing(PACKINGS[0], EXACT[law], species, commands=roomy)
    x = scene.x
    cluster = x[0] + 0.3 * np.random.default_rng(0).normal(size=x.shape)
    energy = scene.energy()
    assert energy > 0.0
    for crushed in (0.5 * x, cluster, 0.8 * x):
        with refuses("no shape that keeps its area|contact line"):
            scene.energy(crushed)
        for _ in range(2):
            assert scene.energy(x) == pytest.approx(energy, rel=1e-12)


def test_jumps_at_successive_steps():
    """Forces that are extrapolated from other states may be so far off that bubbles collapse."""
    scene, unprepared = (
        Scene.packing(
            PACKINGS[0],
            f"{BALANCED} reach 2",
            ("strong", "bubble"),
            commands="change_box all x scale 0.97 y scale 0.97 remap",
        )
        for _ in range(2)
    )
    x = scene.x
    for seed in range(20):
        rng = np.random.default_rng(seed)
        for size in (0.05, 0.02, 0.05, 0.02):
            state = x + size * rng.normal(size=x.shape)
            energy = scene.energy(state)
            unprepared.run(f"reset_timestep {int(unprepared.lmp.get_thermo('step')) + 5}")
            assert energy == pytest.approx(unprepared.energy(state), rel=1e-12)


@balanced_laws
def test_images_above_each_other(law):
    """A box that is tilted by its own width has the lattice of one that is not tilted."""
    rng, box = np.random.default_rng(1), (0, 0.97, 0, 0.98)
    energies = [
        Scene(rng.uniform(0, 0.97, (1, 2)), ["small"], box, EXACT[law], tilt=tilt).energy()
        for tilt in (0.0, *[0.97] * 12)
    ]
    assert energies[0] > 1e-6
    np.testing.assert_allclose(energies, energies[0], rtol=1e-12)


@balanced_laws
def test_only_walls(law):
    options = {"boundary": "f f p", "commands": polygon_walls(6, 0.48)}
    scene, radical = (Scene([[0, 0]], ["both"], BOX, s, **options) for s in (EXACT[law], RADICAL))
    assert scene.energy() == pytest.approx(radical.energy(), rel=1e-13)
    evaluations, imbalance = of_compute_pair(scene)
    assert evaluations <= 10
    assert imbalance <= 1e-12


EXTREMES = {
    "kP/kA": lambda rng: (1.0, 10 ** rng.uniform(-6, 12), 0.0),
    "kA": lambda rng: (10 ** rng.uniform(-2, 2), np.inf, 0.0),
    "both": lambda rng: (10 ** rng.uniform(-3, 3), 10 ** rng.uniform(-3, 3), 0.05 * rng.random()),
}


def scattered(draw, seed, folder, scale=1.0):
    """A packing in which every particle has a stiffness of its own."""
    case, rng = PACKINGS[1], np.random.default_rng(seed)
    names = [f"s{n}" for n in range(case["N"])]
    lines = []
    for name, kind in zip(names, case["type"], strict=True):
        kA, kP, skin = (float(value) for value in draw(rng))
        lines.append(f"{name} {(0.5, 0.7)[kind - 1]} {kA * scale!r} {kP * scale!r} {skin!r}\n")
    (folder / "species").write_text("# UNITS: lj\n" + "".join(lines))
    coeff = f"pair_coeff * * {folder / 'species'} {' '.join(names)}"
    box = (0, case["L"], 0, case["L"])
    return Scene(case["x"], names, box, f"{BALANCED} reach 0.5", coeff=coeff)


@pytest.mark.parametrize("draw", EXTREMES.values(), ids=EXTREMES)
def test_stiff_beside_soft(draw, tmp_path):
    """Stiffnesses of neighbors that differ by orders of magnitude; a common factor is a unit."""
    for seed in range(3):
        scene = scattered(draw, seed, tmp_path)
        energy = scene.evaluate().energy
        evaluations, imbalance = of_compute_pair(scene)
        assert imbalance <= 1e-8
        assert evaluations <= 40
    for power in (-27, 27):
        scaled = scattered(draw, seed, tmp_path, 2.0**power).evaluate()
        assert scaled.energy == pytest.approx(2.0**power * energy, rel=1e-13)


@pytest.mark.parametrize("unit", [2.0**-132, 2.0**132])
def test_any_unit_of_stiffness(unit):
    """Corrections are in single precision, whose numbers end at 1e-38 and 3e38."""
    packing = ld.jam(ld.bidisperse(64, seed=1)).packing.at(0.9)
    forces = []
    for kA in (1.0, unit):
        with ld.Simulation(packing, ld.Ring(kA=kA, kP=0.1 * kA)) as sim:
            sim.lmp.command("run 0 post no")
            forces.append(gather(sim.lmp, "f", 3) / kA)
    scale = np.abs(forces[0]).max()
    assert scale > 1e-4
    np.testing.assert_allclose(forces[1], forces[0], rtol=0, atol=1e-12 * scale)


def test_more_reach_than_the_box():
    """Several images of a particle in one direction: each side finds its own mirror."""
    x, box = np.array([[0.0, 0.0], [0.95, 0.0]]), (-1.5, 1.5, -1.5, 1.5)
    here, far = (
        Scene(x, ["small", "weak"], box, f"{BALANCED} reach {r}").evaluate()
        for r in (0.3, 3.0)  # the second image is 3.95 away
    )
    # both balance to 1e-8, and the energy errs by the square of that
    assert far.energy == pytest.approx(here.energy, rel=1e-13)
    np.testing.assert_allclose(far.force, here.force, rtol=0, atol=1e-7 * np.abs(here.force).max())

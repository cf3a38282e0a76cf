"""Balanced contacts: the minimum of the energy, and its derivatives."""

import json
from pathlib import Path

import numpy as np
import pytest
from balanced import EXACT, Pairs, of_compute_pair, of_mixture
from deformable import core
from deformable.studies.shape_error import shape_error
from scene import PACKINGS, Scene, box_walls
from test_forces import BOX, assert_forces
from test_soft_rings import mixture, pushed


@pytest.mark.parametrize("start", [None, 1, 2])
def test_minimum_of_the_energy(start):
    """The same as by brute force from any split: of several balanced states there is but one."""
    case = PACKINGS[1]
    pairs = of_mixture(case)
    s = np.zeros(len(pairs.i))
    if start:
        s = np.random.default_rng(start).uniform(-0.02, 0.02, len(s))
    shapes = pairs.shapes(pairs.minimize(s))
    scene = mixture(case, EXACT)[0]
    state = scene.evaluate(pushed(case))
    evaluations, imbalance = of_compute_pair(scene)
    assert imbalance <= 1e-12
    assert 2 <= evaluations <= 15
    energy = np.array([shape.energy for shape in shapes])
    # forces that differ by 1e-12 leave the split so, and what depends on it
    np.testing.assert_allclose(state.atom_energy, energy, rtol=0, atol=1e-9 * energy.max())
    area = [shape.area for shape in shapes]
    np.testing.assert_allclose(state.shape["area"], area, rtol=1e-11)
    radical = mixture(case)[0].energy(pushed(case))
    assert state.energy < 0.9 * radical


def test_history_leaves_no_trace():
    """Wherever the particles have been before, the state is that of where they are."""
    case = PACKINGS[0]
    x = pushed(case)
    fresh = mixture(case, EXACT)[0].evaluate(x)
    scene = mixture(case, EXACT)[0]
    rng = np.random.default_rng(5)
    for size in (0.05, 0.02, 0.06):
        scene.evaluate(np.array(case["x"]) + rng.uniform(-size, size, x.shape))
    again = scene.evaluate(x)
    assert again.energy == pytest.approx(fresh.energy, rel=1e-12)
    largest = np.abs(fresh.force).max()
    np.testing.assert_allclose(again.force, fresh.force, rtol=0, atol=1e-10 * largest)


def test_forces():
    assert_forces(mixture(PACKINGS[1], EXACT)[0], pushed(PACKINGS[1]))


def test_forces_between_walls():
    x = np.array([[-0.481, -0.477], [0.483, -0.479], [0.478, 0.482], [-0.479, 0.479]])
    species = ["small", "weak", "both", "fixed"]
    walls = box_walls(-0.965, 0.97, -0.96, 0.967)
    options = {"boundary": "f f p", "commands": walls}
    scene = Scene(x, species, BOX, EXACT, **options)
    force = assert_forces(scene, x)
    scene.evaluate(x)
    np.testing.assert_allclose(scene.force_on_wall("walls"), -force.sum(0), rtol=1e-11)


def test_virial():
    """Of strains, by finite differences, and by pairs."""
    case = PACKINGS[0]
    state = mixture(case, EXACT)[0].evaluate(pushed(case))
    by_pairs = mixture(case, EXACT, commands="pair_modify nofdotr")[0].evaluate(pushed(case))
    atol = 1e-12 * np.abs(state.atom_virial).max()
    np.testing.assert_allclose(by_pairs.virial, state.virial, rtol=0, atol=atol)
    np.testing.assert_allclose(state.atom_virial.sum(0), state.virial, rtol=0, atol=atol)
    step, names = 1e-6, mixture(case)[1]
    energy = [
        Scene(
            pushed(case) * [scale, 1], names, (0, case["L"] * scale, 0, case["L"]), EXACT
        ).energy()
        for scale in (1 - step, 1 + step)
    ]
    assert (energy[0] - energy[1]) / (2 * step) == pytest.approx(state.virial[0], rel=1e-6)


def test_bead_packing(tmp_path):
    """24 rings of an independent bead code, seen as balanced rings with the stiffness of theirs.

    Area deficits of single rings to 0.8 % (64 % on the radical axis), energy to 0.7 % of the beads'
    3.378e-6, outlines to 2.9e-4 R.
    """
    data = json.loads((Path(__file__).parents[1] / "data" / "bead_packing.json").read_text())
    beads, p, box = [np.array(ring) for ring in data["beads"]], data["bead_radius"], data["box"]
    number, ring = np.array([len(b) for b in beads]), np.array(data["radius"]) - p
    spacing = 2 * ring * np.sin(np.pi / number)
    radius = ring + 0.5 * np.sqrt(4 * p**2 - spacing**2 / 4)
    x = np.array([b.mean(0) for b in beads])
    kP, skin = data["kL"] / number, radius - ring
    stiffness = [(data["kA"], *of_ring) for of_ring in np.column_stack([kP, skin]).tolist()]
    pairs = Pairs(x, box, radius, stiffness)
    s = pairs.minimize(np.zeros(len(pairs.i)))
    shapes = pairs.shapes(s)
    energy = np.array([shape.energy for shape in shapes])
    assert energy.sum() == pytest.approx(3.400e-6, rel=1e-3)
    names = [f"ring{n}" for n in number]
    lines = {
        name: f"{name} {radius[k]:.17g} {kA} {kP!r} {skin!r}\n"
        for k, (name, (kA, kP, skin)) in enumerate(zip(names, stiffness, strict=True))
    }
    (tmp_path / "species").write_text("# UNITS: lj\n" + "".join(lines.values()))
    coeff = f"pair_coeff * * {tmp_path / 'species'} {' '.join(dict.fromkeys(names))}"
    state = Scene(x % box, names, (0, box, 0, box), EXACT, coeff=coeff).evaluate()
    np.testing.assert_allclose(state.atom_energy, energy, rtol=0, atol=1e-9 * energy.max())

    exact = np.array(data["rest_area"]) - data["area"]
    deficit = np.array([shape.area_deficit for shape in shapes])
    assert np.linalg.norm(deficit - exact) / np.linalg.norm(exact) < 0.008
    error = [
        shape_error(
            beads[n] - x[n],
            core.outline("ring", ring[n] + shapes[n].delta, angle, a + shapes[n].delta, 1440),
            data["radius"][n],
        )
        for n, (_, _, angle, a) in enumerate(pairs.rows(s))
    ]
    assert np.mean(error) < 2.9e-4

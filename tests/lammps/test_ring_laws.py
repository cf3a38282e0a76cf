"""Forces and virials of all ring laws are derivatives of the energy, which has no memory."""

import numpy as np
import pytest
from laws import exact_laws, kinds
from scene import PACKINGS, Scene, box_walls
from test_forces import BOX, STRAINS, assert_forces, assert_virial
from test_soft_rings import pushed


@kinds
@exact_laws
def test_forces(kind, style):
    """All stiffnesses side by side; the packings also have rattlers."""
    assert_forces(kind(PACKINGS[1], style), pushed(PACKINGS[1]))


SPECIES = {
    "rings": ["small", "weak", "both", "fixed"],
    "droplets": ["drop", "small", "firm", "strong"],
}


@pytest.mark.parametrize("species", SPECIES.values(), ids=SPECIES)
@exact_laws
def test_forces_between_walls(species, style):
    x = np.array([[-0.481, -0.477], [0.483, -0.479], [0.478, 0.482], [-0.479, 0.479]])
    options = {"boundary": "f f p", "commands": box_walls(-0.965, 0.97, -0.96, 0.967)}
    scene = Scene(x, species, BOX, style, **options)
    force = assert_forces(scene, x)
    scene.evaluate(x)
    np.testing.assert_allclose(scene.force_on_wall("walls"), -force.sum(0), rtol=1e-11)


@kinds
@exact_laws
def test_sums(kind, style):
    """Of energies, forces and virials, with either way in which LAMMPS adds the virial."""
    case = PACKINGS[0]
    state = kind(case, style).evaluate(pushed(case))
    by_pairs = kind(case, style, commands="pair_modify nofdotr").evaluate(pushed(case))
    assert state.atom_energy.sum() == pytest.approx(state.energy, rel=1e-12)
    atol = 1e-12 * np.abs(state.atom_virial).max()
    np.testing.assert_allclose(state.atom_virial.sum(0), state.virial, rtol=0, atol=atol)
    np.testing.assert_allclose(by_pairs.virial, state.virial, rtol=0, atol=atol)
    assert np.abs(state.force.sum(0)).max() <= 1e-13 * np.abs(state.force).sum()


@kinds
@exact_laws
@pytest.mark.parametrize("strain", STRAINS.values(), ids=STRAINS)
def test_virial_is_the_response_to_strain(kind, style, strain):
    case = PACKINGS[0]
    scene = kind(case, style, tilt=0.0)
    scene.x = pushed(case)
    assert_virial(scene, case["L"], strain)


@kinds
@exact_laws
def test_state_without_memory(kind, style):
    """The state depends on the present positions only."""
    case = PACKINGS[0]
    x = pushed(case)
    fresh = kind(case, style).evaluate(x)
    scene = kind(case, style)
    rng = np.random.default_rng(5)
    for size in (0.05, 0.02, 0.06):
        scene.evaluate(np.array(case["x"]) + rng.uniform(-size, size, x.shape))
    again = scene.evaluate(x)
    assert again.energy == pytest.approx(fresh.energy, rel=1e-12)
    largest = np.abs(fresh.force).max()
    np.testing.assert_allclose(again.force, fresh.force, rtol=0, atol=1e-10 * largest)

"""Droplets beyond the model: counted and told where contacts are few and strong, too."""

import lammps_deformable as ld
import numpy as np
import pytest
from combinations import assert_same
from droplet_walls import walled
from droplets import Droplets
from emulsion import TEMPERATURE, Emulsion

ORIGIN = np.zeros((1, 3))


@pytest.mark.parametrize(("half", "beyond"), [(0.76, 0), (0.73, 1), (0.3, 1)])
def test_between_two_plates(half, beyond, tmp_path):
    """Forces are known to a per cent at a distance of 1.5 R; the load is far below 0.4 there."""
    scene = walled(ORIGIN, f"zlo {-half} zhi {half}", tmp_path)
    assert scene.outputs()[0] == beyond
    told = "1 of 1 particles are beyond the model: forces cover .* with the mean facet"
    assert (told.split(":")[0] in scene.log.read_text()) == bool(beyond)
    assert (scene.contacts()[:, 4].sum() / (8 * np.pi) < 0.13) == (half > 0.5)


def at_random(seed, folder):
    """Energy of droplets at random places, and the error where contacts do not balance."""
    edge = (20 * np.pi / 6 / 0.6) ** (1 / 3)
    x = np.random.default_rng(seed).uniform(0, edge, (20, 3))
    case = {"x": x, "radius": [0.5] * 20, "tension": [1.0] * 20, "box": [edge] * 3}
    try:
        return Droplets(case, folder).energy, ""
    except Exception as error:
        return 0.0, str(error)


def test_energies_below_that_of_spheres_are_refused(tmp_path):
    energies, errors = zip(*(at_random(seed, tmp_path) for seed in (3, 8, 10, 11)), strict=True)
    assert min(energies) >= 0.0
    told = [error for error in errors if error]
    assert told
    assert all("balance" in error for error in told)


def test_trial_places_without_room_end_no_run(tmp_path):
    """fix widom asks for the energy of droplets within others; their Boltzmann factor is 0."""
    scene = Emulsion(tmp_path)
    scene.run(f"fix move all nve\nfix trial all widom 5 20 1 4711 {TEMPERATURE}\nrun 20")
    assert scene.lmp.extract_fix("trial", 0, 1, 1) == 0.0
    assert_same(scene.results(), scene.fresh(tmp_path).results())


@pytest.mark.slow
def test_dense_packings_are_within_both_measures():
    """Loads of up to a third, in a random packing, with a mean facet below 0.046."""
    spheres = ld.bidisperse(64, sizes=(0.5, 0.7), dimension=3, seed=1)
    sim = ld.Simulation(ld.jam(spheres).packing.at(0.78), ld.Droplet())
    sim.compress(phi=0.88, steps=2)
    state = sim.relax(1e-4)
    sides, count = state.contacts, len(spheres)
    f = sides["force"] / state.packing.radii[sides["i"]]
    load = np.bincount(sides["i"], f, count) / (8 * np.pi)
    facet = np.bincount(sides["i"], f**2, count) / (8 * np.pi) ** 2 / load
    assert load == pytest.approx(state.loads, rel=1e-6)
    assert state.beyond == 0
    assert 0.3 < load.max() < 0.37
    assert 0.03 < facet.max() < 0.046

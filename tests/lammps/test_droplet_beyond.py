"""Droplets beyond the model: counted and told where contacts are few and strong, too."""

import lammps_deformable as ld
import numpy as np
import pytest
from droplet_walls import walled

ORIGIN = np.zeros((1, 3))


@pytest.mark.parametrize(("half", "beyond"), [(0.76, 0), (0.73, 1), (0.3, 1)])
def test_between_two_plates(half, beyond, tmp_path):
    """Forces are known to a per cent at a distance of 1.5 R; the load is far below 0.4 there."""
    scene = walled(ORIGIN, f"zlo {-half} zhi {half}", tmp_path)
    assert scene.outputs()[0] == beyond
    told = "1 of 1 particles are beyond the model: forces cover .* with the mean facet"
    assert (told.split(":")[0] in scene.log.read_text()) == bool(beyond)
    assert (scene.contacts()[:, 4].sum() / (8 * np.pi) < 0.13) == (half > 0.5)


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

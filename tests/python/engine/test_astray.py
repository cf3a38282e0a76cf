"""Far beyond the model curved lines may lead to rings without a shape: they are held straight."""

import lammps_deformable as ld
import numpy as np
import pytest

# number, seed and packing fraction; particles are then moved by a tenth of their diameter
CROWDED = [(8, 4, 1.0), (8, 11, 1.05), (8, 22, 1.05), (12, 8, 1.05), (16, 5, 1.05)]


def crowded(number, seed, phi):
    packing = ld.jam(ld.bidisperse(number, seed=seed)).packing.at(phi)
    moved = np.random.default_rng(seed).normal(0.0, 0.08, packing.positions.shape)
    return ld.Packing(
        packing.positions + moved, packing.radii, packing.box, species=packing.species
    )


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_straight_where_curved_lines_lead_astray():
    held = 0
    for case in CROWDED:
        found = {}
        for contact in ("balanced", "curved"):
            law = ld.Ring(kA=1.0, kP=0.1, contact=contact)
            with ld.Simulation(crowded(*case), law) as sim:
                state = sim.state()
                limited = sim.lmp.numpy.extract_compute("deformable_beyond", 0, 1)[4]
            assert np.isfinite([state.energy, state.pressure, *state.pressure_tensor.flat]).all()
            assert state.beyond > 0
            found[contact] = state
        if limited == len(state.contacts) / 2:
            held += 1
            assert state.energy == pytest.approx(found["balanced"].energy, rel=1e-6)
    assert held > 0

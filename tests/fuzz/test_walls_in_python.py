"""Any walls in Python: one clear error, or a packing whose forces are differences of its energy."""

import lammps_deformable as ld
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import build, scenes, space_scenes
from test_python import refuses_or_works

LAWS = [
    ld.Ring(contact="radical"),
    ld.Ring(kP=2.0),
    ld.Ring(contact="curved"),
    ld.Sector(kP=1.0),
]
REFUSED = (ld.ParameterError, ld.LammpsError)
STEP = 1e-6


def state_of(packing, law):
    def call():
        with ld.Simulation(packing, law) as sim:
            state = sim.state()
            force = np.array(sim.lmp.gather("f", 1, 3)).reshape(-1, 3)
            return state, force[:, : packing.dimension]

    return refuses_or_works(call, REFUSED)


def slope(packing, law, i, k):
    """-dU/dx, and how much it changes with the step: where contacts begin it has a kink."""
    found = []
    for step in (STEP, 2 * STEP):
        energies = []
        for sign in (1, -1):
            positions = packing.positions.copy()
            positions[i, k] += sign * step
            moved = state_of(packing.replace(positions=positions), law)
            if moved is None:
                return None
            energies.append(moved[0].energy)
        found.append((energies[1] - energies[0]) / (2 * step))
    return found


@pytest.mark.parametrize("examples", [60, pytest.param(3000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("dimension", [2, 3])
def test_walls_in_python(dimension, examples):
    worked = []
    some_scenes = scenes if dimension == 2 else space_scenes
    laws = LAWS if dimension == 2 else [ld.Droplet(), ld.Droplet(tension=(1, 3))]

    @settings(max_examples=examples, deadline=None)
    @given(
        some_scenes, st.sampled_from(laws), st.integers(1, 30), st.integers(0, 99), st.booleans()
    )
    def answers(parts, law, number, seed, tilted):
        loose = ld.bidisperse(number, phi=0.2, dimension=dimension, tilt=0.2 * tilted, seed=seed)

        def start():
            packing = loose.between(build(ld, parts), seed=seed)
            room = packing.volume
            assert 0 < room < np.inf
            if number > 5 and packing.phi < 1.5:
                packing = packing.push_off()
            return packing

        packing = refuses_or_works(start, REFUSED)
        if packing is None:
            return
        found = state_of(packing, law)
        if found is None:
            return
        state, forces = found
        worked.append(len(packing.walls))
        assert np.isfinite([state.energy, state.phi, state.pressure]).all()
        assert np.isfinite(forces).all()
        scale = max(np.abs(forces).max(), np.abs(state.wall_forces).max(initial=0.0), 1e-6)
        assert state.wall_forces.sum(0) == pytest.approx(-forces.sum(0), abs=1e-9 * scale)
        i = int(np.linalg.norm(forces, axis=1).argmax())
        if not isinstance(law, ld.Sector):  # whose energy jumps
            near = slope(packing, law, i, seed % 2)
            if near is not None and abs(near[0] - near[1]) < 1e-4 * scale:
                assert near[0] == pytest.approx(forces[i, seed % 2], abs=1e-3 * scale)

    answers()
    assert len(worked) > 0.1 * examples

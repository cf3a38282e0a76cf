"""One small jammed packing and one compressed state, shared by the tests."""

import deformable
import pytest


@pytest.fixture(scope="session")
def jammed() -> deformable.Packing:
    return deformable.jam(deformable.bidisperse(32, seed=3))


@pytest.fixture(scope="session")
def state(jammed: deformable.Packing) -> deformable.State:
    with deformable.Simulation(jammed, deformable.Ring(kA=2.0)) as sim:
        *_, last = deformable.compress(sim, strain=0.02, steps=2)
    return last

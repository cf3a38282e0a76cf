"""One small jammed packing and one compressed state, shared by the tests."""

from collections.abc import Iterator

import lammps_deformable as ld
import pytest
from exact_balance import exactly_balanced


@pytest.fixture(scope="session")
def jammed() -> ld.Packing:
    return ld.jam(ld.bidisperse(32, seed=3)).packing


@pytest.fixture(scope="session")
def state(jammed: ld.Packing) -> ld.State:
    with ld.Simulation(jammed, ld.Ring(kA=2.0)) as sim:
        last = sim.compress(strain=0.02, steps=2)[-1]
    return last


@pytest.fixture
def exact_balance() -> Iterator[None]:
    with exactly_balanced():
        yield

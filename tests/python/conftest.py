"""One small jammed packing and one compressed state, shared by the tests."""

from collections.abc import Iterator

import deformable
import pytest
from exact_balance import exactly_balanced


@pytest.fixture(scope="session")
def jammed() -> deformable.Packing:
    return deformable.jam(deformable.bidisperse(32, seed=3))


@pytest.fixture(scope="session")
def state(jammed: deformable.Packing) -> deformable.State:
    with deformable.Simulation(jammed, deformable.Ring(kA=2.0)) as sim:
        *_, last = deformable.compress(sim, strain=0.02, steps=2)
    return last


@pytest.fixture
def exact_balance() -> Iterator[None]:
    with exactly_balanced():
        yield

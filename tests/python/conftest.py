"""One small jammed packing and one compressed state, shared by the tests."""

import deformable
import pytest
from deformable.engine import simulation


@pytest.fixture(scope="session")
def jammed() -> deformable.Packing:
    return deformable.jam(deformable.bidisperse(32, seed=3))


@pytest.fixture(scope="session")
def state(jammed: deformable.Packing) -> deformable.State:
    with deformable.Simulation(jammed, deformable.Ring(kA=2.0)) as sim:
        *_, last = deformable.compress(sim, strain=0.02, steps=2)
    return last


@pytest.fixture
def exact_balance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulations whose balanced contacts have forces to 1e-13 of the largest one.

    By default they are right to 1e-8; tests that compare closer than that need more.
    """
    commands, law = simulation.law_commands, "contact balanced"

    def exact(*arguments: object) -> str:
        text: str = commands(*arguments)  # type: ignore[arg-type]
        return text.replace(law, f"{law} balance 1e-13 100")

    monkeypatch.setattr(simulation, "law_commands", exact)

"""Which minimizer relaxes a packing, and what states and runs tell of it."""

from __future__ import annotations

from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.particles.commands import LBFGS

LAWS = {
    **{contact: ld.Ring(contact=contact) for contact in ("radical", "balanced", "curved")},
    "bubbles": ld.Ring(kP=0.0, tension=0.1),
    "droplets": ld.Droplet(),
}


@pytest.fixture(scope="module", params=LAWS)
def jammed(request: pytest.FixtureRequest) -> tuple[ld.State, object]:
    law = LAWS[request.param]
    dimension = 3 if isinstance(law, ld.Droplet) else 2
    start = ld.jam(ld.bidisperse(40, dimension=dimension, seed=2), law)
    with ld.Simulation(start, law) as sim:  # close to the onset minima are many
        return sim.compress(strain=0.01)[-1], law


def test_both_find_the_same_minimum(jammed: tuple[ld.State, object]) -> None:
    start, law = jammed
    states = {}
    for minimizer in ("lbfgs", "fire"):
        with ld.Simulation(start, law, minimizer=minimizer) as sim:
            for _ in range(5):
                states[minimizer] = sim.compress(strain=1e-4)[-1]
    found, expected = states["lbfgs"], states["fire"]
    assert found.converged
    assert found.minimizer == "lbfgs"
    assert expected.minimizer == "fire"
    assert found.energy == pytest.approx(expected.energy, rel=1e-9)
    assert 0 < found.iterations < expected.iterations / 3


def test_what_a_law_can_have() -> None:
    packing = ld.bidisperse(12, seed=1)
    with ld.Simulation(packing, ld.Sector()) as sim:
        assert sim.minimizer == "fire"
    with pytest.raises(ld.ParameterError, match="minimizer must be 'fire' for Sector, not 'lbfgs'"):
        ld.Simulation(packing, ld.Sector(), minimizer="lbfgs")
    with pytest.raises(ld.ParameterError, match="'lbfgs' or 'fire' for Ring, not 'cg'"):
        ld.Simulation(packing, ld.Ring(), minimizer="cg")
    rubbing = ld.Friction(0.3, kt=1.0)
    with pytest.raises(ld.ParameterError, match="'damped' for contacts that rub, not 'fire'"):
        ld.Simulation(packing, ld.Ring(), friction=rubbing, minimizer="fire")


def test_fire_goes_on_where_lbfgs_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps that rounding swallows."""
    failing = "min_style deformable/lbfgs\nmin_modify norm max dmax 1e-20\n"
    monkeypatch.setattr("lammps_deformable.engine.relax.LBFGS", failing)
    jammed = ld.jam(ld.bidisperse(40, seed=2))
    with ld.Simulation(jammed, ld.Ring()) as sim:
        state = sim.compress(strain=0.01)[-1]
    assert state.converged
    assert state.minimizer == "lbfgs, fire"


def test_fire_goes_on_where_lbfgs_is_slow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps that are too short for the way."""
    slow = "min_style deformable/lbfgs\nmin_modify norm max dmax 1e-9\n"
    monkeypatch.setattr("lammps_deformable.engine.relax.LBFGS", slow)
    monkeypatch.setattr("lammps_deformable.engine.relax._LBFGS_PATIENCE", 2000)
    jammed = ld.jam(ld.bidisperse(40, seed=2))
    with ld.Simulation(jammed, ld.Ring()) as sim:
        state = sim.compress(strain=0.01)[-1]
    assert state.converged
    assert state.minimizer == "lbfgs, fire"


def test_fire_goes_on_where_lbfgs_meets_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """From the places before it: steps of L-BFGS are longer, and may lead where no outlines are."""
    monkeypatch.setattr(
        "lammps_deformable.engine.relax.LBFGS", LBFGS + "minimize 0 0 3 9\nnonsense\n"
    )
    jammed = ld.jam(ld.bidisperse(40, seed=2))
    states = {}
    for minimizer in ("lbfgs", "fire"):
        with ld.Simulation(jammed, ld.Ring(), minimizer=minimizer) as sim:
            states[minimizer] = sim.compress(strain=0.01)[-1]
    found, expected = states.values()
    assert found.minimizer == "lbfgs, fire"
    assert found.iterations == pytest.approx(expected.iterations, abs=20)
    np.testing.assert_allclose(found.packing.positions, expected.packing.positions, atol=1e-10)


def test_a_run_goes_on_with_its_minimizer(tmp_path: Path) -> None:
    jammed = ld.jam(ld.bidisperse(24, seed=2), ld.Ring())
    with ld.Simulation(jammed, ld.Ring(), minimizer="fire") as sim:
        sim.compress(strain=1e-3, steps=2, record=tmp_path / "run")
        assert sim.run(10)[-1].minimizer is None
    run = ld.Run(tmp_path / "run")
    assert run.parameters["minimizer"] == "fire"
    assert run[1].minimizer == "fire"
    assert run[1].iterations > 0
    assert run.table()["minimizer"].tolist()[1:] == ["fire", "fire"]
    with run.simulation() as sim:
        assert sim.minimizer == "fire"

"""What simulations tell of a relaxation."""

import sys
from collections.abc import Callable

import lammps_deformable as ld
import pytest
from lammps_deformable.engine.relax import Forces, largest_force_told

SIMULATIONS = [
    lambda packing: ld.Simulation(packing, ld.Ring()),
    lambda packing: ld.Simulation(packing, ld.SoftContact()),
    lambda packing: ld.Simulation(packing, ld.DeformablePolygon(20, smooth=False)),
]


def test_a_residual_above_the_tolerance_looks_larger() -> None:
    for residual, told in (
        (2.34567e-6, "2.3e-06"),
        (1.002e-6, "1.002e-06"),
        (1e-6 * (1.0 + 3e-16), "1.0000000000000002e-06"),
        (float("inf"), "inf"),
    ):
        text = largest_force_told(residual, "the mean", 1e-6)
        assert text == f"the largest force is {told} of the mean, not 1e-06"


@pytest.mark.parametrize("open_one", SIMULATIONS)
def test_stalled_simulations_tell_more_than_the_tolerance(
    open_one: Callable[[ld.Packing], ld.Simulation], monkeypatch: pytest.MonkeyPatch
) -> None:
    packing = ld.bidisperse(6, phi=0.5, seed=1).push_off()
    with open_one(packing) as sim:
        module = sys.modules[type(sim).relax.__module__]
        monkeypatch.setattr(module, "minimize_until_relaxed", lambda *_, **__: Forces(1.002e-6, 1))
        with pytest.warns(ld.StalledWarning, match=r"is 1\.002e-06 of .*, not 1e-06$"):
            sim.relax(1e-6)


def test_contacts_that_do_not_balance_are_not_relaxed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever their forces on particles are."""
    packing = ld.bidisperse(6, phi=0.5, seed=1).push_off()
    with ld.Simulation(packing, ld.Ring()) as sim:
        module = sys.modules["lammps_deformable.engine.simulation"]
        monkeypatch.setattr(module, "minimize_until_relaxed", lambda *_, **__: Forces(0.0, 1))
        monkeypatch.setattr(sim.engine, "unbalanced", lambda *_: True)
        with pytest.warns(ld.StalledWarning, match="the contacts do not balance"):
            assert not sim.relax(1e-6).converged


def test_no_numbers_far_beyond_the_model(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where LAMMPS has forces that are none, there is no state."""
    with ld.Simulation(ld.bidisperse(8, seed=1).push_off(), ld.Ring()) as sim:
        monkeypatch.setattr(
            "lammps_deformable.engine.engines.largest_force", lambda *_: float("nan")
        )
        with pytest.raises(ld.LammpsError, match=r"forces are no numbers .* compress less"):
            sim.relax()

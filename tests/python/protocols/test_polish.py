"""The last digits of a relaxation."""

import math
from importlib import import_module

import lammps_deformable as ld
import numpy as np
import pytest

LAWS = {
    "disks": None,
    "radical": ld.Ring(contact="radical"),
    "balanced": ld.Ring(kP=0.5, skin=0.02),
    "curved": ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact="curved"),
}


@pytest.fixture(params=LAWS)
def state(request: pytest.FixtureRequest) -> ld.State | ld.DiskState:
    law, jammed = LAWS[request.param], ld.jam(ld.bidisperse(64, seed=5))
    packing = jammed.at(jammed.phi + 0.02)
    with ld.Simulation(packing, law) if law else ld.Disks(packing) as sim:
        return sim.relax(1e-5)


def test_few_steps_of_newton(state: ld.State, monkeypatch: pytest.MonkeyPatch) -> None:
    module, steps = import_module("lammps_deformable.polishing"), []
    place = module.place_particles
    monkeypatch.setattr(module, "place_particles", lambda *a: (steps.append(1), place(*a)))
    fine = ld.polish(state)
    assert 0.0 <= fine.residual <= 1e-10
    assert not fine.stalled
    assert 1 <= len(steps) <= 3
    assert fine.network_contacts == state.network_contacts
    assert fine.energy == pytest.approx(state.energy, rel=1e-6)
    rigid = ~state.rattlers
    moved = fine.packing.positions - state.packing.positions
    assert np.abs(moved[rigid]).max() < 1e-3
    assert fine.hessian().gradient == pytest.approx(0.0, abs=1e-10 * scale(fine))


def test_dense_packings_stall_where_contacts_are_balanced_no_better() -> None:
    """Forces on particles then are errors of contacts: the warning says what has none."""
    jammed = ld.jam(ld.bidisperse(8, seed=1))
    with ld.Simulation(jammed.at(0.97), LAWS["curved"]) as sim:
        state = sim.relax(1e-6)
        with pytest.warns(ld.StalledWarning, match="balanced to 1e-8, `polish` goes furt"):
            rough = sim.relax(1e-10)
    assert 1e-9 < rough.residual < 1e-6
    assert ld.polish(state).residual < 1e-10


def scale(state: ld.State | ld.DiskState) -> float:
    """About the mean contact force."""
    return 2.0 * state.pressure


@pytest.mark.parametrize("law", [None, ld.Ring(kP=0.4)])
def test_between_walls(law: ld.Ring | None) -> None:
    walls = ld.Sphere(4, (0, 0)), ld.Sphere(0.6, (1, 0.5), inside=False)
    jammed = ld.jam(ld.bidisperse(40, seed=1).between(walls, seed=1).at(0.6))
    packing = jammed.at(jammed.phi + 0.02)
    with ld.Simulation(packing, law) if law else ld.Disks(packing) as sim:
        state = sim.relax(1e-5)
    assert ld.polish(state).residual <= 1e-10


@pytest.mark.parametrize("law", [None, ld.Ring()])
def test_the_strain_of_a_shear_stays(law: ld.Ring | None) -> None:
    jammed = ld.jam(ld.bidisperse(16, seed=2))
    packing = jammed.at(jammed.phi + 0.02)
    with ld.Simulation(packing, law) if law else ld.Disks(packing) as sim:
        state = sim.shear(0.001)[-1]
    assert ld.polish(state).strain == state.strain == pytest.approx(0.001)


def test_a_state_far_from_rest_stays() -> None:
    start = ld.bidisperse(20, phi=0.9, seed=2)
    with ld.Disks(start) as disks:
        state = disks.state()
    with pytest.warns(ld.StalledWarning, match="relax"):
        fine = ld.polish(state)
    assert fine.stalled
    assert fine.residual <= state.residual


def test_loose_packings_are_at_rest() -> None:
    with ld.Disks(ld.bidisperse(16, phi=0.5, seed=1)) as disks:
        state = disks.relax(1e-6)
    assert ld.polish(state).residual == 0.0


def test_errors() -> None:
    with ld.Simulation(ld.bidisperse(1, seed=1), ld.Sector()) as sim:
        state = sim.relax()
    with pytest.raises(ld.ParameterError, match="sector"):
        ld.polish(state)
    with pytest.raises(ld.ParameterError, match="tolerance"):
        ld.polish(state, tolerance=0.0)
    with pytest.raises(ld.ParameterError, match="State"):
        ld.polish(8)

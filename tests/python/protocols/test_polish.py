"""The last digits of a relaxation."""

import math
from importlib import import_module

import lammps_deformable as ld
import numpy as np
import pytest
from contact_laws import simulate
from lammps_deformable.engine.engines import IMBALANCE, told
from lammps_deformable.engine.lammps import place_particles

LAWS = {
    "disks": None,
    "radical": ld.Ring(contact="radical"),
    "balanced": ld.Ring(kP=0.5, skin=0.02),
    "curved": ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact="curved"),
}


def dense(law: object) -> ld.Simulation:
    jammed = ld.jam(ld.bidisperse(64, seed=5)).packing
    return simulate(jammed.at(jammed.phi + 0.02), law)


@pytest.mark.parametrize("law", ["radical", "balanced", "curved"])
def test_few_steps_of_newton(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    module, steps = import_module("lammps_deformable.engine.relax"), []
    place = module.place_particles
    monkeypatch.setattr(module, "place_particles", lambda *a: (steps.append(1), place(*a)))
    with dense(LAWS[law]) as sim:
        state = sim.relax(1e-6)
        assert not steps
        fine = sim.relax(1e-10)
        again = sim.state()
    assert 0.0 <= fine.residual <= 1e-10
    assert fine.converged
    assert len(steps) <= 3
    assert steps or law == "radical"
    # LAMMPS may round where it wraps particles
    assert again.packing.positions == pytest.approx(fine.packing.positions, abs=1e-14)
    assert fine.network_contacts == state.network_contacts
    assert fine.energy == pytest.approx(state.energy, rel=1e-6)
    rigid = ~state.rattlers
    moved = fine.packing.positions - state.packing.positions
    assert np.abs(moved[rigid]).max() < 1e-3
    assert fine.hessian().gradient == pytest.approx(0.0, abs=1e-10 * scale(fine))


def test_dense_packings() -> None:
    """Forces on particles are errors of contacts there, until these are balanced to rounding."""
    jammed = ld.jam(ld.bidisperse(8, seed=1)).packing
    with ld.Simulation(jammed.at(0.97), LAWS["curved"]) as sim:
        assert sim.relax(1e-10).residual < 1e-10


def scale(state: ld.State) -> float:
    """About the mean contact force."""
    return 2.0 * state.pressure


def test_between_walls() -> None:
    walls = ld.Sphere(4, (0, 0)), ld.Sphere(0.6, (1, 0.5), inside=False)
    jammed = ld.jam(ld.bidisperse(40, seed=1).between(walls, seed=1).at(0.6)).packing
    with ld.Simulation(jammed.at(jammed.phi + 0.02), ld.Ring(kP=0.4)) as sim:
        assert sim.relax(1e-10).residual <= 1e-10


def test_the_strain_of_a_shear_stays() -> None:
    jammed = ld.jam(ld.bidisperse(16, seed=2)).packing
    with ld.Simulation(jammed.at(jammed.phi + 0.02), ld.Ring()) as sim:
        sim.shear(0.001)
        assert sim.relax(1e-10).shear_strain == pytest.approx(0.001)


def test_what_newton_cannot_do_is_left_to_fire(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lammps_deformable.engine.engines.Deformables.patience", 5000)
    with ld.Simulation(ld.bidisperse(1, seed=1), ld.Sector()) as sim:
        assert sim.relax(1e-10).residual == 0.0
    rough = ld.Friction(0.3, kt=0.05)
    packing = ld.bidisperse(16, phi=0.9, seed=2).push_off()
    with (
        ld.Simulation(packing, ld.Ring(), friction=rough) as sim,
        pytest.warns(ld.StalledWarning, match="the largest force is"),
    ):
        assert not sim.relax(1e-14).converged


def test_afterwards_contacts_are_balanced_as_before() -> None:
    """The last digits cost iterations, which other states and steps of a motion do not need."""
    imbalances = []
    with dense(LAWS["balanced"]) as sim:
        positions = sim.relax(1e-10).packing.positions
        for seed in range(5):
            shake = 1e-3 * np.random.default_rng(seed).normal(size=positions.shape)
            place_particles(sim.lmp, positions + shake)
            sim.state()
            imbalances.append(told(sim.lmp, IMBALANCE))
    assert 1e-12 < max(imbalances) <= 1e-8

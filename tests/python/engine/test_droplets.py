"""Droplets in packings: relaxation, motion, jamming."""

import math

import lammps_deformable as ld
import numpy as np
import pytest

DROPLETS = ld.Ring(kA=math.inf, kP=0.0, tension=1.0)


@pytest.fixture(scope="module")
def squeezed() -> ld.Packing:
    """24 particles 3 % beyond the onset of jamming."""
    jammed = ld.jam(ld.bidisperse(24, seed=3)).packing
    return jammed.at(jammed.phi + 0.03)


@pytest.mark.parametrize("contact", ["radical", "curved"])
def test_relaxation(squeezed: ld.Packing, contact: str) -> None:
    law = ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact=contact)
    with ld.Simulation(squeezed, law) as sim:
        state = sim.relax(1e-6)
    assert state.converged
    assert state.residual <= 1e-6
    radius = squeezed.radii
    np.testing.assert_allclose(state.results["area"], np.pi * radius**2, rtol=1e-12)
    assert state.energy == pytest.approx(np.sum(state.perimeters - 2 * np.pi * radius), rel=1e-8)
    assert (state.pressures >= 1.0 / radius * (1 - 1e-12)).all()


def test_no_tension_of_its_own_beside_rings(squeezed: ld.Packing) -> None:
    """Small particles are droplets, large ones conserve their perimeter."""
    law = ld.Ring(kA=[math.inf, 10.0], kP=[0.0, math.inf], tension=[1.0, 0.0])
    with ld.Simulation(squeezed, law) as sim:
        state = sim.relax(1e-6)
    small = squeezed.species == 0
    assert state.converged
    np.testing.assert_allclose(state.results["area"][small], np.pi * 0.25, rtol=1e-12)
    np.testing.assert_allclose(state.perimeters[~small], 2 * np.pi * 0.7, rtol=1e-12)


def test_motion(squeezed: ld.Packing) -> None:
    """The default step keeps the energy, and a hot start too."""
    with ld.Simulation(squeezed, DROPLETS) as sim:
        sim.relax(1e-4)
        for temperature in (1e-8, 1e-3):
            states = sim.run(400, temperature=temperature, every=40, seed=1)[1:]
            total = [state.energy + state.kinetic_energy for state in states[1:]]
            kinetic = np.mean([state.kinetic_energy for state in states[1:]])
            assert np.ptp(total) < 0.05 * kinetic


def test_droplets_jam_where_disks_do() -> None:
    packing = ld.bidisperse(16, seed=1)
    disks = ld.jam(packing, pressure=1e-5).packing
    droplets = ld.jam(disks.at(disks.phi - 1e-3), DROPLETS, pressure=1e-5, step=1e-3).packing
    # the search may rearrange the packing, which moves its onset
    assert droplets.phi == pytest.approx(disks.phi, abs=1e-3)
    with ld.Simulation(droplets, DROPLETS) as sim:
        pressure = sim.relax(1e-6).pressure
    assert 0.9e-5 < pressure < 2.1e-5

"""Motion where a fix of LAMMPS lets contacts rub."""

from dataclasses import replace

import deformable
import numpy as np
import pytest

RUB = "fix rub all deformable/friction 0.5 1e-3 1e-4 damp 1e-3"


def fluid(spins: bool) -> deformable.Packing:
    packing = deformable.push_off(deformable.bidisperse(16, phi=0.7, seed=2))
    return replace(packing, particle_radii=packing.radius) if spins else packing


def test_particles_turn_and_energy_balances() -> None:
    """Kinetic, of spins too, potential, stored and lost."""
    with deformable.Simulation(fluid(spins=True), deformable.Ring()) as sim:
        sim.lmp.command(RUB)
        sums = []
        for state in deformable.move(sim, 600, temperature=1e-5, seed=1, every=200):
            spin = np.array(sim.lmp.gather("omega", 1, 3))[2::3]
            rotation = 0.25 * np.sum(state.packing.radius**2 * spin**2)
            rubbed = sim.lmp.extract_fix("rub", 0, 0)
            sums.append(state.kinetic_energy + state.energy + rotation + rubbed)
        assert np.abs(spin).max() > 1e-4
        assert sim.lmp.extract_fix("rub", 0, 1, 1) > 0
    assert sums == pytest.approx([sums[0]] * 3, rel=1e-3)


def test_particles_without_spins_translate() -> None:
    with deformable.Simulation(fluid(spins=False), deformable.Ring()) as sim:
        sim.lmp.command(RUB)
        for state in deformable.move(sim, 400, temperature=1e-5, seed=1):
            assert np.isfinite(state.energy)
        assert sim.lmp.extract_fix("rub", 0, 1, 1) > 0


def test_what_is_refused() -> None:
    """Minimizers pass over friction; particles do not turn in a bath."""
    with deformable.Simulation(fluid(spins=True), deformable.Ring()) as sim:
        sim.lmp.command(RUB)
        with pytest.raises(deformable.LammpsError, match=r"\A[^\n]*fix rub[^\n]*motion only"):
            sim.relax()
        with pytest.raises(deformable.ParameterError, match=r"\A[^\n]*friction do not turn"):
            list(deformable.move(sim, 10, friction=0.1))

"""Overdamped motion: free diffusion, the energy of contacts, and rest."""

import lammps_deformable as ld
import numpy as np
import pytest
from refusals import refused

TEMPERATURE, FRICTION = 1e-5, 2.0


def test_free_particles_diffuse() -> None:
    """<r^2> = 4 D t with D = T/friction; the mean of N values of r^2 has the error 1/N^(1/2)."""
    x, y = np.divmod(np.arange(400), 20)
    free = ld.Packing(2.0 + 4.0 * np.column_stack([x, y]), 0.5, 80.0 * np.eye(2))
    with ld.Simulation(free, ld.Ring()) as sim:
        states = sim.run(
            400,
            timestep=0.5,
            temperature=TEMPERATURE,
            drag=FRICTION,
            every=200,
            seed=1,
            inertia=False,
        )[1:]
    for before, state in zip((None, states[0]), states, strict=True):
        start = before.packing.positions if before else free.positions
        time = state.time - (before.time if before else 0.0)
        square = np.sum((state.packing.positions - start) ** 2, axis=1)
        assert square.mean() == pytest.approx(4.0 * TEMPERATURE / FRICTION * time, rel=5.0 / 20.0)
        assert not state.velocities.any()
        assert state.temperature == 0.0


def test_contacts_have_their_share_of_energy(dense: ld.Packing) -> None:
    """(N - 1) T in a solid packing without rattlers, for small T; blocks give the error."""
    temperature = 1e-9
    with ld.Simulation(dense, ld.Ring(contact="radical")) as sim:
        lowest = sim.relax(1e-8)
        assert not lowest.rattlers.any()
        states = sim.run(
            16_000,
            timestep=None,
            temperature=temperature,
            drag=1.0,
            every=50,
            seed=1,
            inertia=False,
        )[1:]
    share = np.array([state.energy - lowest.energy for state in states[20:]])
    share /= (len(dense) - 1) * temperature
    blocks = share.reshape(20, -1).mean(axis=1)
    error = blocks.std(ddof=1) / np.sqrt(20)
    assert share.mean() == pytest.approx(1.0, abs=5.0 * error)
    assert 5.0 * error < 0.2


def test_overdamped_particles_go_downhill_to_the_same_rest(dense: ld.Packing) -> None:
    with ld.Simulation(dense, ld.Ring()) as sim:
        start = sim.relax().packing
        sim.deform(0.999 * sim.box)
        states = sim.run(3000, drag=0.5, every=300, inertia=False)[1:]
    energies = [state.energy for state in states]
    assert (np.diff(energies) < 1e-12 * energies[0]).all()
    with ld.Simulation(start, ld.Ring()) as sim:
        sim.deform(0.999 * sim.box)
        assert sim.relax(1e-8).energy == pytest.approx(energies[-1], rel=1e-6)


def test_refusals(dense: ld.Packing) -> None:
    with ld.Simulation(dense, ld.Ring()) as sim:
        for values, message in (
            ({}, "without inertia particles need a drag above 0"),
            ({"drag": -1.0}, "drag must not be negative, not -1"),
            ({"drag": 1.0, "timestep": 1e9, "temperature": 0.01}, "too long for the temperature"),
            ({"drag": 1.0, "timestep": 1e9}, "timestep = .* is too long for particle"),
        ):
            with refused(message):
                sim.run(100, inertia=False, **values)

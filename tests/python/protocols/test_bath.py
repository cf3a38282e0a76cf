"""Motion in a heat bath: temperature, noise, and the velocities of the start."""

import lammps_deformable as ld
import numpy as np
import pytest

SOFT = ld.Ring(kP=0.3)


def scatter(particles: float, friction: float, time: float) -> float:
    """Standard error of a mean kinetic temperature over its value.

    With f = 2 (N - 1) degrees of freedom the kinetic energy varies by (2/f)^(1/2) and forgets at
    the rate 2 friction: (2/f)/(friction time) is the square of the error of its mean.
    """
    return (1.0 / ((particles - 1) * friction * time)) ** 0.5


def test_temperature_of_a_heat_bath(loose: ld.Packing) -> None:
    """Kinetic temperature of all particles, of each size and along each axis: 1 % at four sigma."""
    temperature, friction, steps = 1e-5, 1.0, 14_000
    with ld.Simulation(loose, SOFT) as sim:
        states = sim.run(
            steps, timestep=None, temperature=temperature, drag=friction, every=20, seed=1
        )[1:]
    error = scatter(len(loose), friction, states[-1].time)
    assert 4.0 * error < 0.01
    found = np.mean([state.temperature for state in states])
    assert found == pytest.approx(temperature, rel=4.0 * error)
    energy = np.mean([state.velocities**2 for state in states], axis=0)
    for part in (
        energy[:, 0],
        energy[:, 1],
        energy[loose.species == 0],
        energy[loose.species == 1],
    ):
        assert part.mean() == pytest.approx(temperature, rel=4.0 * np.sqrt(2.0) * error)
    assert max(state.n_contacts.max() for state in states) > 1  # particles are in contact


def test_heat_bath_does_not_depend_on_ends_of_runs() -> None:
    """Forces drawn anew at each state would halve the temperature, as fix langevin does."""
    gas = ld.bidisperse(64, phi=0.05, seed=3).push_off()
    with ld.Simulation(gas, ld.Ring()) as sim:
        states = sim.run(400, timestep=0.5, temperature=1e-6, drag=1.0, every=1, seed=1)[1:]
    error = scatter(len(gas), 1.0, states[-1].time)
    found = np.mean([state.temperature for state in states])
    assert found == pytest.approx(1e-6, rel=4.0 * error)


@pytest.fixture
def free() -> ld.Packing:
    """Far apart, so that none touches another in a short motion."""
    x, y = np.divmod(np.arange(400), 20)
    return ld.Packing(2.0 + 4.0 * np.column_stack([x, y]), 0.5, 80.0 * np.eye(2))


def correlation(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.sum(a * b) / np.sqrt(np.sum(a**2) * np.sum(b**2)))


def test_initial_velocities_are_those_of_maxwell(free: ld.Packing) -> None:
    """The fourth moment is 3, of a uniform distribution 1.8; n values scatter by (96/n)^(1/2)."""
    with ld.Simulation(free, SOFT) as sim:
        (state,) = sim.run(1, timestep=1e-3, temperature=1e-6, seed=1)[1:]
    v = state.velocities / state.velocities.std()
    assert np.mean(v**4) == pytest.approx(3.0, abs=3.0 * np.sqrt(96.0 / v.size))
    assert state.temperature == pytest.approx(1e-6)


def test_a_heat_bath_goes_on_in_a_second_call(free: ld.Packing) -> None:
    """The same velocities, and other noise, so that free particles diffuse as in a single call."""
    with ld.Simulation(free, SOFT) as sim:
        first = sim.run(100, timestep=0.1, temperature=1e-6, drag=1e-6, seed=1)[-1]
        (second,) = sim.run(1, timestep=0.1, temperature=1e-6, drag=1e-6, seed=1)[1:]
        assert second.velocities == pytest.approx(first.velocities, abs=1e-2 * 1e-3)
    friction, dt, steps, moved = 2.0, 0.1, 100, []
    with ld.Simulation(free, SOFT) as sim:
        for _ in range(10):
            before = sim.state().packing.positions
            last = sim.run(steps, every=100, timestep=dt, temperature=1e-6, drag=friction, seed=1)[
                -1
            ]
            moved.append(last.packing.positions - before)
    scatter = 4.0 / np.sqrt(moved[0].size)
    assert abs(correlation(moved[3], moved[4])) < scatter
    diffusion = 1e-6 / friction * 10 * steps * dt
    error = 4.0 / np.sqrt(len(free))  # and the memory of the noise of a call, 1/(friction time)
    assert np.mean(np.sum(moved, axis=0) ** 2) == pytest.approx(2.0 * diffusion, rel=error)


def test_without_a_seed_no_noise_is_repeated(free: ld.Packing) -> None:
    def end(seed: int | None) -> np.ndarray:
        with ld.Simulation(free, SOFT) as sim:
            last = sim.run(20, timestep=0.1, temperature=1e-6, drag=1.0, seed=seed)[-1]
        return last.velocities

    assert (end(7) == end(7)).all()
    assert abs(correlation(end(7), end(8))) < 0.15
    assert abs(correlation(end(None), end(None))) < 0.25  # seven standard errors


def test_a_single_particle() -> None:
    """At rest it has no temperature to begin with; in a bath v^2/d is that of the bath."""
    alone = ld.Packing([[1.0, 1.0]], 0.5, 4.0 * np.eye(2))
    with ld.Simulation(alone, SOFT) as sim:
        with pytest.raises(ld.ParameterError, match="temperature"):
            sim.run(100, temperature=1e-5, seed=1)
        assert sim.run(100, seed=1)[1].temperature == 0.0
        states = sim.run(1000, temperature=1e-4, drag=0.5, every=10, timestep=0.4, seed=3)
    assert states[0].temperature > 0.0
    assert states[0].temperature == pytest.approx(np.sum(states[0].velocities ** 2) / 2.0)
    error = len(states) ** -0.5  # of independent energies with two degrees of freedom
    found = np.mean([state.temperature for state in states])
    assert found == pytest.approx(1e-4, rel=4.0 * error)


@pytest.mark.parametrize("every", [20, 1000])
def test_time_steps_are_those_of_the_bath(loose: ld.Packing, every: int) -> None:
    """Not of a fluid that is still cold, whose particles would jump into each other."""
    with ld.Simulation(loose, ld.Ring()) as sim:
        from_rest = sim.run(1, temperature=1e-4, drag=0.05, seed=2)[-1].time
    with ld.Simulation(loose, ld.Ring()) as sim:
        sim.run(50, temperature=1e-14, drag=0.05, seed=1)
        states = sim.run(1000, temperature=1e-4, drag=0.05, every=every, seed=2)
    assert (states[1].time - states[0].time) / every == pytest.approx(from_rest)
    assert states[-1].temperature < 2e-4

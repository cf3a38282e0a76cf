"""Motion of droplets in three dimensions, and the time steps that their contacts allow."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import Droplet, Packing, State
from lammps_deformable.engine.lammps import gather, place_particles, run
from lammps_deformable.particles.laws import longest_overdamped_step, longest_step
from lammps_deformable.state.recorded import numbers_of, step_limits
from refusals import refused


@pytest.fixture(scope="module")
def jammed() -> Packing:
    start = ld.bidisperse(32, sizes=(1.0, 1.2), dimension=3, seed=1)
    return ld.jam(start, tolerance=1e-2).packing


@pytest.fixture(scope="module")
def loose() -> Packing:
    return ld.bidisperse(32, phi=0.3, dimension=3, seed=3).push_off()


def stiffest(sim: ld.Simulation, state: State) -> float:
    """The largest eigenvalue of the Hessian, by the power method on differences of forces."""
    x, small = state.packing.positions, 1e-5
    v = np.random.default_rng(1).normal(size=x.shape)
    for _ in range(40):
        v /= np.linalg.norm(v)
        forces = []
        for sign in (1.0, -1.0):
            place_particles(sim.lmp, x + sign * small * np.sqrt(len(x)) * v)
            run(sim.lmp, "run 0 post no")
            forces.append(gather(sim.lmp, "f", 3))
        v = (forces[1] - forces[0]) / (2.0 * small * np.sqrt(len(x)))
    return float(np.linalg.norm(v))


@pytest.mark.parametrize(("kind", "phi"), [("random", 0.645), ("bcc", 0.8), ("sc", 0.55)])
def test_longest_steps_are_stable_and_not_by_far(jammed: Packing, kind: str, phi: float) -> None:
    """Verlet up to 2/omega, Euler up to 2 friction/omega^2, of the stiffest mode."""
    packing = jammed if kind == "random" else ld.crystal(kind, 2, radius=1.0)
    with ld.Simulation(packing.at(phi), Droplet(2.0)) as sim:
        state = sim.relax(1e-4)
        largest = stiffest(sim, state)
    assert 0.5 < longest_step(*step_limits(state)) / (2.0 / np.sqrt(largest)) < 1.0
    euler = longest_overdamped_step(*step_limits(state), 3.0)
    assert 0.1 < euler / (2.0 * 3.0 / largest) < 0.5


def test_energy_error_falls_with_the_square_of_the_time_step(jammed: Packing) -> None:
    errors, steps = [], np.array([0.1, 0.05, 0.025])
    for step in steps:
        with ld.Simulation(jammed.at(0.7), Droplet()) as sim:
            sim.relax(1e-6)
            states = sim.run(
                round(8 / step),
                timestep=float(step),
                temperature=1e-4,
                every=round(0.4 / step),
                seed=1,
            )[1:]
        total = [state.energy + state.kinetic_energy for state in states]
        errors.append(np.std(total))
        assert np.abs(states[-1].velocities.sum(axis=0)).max() < 1e-12
        assert states[-1].time == pytest.approx(8.0)
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.3)
    assert errors[-1] < 1e-3 * states[-1].kinetic_energy
    assert numbers_of(states[-1])["temperature"] == states[-1].temperature > 0.0


def test_a_heat_bath_has_its_temperature(loose: Packing) -> None:
    """Sum of v^2/2 over 32 droplets is gamma-distributed, and 60 states are about independent."""
    temperature, number = 1e-3, 60
    with ld.Simulation(loose, Droplet()) as sim:
        states = sim.run(20 * number, temperature=temperature, drag=0.5, every=20, seed=1)[1:]
        kinetic = [state.kinetic_energy for state in states]
    expected = 1.5 * 32 * temperature
    error = expected / np.sqrt(1.5 * 32) / np.sqrt(number / 4.0)  # correlated
    assert np.mean(kinetic[5:]) == pytest.approx(expected, abs=4.0 * error)


def test_free_droplets_diffuse_in_three_dimensions() -> None:
    """<r^2> = 6 (T/friction) t of droplets that do not touch."""
    gas = ld.crystal("sc", 6, radius=1.0).at(0.01)
    with ld.Simulation(gas, Droplet()) as sim:
        first, _, last = sim.run(100, temperature=1e-3, drag=2.0, inertia=False, every=50, seed=1)
    assert not last.velocities.any()
    moved = last.displacements(first)
    square = np.sum(moved**2, axis=1)
    # a sum of 3 N squares of normal numbers
    expected = 6.0 * 1e-3 / 2.0 * last.time
    assert square.mean() == pytest.approx(expected, rel=5.0 * np.sqrt(2.0 / (3 * len(gas))))
    assert np.mean(moved**2, axis=0) == pytest.approx(
        expected / 3.0, rel=5.0 * np.sqrt(2.0 / len(gas))
    )


def test_motion_goes_on_where_it_was(loose: Packing) -> None:
    """Also from a state, and after a relaxation, whose time step is another one."""
    with ld.Simulation(loose, Droplet()) as sim:
        (whole,) = sim.run(100, timestep=0.05, temperature=1e-3, seed=1)[1:]
    with ld.Simulation(loose, Droplet()) as sim:
        (half,) = sim.run(50, timestep=0.05, temperature=1e-3, seed=1)[1:]
    with ld.Simulation(half, Droplet()) as sim:
        (other,) = sim.run(50, timestep=0.05)[1:]
        assert not sim.relax(1e-2).velocities.any()
    assert other.time == pytest.approx(5.0)
    assert np.abs(other.packing.positions - whole.packing.positions).max() < 1e-7
    assert np.abs(other.velocities - whole.velocities).max() < 1e-6 * np.abs(whole.velocities).max()


def test_a_tolerance_of_the_balance(jammed: Packing) -> None:
    """It is that of steps, and ends with the motion."""
    with ld.Simulation(jammed.at(0.66), Droplet()) as sim:
        ends = []
        for tolerance in (None, 1e-3):
            sim.reset(jammed.at(0.66))
            (last,) = sim.run(20, timestep=0.05, temperature=1e-2, seed=1, balance=tolerance)[1:]
            ends.append(last.packing.positions)
        difference = np.abs(ends[1] - ends[0]).max()
        assert 0.0 < difference < 1e-3
        assert sim.relax(1e-2).residual <= 1e-2


def test_refusals(loose: Packing) -> None:
    with ld.Simulation(loose, Droplet()) as sim:
        for values, message in (
            ({"timestep": 5.0, "temperature": None}, "droplet|particle .*, whose load is"),
            ({"timestep": 5.0}, r"timestep = 5 is too long for .* take at most 0\.\d+"),
            ({"propulsion": 1.0, "persistence": 1.0}, "get faster and faster: give a drag"),
            ({"inertia": False}, "need a drag"),
        ):
            with refused(message):
                sim.run(100, **{"temperature": 1e-5} | values)

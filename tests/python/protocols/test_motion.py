"""Motion in time: temperature, energy, time steps, and starts with overlaps."""

from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.protocols.motion import Dynamics
from refusals import refused

SOFT = ld.Ring(kP=0.3)


def test_random_places_are_a_start_after_push_off(dense: ld.Packing) -> None:
    assert dense.phi == pytest.approx(0.95)
    with ld.Simulation(dense, ld.Ring()) as sim:
        assert sim.relax().coordination > 4.0
    random = ld.bidisperse(32, phi=0.95, seed=3)
    with (
        ld.Simulation(random, ld.Ring()) as sim,
        pytest.raises(ld.LammpsError, match=r"of atoms \d+ and \d+ .*push_off"),
    ):
        sim.run(100)


def test_energy_error_falls_with_the_square_of_the_time_step() -> None:
    packing = ld.bidisperse(16, phi=0.9, seed=1).push_off()
    errors, steps = [], np.array([0.8, 0.4, 0.2])
    for step in steps:
        with ld.Simulation(packing, ld.Ring()) as sim:
            sim.relax()
            states = sim.run(
                round(160 / step),
                timestep=float(step),
                temperature=1e-6,
                every=round(4 / step),
                seed=1,
            )[1:]
        total = [state.energy + state.kinetic_energy for state in states]
        errors.append(np.std(total))
        momentum = states[-1].velocities.sum(axis=0)
        assert np.abs(momentum).max() < 1e-13
    # three points of a chaotic trajectory scatter about 2
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.4)
    assert errors[-1] < 1e-3 * states[-1].kinetic_energy


def test_relaxing_on_the_way_leaves_the_time_step(dense: ld.Packing) -> None:
    """FIRE has its own time step, which must not become that of the motion."""
    seen = []

    def relax(_: ld.State) -> None:
        seen.append(sim.lmp.extract_global("dt"))
        if len(seen) == 1:
            sim.relax()
            assert sim.lmp.extract_global("dt") != 0.01

    with ld.Simulation(dense, ld.Ring(), minimizer="fire") as sim:
        sim.run(4, timestep=0.01, temperature=1e-6, every=2, seed=1, callback=relax)
    assert seen == [0.01, 0.01]


def test_velocities_decay_at_the_rate_of_friction() -> None:
    """By (1 - x)/(1 + x) in a step, x = friction dt/2, which is exp(-2 x) to third order."""
    gas = ld.bidisperse(16, phi=0.01, seed=3).push_off()
    friction, dt = 0.1, 0.5
    with ld.Simulation(gas, ld.Ring()) as sim:
        (_,) = sim.run(1, timestep=dt, temperature=1e-6, seed=1)[1:]
        first, *_, last = sim.run(40, timestep=dt, drag=friction, every=10)[1:]
    assert not last.n_contacts.any()
    decay = np.exp(-friction * (last.time - first.time))
    third = (friction * dt) ** 2 / 12.0 * friction * last.time
    assert last.velocities == pytest.approx(decay * first.velocities, rel=third)


def test_motion_goes_on_where_it_was(loose: ld.Packing) -> None:
    with ld.Simulation(loose, SOFT) as sim:
        (whole,) = sim.run(200, timestep=0.2, temperature=1e-5, seed=1)[1:]
    with ld.Simulation(loose, SOFT) as sim:
        (half,) = sim.run(100, timestep=0.2, temperature=1e-5, seed=1)[1:]
        (other,) = sim.run(100, timestep=0.2)[1:]
        assert not sim.relax().velocities.any()
    assert half.time == pytest.approx(20.0)
    assert other.time == pytest.approx(40.0)
    apart = other.packing.positions - whole.packing.positions
    assert np.abs(apart).max() < 1e-9
    # forces have no other tolerance than 1e-8, and another start leads to another rest of it
    assert np.abs(other.velocities - whole.velocities).max() < 1e-8 * np.abs(whole.velocities).max()


def test_a_restart_within_a_motion_is_refused(loose: ld.Packing) -> None:
    with ld.Simulation(loose, SOFT) as sim:
        motion = {"every": 100, "temperature": 1e-6, "seed": 1}
        with pytest.raises(ld.LammpsError, match="reset while its particles move"):
            sim.run(300, **motion, callback=lambda state: sim.reset(state.packing))
        assert sim.run(100, temperature=1e-6, seed=1)[1].temperature > 0.0


def test_one_motion_at_a_time(loose: ld.Packing) -> None:
    with ld.Simulation(loose, SOFT) as sim:
        with pytest.raises(ld.ParameterError, match="whose callback begins another one"):
            sim.run(100, temperature=1e-6, seed=1, callback=lambda _: sim.run(100) and None)
        assert sim.run(100)[1].temperature > 0.0


def test_an_early_end_leaves_no_trace(loose: ld.Packing) -> None:
    """By a callback that says so, with that state in the result, or that fails."""
    with ld.Simulation(loose, SOFT) as sim:
        how = {"temperature": 1e-5, "drag": 1.0, "every": 1500, "seed": 1}
        run = sim.run(3000, **how, callback=lambda state: np.bool_(state.time > 0.0))
        assert [state.time > 0.0 for state in run] == [False, True]
        assert not sim.lmp.numpy.extract_atom("x")[: len(loose), 2].any()  # all in the plane
        assert sim.lmp.available_ids("fix") == ["deformable_restart"]
        with pytest.raises(TypeError, match=r"callback must return None .* not 3"):
            sim.run(10, callback=lambda _: 3)
        assert sim.lmp.available_ids("fix") == ["deformable_restart"]


def test_a_callback_may_close_the_simulation(loose: ld.Packing) -> None:
    def close(_: ld.State) -> bool:
        sim.close()
        return True

    sim = ld.Simulation(loose, SOFT)
    assert len(sim.run(200, every=100, temperature=1e-5, seed=1, callback=close)) == 2
    assert sim.closed


def test_refusals(loose: ld.Packing) -> None:
    with ld.Simulation(loose, SOFT) as sim:
        for values, message in (
            ({"timestep": 50.0}, r"timestep = 50 is too long for the temp.* take at most 0\.\d+"),
            ({"timestep": -1.0}, "timestep .* -1"),
            ({"temperature": -1.0}, "temperature .* -1"),
            ({"drag": float("inf")}, "drag .* inf"),
            ({"steps": 100.5}, "steps must be a whole number, not 100.5"),
            ({"every": 0}, "every must be at least 1, not 0"),
            ({"seed": 0}, "seed .* not 0"),
            ({"balance": 0.0}, "balance .* not 0"),
            ({"balance": 1.0}, "balance must be below 1, not 1"),
            ({"tolerance": 1e-3}, "tolerance has no meaning without a pressure"),
        ):
            with refused(message):
                sim.run(**{"steps": 100, "temperature": 1e-5} | values)
            assert not sim.state().velocities.any()  # those of the heat bath are gone


def test_a_short_motion_is_one_state(loose: ld.Packing) -> None:
    with ld.Simulation(loose, SOFT) as sim:
        (state,) = sim.run(10, timestep=0.01)[1:]
        assert state.time == pytest.approx(0.1)
        assert [state.time for state in sim.run(25, every=10, timestep=0.01)] == pytest.approx(
            [0.1, 0.2, 0.3, 0.35]
        )


def test_steps_that_become_too_long_are_refused(loose: ld.Packing) -> None:
    def squeeze(state: ld.State) -> None:
        assert state.phi < 0.95
        sim.deform(0.995 * sim.box)

    how = {"temperature": 1e-7, "drag": 0.1, "every": 10, "seed": 1}
    with (
        ld.Simulation(loose, SOFT) as sim,
        pytest.raises(ld.ParameterError, match=r"timestep = 2\.5 is too long for"),
    ):
        sim.run(1000, timestep=2.5, callback=squeeze, **how)


def test_default_steps_become_shorter_with_the_pressure() -> None:
    """Particles that fall: the default of the start is too long, and unknown where all rest."""
    walls = ld.BoxWall((10, 12)).parts
    start = ld.bidisperse(30, seed=1).between(walls).push_off()
    with ld.Simulation(start, ld.Ring()) as sim:
        sim.lmp.command("fix down all gravity 1e-3 vector 0 -1 0")
        with pytest.raises(ld.LammpsError, match=r"or give a smaller timestep than .*, which was"):
            sim.run(600, drag=0.01, every=300)
    with ld.Simulation(start, ld.Ring()) as sim:
        sim.lmp.command("fix down all gravity 1e-3 vector 0 -1 0")
        states = sim.run(600, temperature=1e-6, drag=0.01, every=300, seed=1)[1:]
    assert states[1].time - states[0].time < 0.5 * states[0].time
    assert states[1].packing.positions[:, 1].mean() < start.positions[:, 1].mean() - 1.0


@pytest.mark.parametrize(("phi", "temperature"), [(0.6, 1e-5), (0.95, 1e-8)])
def test_longest_step_is_stable_and_not_by_far(
    phi: float, temperature: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The energy is constant to 1 % at the longest step; eight times this step ends the run."""
    packing = ld.bidisperse(32, phi=phi, seed=3).push_off()

    def motion(sim: ld.Simulation, timestep: float | None) -> list[ld.State]:
        return sim.run(1000, timestep=timestep, temperature=temperature, every=20, seed=1)[1:]

    with ld.Simulation(packing, ld.Ring()) as sim:
        sim.relax()
        longest = motion(sim, None)[0].time / 20 / 0.2  # the default is a fifth of it
        sim.relax()
        states = motion(sim, 0.95 * longest)
        total = [state.energy + state.kinetic_energy for state in states]
        assert np.std(total) < 0.01 * states[-1].kinetic_energy
        sim.relax()
        monkeypatch.setattr(Dynamics, "check", lambda *_: None)
        with pytest.raises(ld.LammpsError):
            motion(sim, 8.0 * longest)


@pytest.mark.parametrize("wall", [ld.BoxWall((6.0, 6.0)), ld.Sphere(1.0, (4.5, 3.0), inside=False)])
@pytest.mark.parametrize("speed", [1e-2, 1e-3])
def test_particles_that_move_together_hit_walls(wall: Any, speed: float) -> None:
    """Their temperature is zero, and so it is of one particle: steps follow the fastest one."""
    pair = np.array([[2.0, 2.2], [2.0, 3.8]])
    for places in (pair, pair[:1]):
        packing = ld.Packing(places, 0.5, (6.0, 6.0)).between(wall).replace(positions=places)
        with ld.Simulation(packing, ld.Ring()) as sim:
            sim.lmp.command(f"velocity all set {speed} 0 0")
            begin = sim.state()
            steps = int(4.0 / (0.013 * speed**0.5))
            *_, end = states = sim.run(steps, every=steps // 8)
        assert min(state.velocities[:, 0].min() for state in states) < 0.9 * speed  # it has hit
        assert end.energy + end.kinetic_energy == pytest.approx(begin.kinetic_energy, rel=1e-2)


def test_too_fast_particles_are_named() -> None:
    alone = ld.Packing([[2.0, 2.0]], 0.5, (4.0, 4.0)).between(ld.BoxWall((4.0, 4.0)))
    with ld.Simulation(alone, ld.Ring()) as sim:
        sim.lmp.command("velocity all set 0.01 0 0")
        with pytest.raises(ld.ParameterError, match=r"particles that collide as hard.*at most"):
            sim.run(10, timestep=5.0)


def test_too_high_temperatures_are_named(loose: ld.Packing) -> None:
    with (
        ld.Simulation(loose, SOFT) as sim,
        pytest.raises(ld.LammpsError, match=r"atom.* or lower the temperature$"),
    ):
        sim.run(5000, every=100, temperature=1.0, seed=1)


def test_particles_of_any_size_and_stiffness_move() -> None:
    """Masses are 1 for any radius; the stiffest species limits the time step."""
    radii = np.random.default_rng(2).uniform(0.4, 0.8, 32)
    packing = ld.polydisperse(32, radii, phi=0.85, seed=2).push_off()
    with ld.Simulation(packing, ld.Ring()) as sim:
        states = sim.run(4000, temperature=1e-6, every=200, seed=1)[1:]
    total = [state.energy + state.kinetic_energy for state in states]
    assert np.std(total) < 1e-3 * states[-1].kinetic_energy
    mixed = ld.bidisperse(16, phi=0.3, seed=2)
    pace = []
    for kA in ((1.0, 1.0), (1.0, 16.0)):
        mixture = ld.Ring(kA=kA, kP=(np.inf, 1.0))
        with ld.Simulation(mixed.push_off(), mixture) as sim:
            pace.append(sim.run(1, temperature=1e-6, seed=1)[1].time)
    # 1 and kP/R^2 = 1/0.49, to the power of 1/4
    assert pace[1] / pace[0] == pytest.approx(0.49**0.25)


def test_contacts_are_balanced_to_the_tolerance_meanwhile(loose: ld.Packing) -> None:
    with ld.Simulation(loose, ld.Ring(kP=0.3, contact="curved")) as sim:
        (state,) = sim.run(20, temperature=1e-4, drag=0.1, seed=1, balance=1e-3)[1:]
        imbalance = sim.lmp.numpy.extract_compute("deformable_beyond", 0, 1)[3]
        assert 1e-8 < imbalance <= 1e-3
        after = sim.state()
        imbalance = sim.lmp.numpy.extract_compute("deformable_beyond", 0, 1)[3]
        assert imbalance <= 1e-8
    assert state.energy == pytest.approx(after.energy, rel=1e-3)  # it is least with the right ones


def test_radical_contacts_need_no_balance(loose: ld.Packing) -> None:
    energies = []
    for tolerance in (None, 1e-3):
        with ld.Simulation(loose, ld.Ring(contact="radical")) as sim:
            (state,) = sim.run(20, temperature=1e-5, seed=1, balance=tolerance)[1:]
        energies.append(state.energy)
    assert energies[0] == energies[1]


def test_a_tolerance_hides_no_other_law(loose: ld.Packing) -> None:
    def other_law(_: ld.State) -> None:
        sim.lmp.command("pair_style deformable/ring")

    how = {"timestep": 0.01, "temperature": 1e-5, "every": 10, "seed": 1, "balance": 1e-4}
    with (
        ld.Simulation(loose, ld.Ring()) as sim,
        pytest.raises(ld.LammpsError, match="cannot follow pair_style"),
    ):
        sim.run(20, callback=other_law, **how)

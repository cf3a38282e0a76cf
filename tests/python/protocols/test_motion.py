"""Motion in time: temperature, energy, time steps, and starts with overlaps."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.motion import Dynamics, move

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
        next(move(sim, 100))


@pytest.mark.parametrize("phi", [0.6, 0.9])
def test_energy_error_falls_with_the_square_of_the_time_step(phi: float) -> None:
    packing = ld.bidisperse(16, phi=phi, seed=1).push_off()
    errors, steps = [], np.array([0.8, 0.4, 0.2])
    for step in steps:
        with ld.Simulation(packing, ld.Ring()) as sim:
            sim.relax()
            states = list(
                move(sim, round(160 / step), float(step), 1e-6, every=round(4 / step), seed=1)
            )
        total = [state.energy + state.kinetic_energy for state in states]
        errors.append(np.std(total))
        momentum = states[-1].velocities.sum(axis=0)
        assert np.abs(momentum).max() < 1e-13
    # three points of a chaotic trajectory scatter about 2
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.4)
    assert errors[-1] < 1e-3 * states[-1].kinetic_energy


def test_relaxing_on_the_way_leaves_the_time_step(dense: ld.Packing) -> None:
    """FIRE has its own time step, which must not become that of the motion."""
    with ld.Simulation(dense, ld.Ring()) as sim:
        motion = ld.move(sim, 4, 0.01, temperature=1e-6, every=2, seed=1)
        next(motion)
        sim.relax()
        assert sim.lmp.extract_global("dt") != 0.01
        next(motion)
        assert sim.lmp.extract_global("dt") == 0.01


def test_damped_motion_comes_to_rest(dense: ld.Packing) -> None:
    with ld.Simulation(dense, ld.Ring()) as sim:
        states = list(move(sim, 4000, friction=0.05, every=200))
    total = np.array([state.energy + state.kinetic_energy for state in states])
    assert (np.diff(total) < 1e-9 * total[0]).all()
    assert states[-1].kinetic_energy < 1e-3 * max(state.kinetic_energy for state in states)
    assert states[-1].residual < 0.1 * states[0].residual


def test_velocities_decay_at_the_rate_of_friction() -> None:
    """By (1 - x)/(1 + x) in a step, x = friction dt/2, which is exp(-2 x) to third order."""
    gas = ld.bidisperse(16, phi=0.01, seed=3).push_off()
    friction, dt = 0.1, 0.5
    with ld.Simulation(gas, ld.Ring()) as sim:
        (_,) = move(sim, 1, dt, temperature=1e-6, every=1, seed=1)
        first, *_, last = move(sim, 40, dt, friction=friction, every=10)
    assert not last.contacts.any()
    decay = np.exp(-friction * (last.time - first.time))
    third = (friction * dt) ** 2 / 12.0 * friction * last.time
    assert last.velocities == pytest.approx(decay * first.velocities, rel=third)


def test_motion_goes_on_where_it_was(loose: ld.Packing) -> None:
    with ld.Simulation(loose, SOFT) as sim:
        (whole,) = move(sim, 200, 0.2, 1e-5, every=200, seed=1)
    with ld.Simulation(loose, SOFT) as sim:
        (half,) = move(sim, 100, 0.2, 1e-5, seed=1)
        (other,) = move(sim, 100, 0.2)
        assert not sim.relax().velocities.any()
    assert half.time == pytest.approx(20.0)
    assert other.time == pytest.approx(40.0)
    apart = other.packing.positions - whole.packing.positions
    assert np.abs(apart).max() < 1e-9
    # forces have no other tolerance than 1e-8, and another start leads to another rest of it
    assert np.abs(other.velocities - whole.velocities).max() < 1e-8 * np.abs(whole.velocities).max()


def test_a_restart_within_a_motion_is_refused(loose: ld.Packing) -> None:
    with ld.Simulation(loose, SOFT) as sim:
        motion = move(sim, 300, temperature=1e-6, seed=1)
        state = next(motion)
        sim.reset(state.packing)
        with pytest.raises(ld.LammpsError, match="reset while its particles move"):
            next(motion)
        assert next(move(sim, 100, temperature=1e-6, seed=1)).temperature > 0.0


def test_one_motion_at_a_time(loose: ld.Packing) -> None:
    with ld.Simulation(loose, SOFT) as sim:
        first, second = move(sim, 300, temperature=1e-6, seed=1), move(sim, 100)
        next(first)
        with pytest.raises(ld.ParameterError, match=r"another move .* has not ended"):
            next(second)
        assert next(first).temperature > 0.0  # which goes on
        first.close()
        assert next(move(sim, 100)).temperature > 0.0


def test_an_early_end_leaves_no_trace(loose: ld.Packing) -> None:
    with ld.Simulation(loose, SOFT) as sim:
        motion = move(sim, 3000, temperature=1e-5, friction=1.0, every=1500, seed=1)
        next(motion)
        assert not sim.lmp.numpy.extract_atom("x")[: len(loose), 2].any()  # all in the plane
        motion.close()
        assert sim.lmp.available_ids("fix") == ["deformable_restart"]


@pytest.mark.filterwarnings("error::pytest.PytestUnraisableExceptionWarning")
def test_a_motion_may_outlive_its_simulation(loose: ld.Packing) -> None:
    with ld.Simulation(loose, SOFT) as sim:
        motion = move(sim, 200, temperature=1e-5, seed=1)
        next(motion)
    motion.close()
    with pytest.raises(StopIteration):
        next(motion)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"timestep": 50.0}, r"timestep = 50 is too long for the temp.* take at most 0\.\d+"),
        ({"timestep": 50.0, "temperature": 0.01}, r"too long for the temperature of 0\.01"),
        ({"timestep": -1.0}, "timestep .* -1"),
        ({"temperature": -1.0}, "temperature .* -1"),
        ({"temperature": "warm"}, "temperature .* 'warm'"),
        ({"friction": float("inf")}, "friction .* inf"),
        ({"temperature": np.array([1.0])}, r"temperature .* \[1\.0\]"),
        ({"steps": 100.5}, "steps must be a whole number, not 100.5"),
        ({"every": 30}, "multiple of every, not 100 and 30"),
        ({"steps": 150}, "multiple of every, not 150 and 100: give another every"),
        ({"steps": 10, "timestep": -1.0, "every": 3}, "timestep .* -1"),
        ({"seed": 0}, "seed .* not 0"),
        ({"tolerance": 0.0}, "tolerance .* not 0"),
        ({"tolerance": 1.0}, "tolerance must be below 1, not 1"),
    ],
)
def test_refusals(loose: ld.Packing, values: dict[str, float], message: str) -> None:
    with (
        ld.Simulation(loose, SOFT) as sim,
        pytest.raises(ld.ParameterError, match=message),
    ):
        next(move(sim, **{"steps": 100, "temperature": 1e-5} | values))


def test_a_short_motion_is_one_state(loose: ld.Packing) -> None:
    with ld.Simulation(loose, SOFT) as sim:
        (state,) = move(sim, 10, 0.01)
        assert state.time == pytest.approx(0.1)
        assert len(list(move(sim, 200, 0.01))) == 2


@pytest.mark.parametrize("values", [{"steps": 100, "friction": 0.1}, {"steps": 0, "timestep": -1}])
def test_sector_is_refused_before_other_values(loose: ld.Packing, values: dict[str, float]) -> None:
    with (
        ld.Simulation(loose, ld.Sector()) as sim,
        pytest.raises(ld.ParameterError, match=r"energy of Sector jumps.*take Ring"),
    ):
        move(sim, **values)


def test_steps_that_become_too_long_are_refused(loose: ld.Packing) -> None:
    def squeeze(sim: ld.Simulation) -> None:
        for state in move(sim, 1000, 2.5, temperature=1e-7, friction=0.1, every=10, seed=1):
            assert state.phi < 0.95
            sim.deform(0.995 * sim.box)

    with (
        ld.Simulation(loose, SOFT) as sim,
        pytest.raises(ld.ParameterError, match=r"timestep = 2\.5 is too long for"),
    ):
        squeeze(sim)


def test_default_steps_become_shorter_with_the_pressure() -> None:
    """Particles that fall: the default of the start is too long, and unknown where all rest."""
    walls = ld.BoxWall((10, 12)).parts
    start = ld.bidisperse(30, seed=1).between(walls).push_off()
    with ld.Simulation(start, ld.Ring()) as sim:
        sim.lmp.command("fix down all gravity 1e-3 vector 0 -1 0")
        with pytest.raises(ld.LammpsError, match=r"or give a smaller timestep than .*, which was"):
            list(move(sim, 600, friction=0.01, every=300))
    with ld.Simulation(start, ld.Ring()) as sim:
        sim.lmp.command("fix down all gravity 1e-3 vector 0 -1 0")
        states = list(move(sim, 600, temperature=1e-6, friction=0.01, every=300, seed=1))
    assert states[1].time - states[0].time < 0.5 * states[0].time
    assert states[1].packing.positions[:, 1].mean() < start.positions[:, 1].mean() - 1.0


@pytest.mark.parametrize(("phi", "temperature"), [(0.6, 1e-5), (0.9, 1e-5), (0.95, 1e-8)])
def test_longest_step_is_stable_and_not_by_far(
    phi: float, temperature: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The energy is constant to 1 % at the longest step; eight times this step ends the run."""
    packing = ld.bidisperse(32, phi=phi, seed=3).push_off()

    def motion(sim: ld.Simulation, timestep: float | None) -> list[ld.State]:
        return list(move(sim, 1000, timestep, temperature, every=20, seed=1))

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


def test_too_high_temperatures_are_named(loose: ld.Packing) -> None:
    with (
        ld.Simulation(loose, SOFT) as sim,
        pytest.raises(ld.LammpsError, match=r"atom.* or lower the temperature$"),
    ):
        list(move(sim, 5000, temperature=1.0, seed=1))


def test_particles_of_any_size_and_stiffness_move() -> None:
    """Masses are 1 for any radius; the stiffest species limits the time step."""
    radii = np.random.default_rng(2).uniform(0.4, 0.8, 32)
    packing = ld.polydisperse(32, radii, phi=0.85, seed=2).push_off()
    with ld.Simulation(packing, ld.Ring()) as sim:
        states = list(move(sim, 4000, temperature=1e-6, every=200, seed=1))
    total = [state.energy + state.kinetic_energy for state in states]
    assert np.std(total) < 1e-3 * states[-1].kinetic_energy
    mixed = ld.bidisperse(16, phi=0.3, seed=2)
    pace = []
    for kA in ((1.0, 1.0), (1.0, 16.0)):
        mixture = ld.Ring(kA=kA, kP=(np.inf, 1.0))
        with ld.Simulation(mixed.push_off(), mixture) as sim:
            pace.append(next(move(sim, 1, temperature=1e-6, every=1, seed=1)).time)
    # 1 and kP/R^2 = 1/0.49, to the power of 1/4
    assert pace[1] / pace[0] == pytest.approx(0.49**0.25)


@pytest.mark.parametrize("contact", ["balanced", "curved"])
def test_contacts_are_balanced_to_the_tolerance_meanwhile(loose: ld.Packing, contact: str) -> None:
    with ld.Simulation(loose, ld.Ring(kP=0.3, contact=contact)) as sim:
        (state,) = move(sim, 20, temperature=1e-4, friction=0.1, seed=1, tolerance=1e-3)
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
            (state,) = move(sim, 20, temperature=1e-5, seed=1, tolerance=tolerance)
        energies.append(state.energy)
    assert energies[0] == energies[1]


def test_a_tolerance_hides_no_other_law(loose: ld.Packing) -> None:
    with ld.Simulation(loose, ld.Ring()) as sim:
        motion = move(sim, 20, 0.01, temperature=1e-5, every=10, seed=1, tolerance=1e-4)
        next(motion)
        sim.lmp.command("pair_style deformable/ring")
        with pytest.raises(ld.LammpsError, match="cannot follow pair_style"):
            next(motion)

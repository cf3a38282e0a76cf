"""Motion where contacts rub, by the settings of a simulation or by a fix of LAMMPS."""

from dataclasses import replace
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.particles.friction import longest_rubbing_step
from refusals import refused

RUB = "fix rub all deformable/friction 0.5 1e-3 1e-4 damp 1e-3"
FRICTION = ld.Friction(0.5, kt=1e-3, gt=1e-4, damping=1e-3)


def fluid() -> ld.Packing:
    return ld.bidisperse(16, phi=0.7, seed=2).push_off()


def test_particles_turn_and_energy_balances() -> None:
    """Kinetic, of spins too, potential, stored and lost."""
    with ld.Simulation(fluid(), ld.Ring(), friction=FRICTION) as sim:
        states = sim.run(600, temperature=1e-5, seed=1, every=200)[1:]
        spin = np.array(sim.lmp.gather("omega", 1, 3))[2::3]
        rubbed = sim.lmp.extract_fix("deformable_friction", 0, 0)
    *_, state = states
    np.testing.assert_array_equal(state.spins, spin)
    assert np.abs(spin).max() > 1e-4
    assert state.spring_energy + state.lost_energy == pytest.approx(rubbed, rel=1e-12)
    assert state.rubbing.lost[0] > 0
    sums = [s.kinetic_energy + s.energy + s.spring_energy + s.lost_energy for s in states]
    assert sums == pytest.approx([sums[0]] * 3, rel=1e-3)


@pytest.mark.parametrize("d", [2, 3])
def test_where_energy_is_lost(d: int, tmp_path: Path) -> None:
    """By particles, from record to record, and the power of contacts; a map of it."""
    rough = replace(FRICTION, film=1e-3, ledger=True)
    law = ld.Ring() if d == 2 else ld.Droplet(0.1)
    start = fluid() if d == 2 else ld.bidisperse(12, phi=0.7, dimension=3, seed=1).push_off()
    settings = {"temperature": 1e-5, "seed": 1, "every": 100}
    with ld.Simulation(start, law, friction=rough) as sim:
        states = sim.run(300, record=tmp_path / "run", **settings)
        dt = (states[-1].time - states[-2].time) / 100
        further = sim.run(1, timestep=dt)[-1]
    read = ld.Run(tmp_path / "run")
    for state in (*states[1:], *read[1:], further):
        lost, each = np.array(state.rubbing.lost), state.lost_by_particle
        assert lost[1:].min() > 0.0
        np.testing.assert_allclose(each.sum(axis=0), lost, rtol=1e-12)
        table = state.contacts
        sides = table[table["i"] < table["j"]]["power"], table[table["i"] > table["j"]]["power"]
        np.testing.assert_allclose(*(power.sum(axis=0) for power in sides), rtol=1e-12)
    (more,) = read.simulation().run(1, timestep=dt)[1:]
    np.testing.assert_allclose(more.lost_by_particle, further.lost_by_particle, 1e-6, 1e-18)
    step = more.lost_by_particle.sum() - states[-1].lost_by_particle.sum()
    assert sides[0].sum() * dt == pytest.approx(step, rel=0.05)
    state.save(tmp_path / "state")
    saved = ld.Run(tmp_path / "state").simulation().state()
    np.testing.assert_array_equal(saved.lost_by_particle, state.lost_by_particle)
    np.testing.assert_array_equal(saved._values("lost_films"), state.lost_by_particle[:, 3])
    state.plot(color=state.lost_by_particle.sum(axis=1), label="lost")
    state.to_pandas()
    with ld.Simulation(fluid(), ld.Ring(), friction=FRICTION) as sim:
        assert sim.state().lost_by_particle is None
        assert "power" not in sim.state().contacts.dtype.names


def test_motion_that_is_damped() -> None:
    """Velocities and spins of a particle decay at the same rate."""
    alone = ld.Packing([[1.0, 1.0]], 0.5, [3.0, 3.0])
    with ld.Simulation(alone, ld.Ring(), friction=FRICTION) as sim:
        sim.lmp.command("set group all vx 1.0 omega 0 0 2.0")
        state = sim.run(200, every=100, timestep=0.05, drag=0.1)[-1]
        spin = sim.lmp.gather("omega", 1, 3)[2]
    # by steps of dv = -friction dt v: to first order in friction dt
    assert state.velocities[0, 0] == pytest.approx(np.exp(-1.0), rel=4e-3)
    assert spin == pytest.approx(2.0 * state.velocities[0, 0], rel=1e-12)


def test_the_fix_of_a_user_without_spins() -> None:
    with ld.Simulation(fluid(), ld.Ring()) as sim:
        sim.lmp.command(RUB)
        for state in sim.run(400, every=100, temperature=1e-5, seed=1)[1:]:
            assert np.isfinite(state.energy)
        assert sim.lmp.extract_fix("rub", 0, 1, 1) > 0


def test_restart_rubs_again() -> None:
    with ld.Simulation(fluid(), ld.Ring(), friction=FRICTION) as sim:
        with pytest.raises(ld.ParameterError, match="radii"):
            sim.reset(ld.Packing([[1.0, 1.0]], -0.5, [3.0, 3.0]))
        sim.reset(fluid())
        assert "deformable_friction" in sim.lmp.available_ids("fix")


def test_what_does_not_turn() -> None:
    with ld.Simulation(fluid(), ld.Ring(), friction=FRICTION) as sim:
        for settings, message in (
            ({"drag": 0.1, "temperature": 1e-5}, "a heat bath do not turn"),
            (
                {"drag": 0.1, "inertia": False},
                "without inertia, .* do not turn: let them have inertia",
            ),
        ):
            with refused(message):
                sim.run(10, **settings)


def test_a_time_step_too_long_for_the_springs() -> None:
    """kt dt^2 = m/7 at most; the default is shorter."""
    hard = ld.Friction(0.5, kt=1.0)
    with ld.Simulation(fluid(), ld.Ring(), friction=hard) as sim:
        with pytest.raises(ld.ParameterError, match=r"\A[^\n]*at most 0.38,"):
            sim.run(10, timestep=0.5)
        (state,) = sim.run(10)[1:]
        assert state.time / 10 < 0.5 * longest_rubbing_step(hard)

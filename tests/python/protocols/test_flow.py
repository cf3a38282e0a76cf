"""Shear at a rate: energy balance, long strains, noise, and refusals."""

import lammps_deformable as ld
import numpy as np
import pytest
from refusals import refused

RATE, FRICTION = 1e-3, 1.0


@pytest.fixture(scope="module")
def rest() -> ld.State:
    packing = ld.jam(ld.bidisperse(16, seed=2)).packing
    with ld.Simulation(packing.at(packing.phi + 0.08), ld.Ring()) as sim:
        return sim.relax(1e-9)


def forces_on(state: ld.State) -> np.ndarray:
    forces = np.zeros((len(state.packing), 2))
    np.add.at(forces, state.contacts["i"], state.contacts["force_vector"])
    return forces


def test_work_of_the_flow_is_stored_or_lost_to_friction(rest: ld.State) -> None:
    """dE/dt = V sigma rate - sum F^2/friction, by the trapezium rule between states."""
    with ld.Simulation(rest, rest.law) as sim:
        states = sim.shear(0.05, steps=100, rate=RATE, drag=FRICTION)[1:]
    times = np.array([state.time for state in states])
    assert np.diff(times) == pytest.approx(0.05 / 100 / RATE)
    work = -np.array([state.pressure_tensor[0, 1] for state in states]) * rest.packing.volume * RATE
    lost = np.array([np.sum(forces_on(state) ** 2) / FRICTION for state in states])
    gain = np.trapezoid(work - lost, times)
    # steps of 5e-4 of strain, of which forces know the half, over indentations of some percent
    allowed = 0.01 * np.trapezoid(lost, times)
    assert states[-1].energy - states[0].energy == pytest.approx(gain, abs=allowed)


def test_slow_flow_is_quasistatic(rest: ld.State) -> None:
    """The stress is behind in proportion to the rate: two rates give that of the rate 0."""
    stress = []
    for rate in (0.0, 1e-7, 2e-7):
        given = {"rate": rate, "drag": FRICTION} if rate else {"tolerance": 1e-9}
        with ld.Simulation(rest, rest.law) as sim:
            state = sim.shear(2e-3, steps=2, **given)[-1]
        assert state.shear_strain == pytest.approx(2e-3)
        stress.append(rest.pressure_tensor[0, 1] - state.pressure_tensor[0, 1])
    still, slow, fast = stress
    assert 2.0 * slow - fast == pytest.approx(still, rel=0.02)
    assert slow != pytest.approx(still, rel=0.02)


def test_long_flows_go_on_in_equivalent_boxes(rest: ld.State) -> None:
    """Back and forth over several flips; a far particle follows the flow."""
    with ld.Simulation(rest, rest.law) as sim:
        states = [sim.state(), *sim.shear(2.5, steps=10, rate=1e-2, drag=FRICTION)[1:]]
        (lx, _), (_, ly) = rest.packing.box
        for state in states[1:]:
            turns = (
                rest.packing.box[1, 0] + state.shear_strain * ly - state.packing.box[1, 0]
            ) / lx
            assert turns == pytest.approx(round(turns), abs=1e-9)
            assert abs(state.packing.box[1, 0]) <= 0.55 * lx
        (back,) = sim.shear(-0.5, rate=1e-2, drag=FRICTION)[1:]
        assert back.shear_strain == pytest.approx(2.0)
        assert back.time == pytest.approx(300.0)


def test_free_particles_follow_the_flow_and_diffuse_in_it() -> None:
    """dr = u dt + noise: <y^2> = 2 D t, <x^2> = 2 D t (1 + gamma^2/3), <x y> = D gamma t."""
    x, y = np.divmod(np.arange(400), 20)
    packing = ld.Packing(2.0 + 4.0 * np.column_stack([x, y]), 0.5, 80.0 * np.eye(2))
    temperature, strain = 1e-5, 1.0
    with ld.Simulation(packing, ld.Ring()) as sim:
        (state,) = sim.shear(
            strain, rate=1e-3, drag=2.0, temperature=temperature, timestep=0.5, seed=1
        )[1:]
    assert not state.n_contacts.any()
    mean = packing.positions + strain * packing.positions[:, 1:] * [1.0, 0.0]
    moved = state.packing.positions - mean
    moved = (moved @ np.linalg.inv(state.packing.box) + 0.5) % 1.0 - 0.5
    dx, dy = (moved @ state.packing.box).T
    spread = temperature / 2.0 * state.time  # D t
    along = spread * (1.0 + strain**2 / 3.0)
    error = 5.0 * np.sqrt(2.0 / 400)  # five standard errors of a mean square
    assert np.mean(dy**2) == pytest.approx(2.0 * spread, rel=error)
    assert np.mean(dx**2) == pytest.approx(2.0 * along, rel=error)
    covariance = 5.0 * np.sqrt((4.0 * along * spread + (spread * strain) ** 2) / 400)
    assert np.mean(dx * dy) == pytest.approx(spread * strain, abs=covariance)
    assert covariance < spread * strain


def test_refusals(rest: ld.State) -> None:
    with ld.Simulation(rest, rest.law) as sim:
        for values, message in (
            ({"rate": 0.0, "drag": 1.0}, "rate must be a positive number, not 0"),
            ({"rate": 1e-3}, "a flow needs the drag"),
            ({"rate": 1e-3, "drag": 1.0, "temperature": -1.0}, "temperature must not be negative"),
            ({"rate": 1e-3, "drag": 1.0, "timestep": 1e9}, "timestep = .* take at most"),
            ({"rate": 1e-3, "drag": 1.0, "seed": 0}, "seed must lie between 1 and"),
            ({"rate": 1e-3, "drag": 1.0, "tolerance": 1e-6}, "leave tolerance out"),
            ({"drag": 1.0}, "drag has no meaning without a rate"),
            ({"inertia": True}, "inertia has no meaning without a rate"),
            ({"rate": 1e-3, "drag": 1.0, "inertia": True}, "and no drag: leave it out"),
        ):
            with refused(message):
                sim.shear(0.1, **values)


def test_refused_simulations(rest: ld.State) -> None:
    flow = {"rate": 1e-3, "drag": 1.0}
    with (
        ld.Simulation(rest.packing, ld.SoftContact()) as disks,
        pytest.raises(ld.ParameterError, match=r"SoftContact.* is sheared without a rate only"),
    ):
        disks.shear(0.1, **flow)
    with (
        ld.Simulation(rest.packing, ld.Sector()) as sim,
        pytest.raises(ld.ParameterError, match="energy of Sector jumps"),
    ):
        sim.shear(0.1, **flow)
    walls = ld.BoxWall((10, 10)).parts
    inside = ld.bidisperse(4, seed=1).between(walls).push_off()
    with (
        ld.Simulation(inside, ld.Ring()) as sim,
        pytest.raises(ld.ParameterError, match="walls are not sheared"),
    ):
        sim.shear(0.1, **flow)


@pytest.mark.parametrize("dimension", [2, 3])
def test_free_particles_of_a_flow_with_inertia(dimension: int) -> None:
    """Those that do not touch keep their velocities, but for the boundaries that they cross."""
    rng, rate, strain = np.random.default_rng(3), 0.05, 1.2
    packing = ld.crystal("hex" if dimension == 2 else "sc", 3).at(0.05 / dimension)
    law = ld.Ring() if dimension == 2 else ld.Droplet()
    still = np.zeros(packing.positions.shape)
    still[:, 1] = 0.8 * packing.radii.min() * rate * rng.normal(size=len(packing))
    state = ld.Simulation(packing, law).state()
    with ld.Simulation(ld.State(**{**vars(state), "velocities": still}), law) as sim:
        states = sim.shear(strain, steps=3, rate=rate, inertia=True, timestep=0.01)
    y = packing.positions[:, 1] - packing.positions[:, 1].mean()
    height = packing.box[1, 1]
    for found in states[1:]:
        assert not found.n_contacts.any()
        time = found.shear_strain / rate
        assert found.time == pytest.approx(time)
        there = packing.positions[:, 1] + still[:, 1] * time
        crossed = np.round((found.packing.positions[:, 1] - there) / height)
        np.testing.assert_allclose(
            found.velocities[:, 0], rate * (y + crossed * height), rtol=0, atol=1e-9
        )
        np.testing.assert_array_equal(found.velocities[:, 1], still[:, 1])
    assert crossed.any()


def test_a_flow_with_inertia_balances() -> None:
    """Its work is stored, moves particles beside the mean flow, or is lost by friction."""
    rough = ld.Friction(0.4, kt=1.0, gt=0.2, damping=0.3, film=0.1, power=0.5)
    for dimension, law in ((2, ld.Ring(kA=np.inf, kP=0.0, tension=1.0)), (3, ld.Droplet())):
        packing = ld.bidisperse(24, phi=0.84 - 0.19 * (dimension - 2), seed=1, dimension=dimension)
        rate, volume = 0.02, packing.volume
        with ld.Simulation(packing.push_off(), law, friction=rough) as sim:
            states = sim.shear(0.4, steps=80, rate=rate, inertia=True)[1:]
        energy, power = [], []
        for state in states:
            y = state.packing.positions[:, 1] - packing.positions[:, 1].mean()
            beside = state.velocities.copy()
            beside[:, 0] -= rate * y
            beside -= beside.mean(axis=0)
            moving = 0.5 * np.sum(beside**2 - state.velocities**2) + state.kinetic_energy
            energy.append(state.energy + moving + state.spring_energy + state.lost_energy)
            stress = state.shear_stress - np.sum(beside[:, 0] * beside[:, 1]) / volume
            power.append(rate * volume * stress)
        work = np.trapezoid(power, [state.time for state in states])
        assert states[-1].lost_energy - states[0].lost_energy > 0.3 * work
        assert energy[-1] - energy[0] == pytest.approx(work, rel=0.02)

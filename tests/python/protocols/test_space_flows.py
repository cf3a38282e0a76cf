"""Flows of droplets in three dimensions, also in boxes that lean along all axes."""

import math

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import Droplet, Packing, State
from lammps_deformable.protocols.shearing import sheared
from protocol_helpers import dynamic_modulus

FRICTION = 1.5


@pytest.fixture(scope="module")
def rest() -> State:
    """An fcc crystal far above its onset, of droplets that differ, so that strains are not affine.

    It is stable, whatever the droplets.
    """
    fcc = ld.crystal("fcc", 2, phi=0.8)
    own = fcc.radii * np.random.default_rng(1).uniform(0.9, 1.1, len(fcc))
    packing = Packing(fcc.positions, own, fcc.box, species=np.arange(32) % 2)
    with ld.Simulation(packing, Droplet([1.0, 1.6])) as sim:
        return sim.relax(1e-8)


@pytest.fixture(scope="module")
def leaning(rest: State) -> State:
    """In a box with three tilts, none of which an equivalent box lacks."""
    box = rest.packing.box @ np.array([[1.0, 0.0, 0.0], [0.05, 1.0, 0.0], [-0.03, 0.06, 1.0]])
    with ld.Simulation(rest, rest.law) as sim:
        sim.deform(box)
        return sim.relax(1e-8)


def forces_on(state: State) -> np.ndarray:
    forces = np.zeros((len(state.packing), 3))
    np.add.at(forces, state.contacts["i"], state.contacts["force_vector"])
    return forces


def parts(points: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Of the sides of a box, to the nearest image."""
    inside = points @ np.linalg.inv(box)
    return inside - np.round(inside)


def test_work_of_the_flow_is_stored_or_lost_to_friction(rest: State) -> None:
    """dE/dt = V sigma rate - sum F^2/friction, by the trapezium rule between states."""
    rate = 0.02
    with ld.Simulation(rest, rest.law) as sim:
        states = sim.shear(0.03, steps=60, rate=rate, drag=FRICTION)
    times = np.array([state.time for state in states])
    assert np.diff(times) == pytest.approx(0.03 / 60 / rate)
    work = np.array([state.shear_stress for state in states]) * rest.packing.volume * rate
    lost = np.array([np.sum(forces_on(state) ** 2) / FRICTION for state in states])
    gain = np.trapezoid(work - lost, times)
    # forces follow the box with a delay of one step of 5e-4 of strain at most
    allowed = 5e-4 / 0.03 * np.trapezoid(work, times) + 0.01 * np.trapezoid(lost, times)
    assert states[-1].energy - states[0].energy == pytest.approx(gain, abs=allowed)
    assert np.trapezoid(lost, times) > 2.0 * allowed
    assert not states[-1].velocities.any()


def test_slow_flow_is_quasistatic(leaning: State) -> None:
    """The stress is behind in proportion to the rate: two rates give that of the rate 0."""
    rest, stress = leaning, []
    for rate in (0.0, 1e-5, 2e-5):
        given = {"rate": rate, "drag": FRICTION} if rate else {"tolerance": 1e-7}
        with ld.Simulation(rest, rest.law) as sim:
            state = sim.shear(1e-3, **given)[-1]
        assert state.shear_strain == pytest.approx(1e-3)
        stress.append(state.shear_stress - rest.shear_stress)
    still, slow, fast = stress
    assert still == pytest.approx(1e-3 * rest.moduli().shear_modulus, rel=0.02)
    assert 2.0 * slow - fast == pytest.approx(still, rel=0.01)


def gas(side: int) -> Packing:
    """Droplets that never touch, in a box that leans."""
    lattice = ld.crystal("sc", side, radius=1.0).at(0.01)
    box = lattice.box @ np.array([[1.0, 0.0, 0.0], [0.4, 1.0, 0.0], [0.3, 1.4, 1.0]])
    return Packing(lattice.positions @ np.linalg.inv(lattice.box) @ box, lattice.radii, box)


@pytest.mark.parametrize("strain", [0.5, -2.3])
def test_free_droplets_follow_the_flow(strain: float) -> None:
    """In all boxes, through flips, at a rate, quasistatically and in a part of a cycle."""
    packing = gas(3)
    mean = sheared(packing.positions, strain)
    box = sheared(packing.box, strain)
    ends = {}
    with ld.Simulation(packing, Droplet()) as sim:
        (ends["rate"],) = sim.shear(
            strain, rate=1.0, drag=1.0, timestep=0.01 if abs(strain) < 1 else None
        )[1:]
    with ld.Simulation(packing, Droplet()) as sim:
        ends["still"] = sim.shear(strain, steps=3)[-1]
        # the tilts before the last step were half of the sides at most
        tilts = np.abs(sim.box[[1, 2, 2], [0, 0, 1]]) / sim.box[0, 0]
        assert (tilts <= 0.501 + np.abs(strain) / 3 * np.array([1.0, 0.5, 0.0])).all()
    if strain > 0:
        with ld.Simulation(packing, Droplet()) as sim:
            cycle = sim.oscillate(strain, period=100.0, drag=1.0, steps=8)[1:]
            _, ends["quarter"], *_, back = cycle
        assert parts(back.packing.positions - packing.positions, packing.box) == pytest.approx(
            np.zeros_like(mean), abs=1e-9
        )
    for state in ends.values():
        assert state.shear_strain == pytest.approx(strain)
        moved = parts(state.packing.positions - mean, state.packing.box)
        # the places of a step are those of the box before it
        assert moved == pytest.approx(np.zeros_like(moved), abs=1e-9)
        # the box is another one of the same lattice
        turns = state.packing.box @ np.linalg.inv(box)
        assert turns == pytest.approx(np.round(turns), abs=1e-9)


def test_free_droplets_diffuse_in_the_flow() -> None:
    """<y^2> = <z^2> = 2 D t, <x^2> = 2 D t (1 + gamma^2/3), <x y> = D gamma t."""
    packing, temperature, strain = gas(6), 1e-4, 1.0
    with ld.Simulation(packing, Droplet()) as sim:
        (state,) = sim.shear(
            strain, rate=1e-2, drag=2.0, temperature=temperature, timestep=0.1, seed=1
        )[1:]
    assert not state.n_contacts.any()
    moved = state.packing.positions - sheared(packing.positions, strain)
    dx, dy, dz = (parts(moved, state.packing.box) @ state.packing.box).T
    number, spread = len(packing), temperature / 2.0 * state.time  # D t
    along = spread * (1.0 + strain**2 / 3.0)
    error = 5.0 * np.sqrt(2.0 / number)  # five standard errors of a mean square
    for square, expected in ((dx, along), (dy, spread), (dz, spread)):
        assert np.mean(square**2) == pytest.approx(2.0 * expected, rel=error)
    covariance = 5.0 * np.sqrt((4.0 * along * spread + (spread * strain) ** 2) / number)
    assert np.mean(dx * dy) == pytest.approx(spread * strain, abs=covariance)


def linear_modulus(state: State, omega: float) -> complex:
    """G' + i G'' of centers against a drag: friction du/dt = -(H u + B gamma)."""
    hessian = state.hessian()
    n, m = hessian.size, hessian.matrix.toarray()
    coupled = hessian.by_strain[:, 1]
    followed = np.linalg.solve(m[n:, n:], np.column_stack([m[n:, :n], coupled[n:]]))
    stiffness = m[:n, :n] - m[:n, n:] @ followed[:, :-1]
    pull = coupled[:n] - m[:n, n:] @ followed[:, -1]
    affine = hessian.strain[1, 1] - coupled[n:] @ followed[:, -1]
    answer = np.linalg.solve(stiffness + 1j * omega * FRICTION * np.eye(n), pull)
    return complex(affine - pull @ answer) / state.packing.volume


def test_dynamic_modulus(leaning: State) -> None:
    """Against linear response with a drag, where both parts count."""
    rest, period = leaning, 20.0
    expected = linear_modulus(rest, 2.0 * math.pi / period)
    found = dynamic_modulus(rest, 1e-5, period, cycles=2, steps=8, drag=FRICTION)
    assert found.storage == pytest.approx(expected.real, rel=5e-3)
    assert found.loss == pytest.approx(expected.imag, abs=5e-3 * expected.real)
    static = linear_modulus(rest, 1e-9).real
    assert static == pytest.approx(rest.moduli().shear_modulus, rel=1e-6)
    assert found.loss > 0.015 * static


def test_creep_ends_where_shear_has_the_stress(rest: State) -> None:
    """And the box moves by the stress that contacts do not bear, by the trapezium rule."""
    modulus = rest.moduli().shear_modulus
    stress = rest.shear_stress + 1e-3 * modulus
    viscosity = FRICTION / (2.0 * rest.packing.radii.mean())  # by default
    time = 12.0 * viscosity / modulus  # a solid alone takes viscosity/modulus
    with ld.Simulation(rest, rest.law) as sim:
        states = sim.creep(stress, time=time, steps=120, drag=FRICTION)
    last = states[-1]
    assert last.time == pytest.approx(time)
    assert last.shear_stress == pytest.approx(stress, abs=1e-2 * 1e-3 * modulus)
    assert last.shear_strain == pytest.approx(1e-3, rel=0.02)
    rate = np.array([stress - state.shear_stress for state in states]) / viscosity
    strain = np.trapezoid(rate, [state.time for state in states])
    assert last.shear_strain == pytest.approx(strain, rel=1.5e-2)
    assert not last.velocities.any()


def test_refusals(rest: State, leaning: State) -> None:
    """In one line, with a way out."""
    with ld.Simulation(leaning, leaning.law) as sim:
        with pytest.raises(ld.ParameterError, match=r"leans along y.*shear it at a rate"):
            sim.creep(1e-3, time=1.0, drag=1.0, steps=10)
        with pytest.raises(ld.ParameterError, match=r"timestep = 50 .* take at most"):
            sim.shear(0.1, rate=1e-4, drag=1.0, timestep=50.0)
        with pytest.raises(ld.ParameterError, match=r"leans along y.*without yz, or relax"):
            sim.run(4_000_000, pressure=1e-3)[-1]
    with (
        ld.Simulation(rest.packing, ld.SoftContact()) as spheres,
        pytest.raises(ld.ParameterError, match=r"SoftContact.* is sheared without a rate only"),
    ):
        spheres.shear(0.1, rate=1.0, drag=1.0)
    walls = ld.BoxWall((8.0, 8.0, 8.0)).parts
    inside = ld.bidisperse(4, dimension=3, seed=1).between(walls).push_off()
    with (
        ld.Simulation(inside, Droplet()) as sim,
        pytest.raises(ld.ParameterError, match="walls are not sheared"),
    ):
        sim.shear(0.1, rate=1e-3, drag=1.0)

"""Oscillatory shear against linear response with a drag on the centers."""

import math
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from protocol_helpers import dynamic_modulus
from refusals import refused

STRAIN, FRICTION = 1e-5, 2.0

# Euler's steps change G'' by pi/4000, and strains of 1e-5 change contacts of indentations of 1e-2
# by 1e-3 of themselves.
ACCURACY = 2e-3


@pytest.fixture(scope="module")
def rest() -> ld.State:
    packing = ld.jam(ld.bidisperse(10, seed=2)).packing
    with ld.Simulation(packing.at(packing.phi + 0.06), ld.Ring()) as sim:
        return sim.relax(1e-10)


class Linear:
    """friction du/dt = -(M u + B gamma); the stress is (E'' gamma + B.u)/V."""

    def __init__(self, state: ld.State) -> None:
        hessian = state.hessian(rattlers=False)
        n, m = hessian.size, hessian.matrix.toarray()
        coupled = hessian.by_strain[:, 1]
        by_lines = np.linalg.solve(m[n:, n:], np.column_stack([m[n:, :n], coupled[n:]]))
        stiffness = m[:n, :n] - m[:n, n:] @ by_lines[:, :-1]
        self.rate, vectors = np.linalg.eigh(stiffness)
        self.rate /= FRICTION
        self.weight = vectors.T @ (coupled[:n] - m[:n, n:] @ by_lines[:, -1])
        self.area = state.packing.volume
        self.affine = (hessian.strain[1, 1] - coupled[n:] @ by_lines[:, -1]) / self.area

    def stress(self, omega: float, time: np.ndarray) -> np.ndarray:
        """Over the strain of sin(omega t), which begins at rest."""
        t, k = time[:, None], self.rate
        memory = k * np.sin(omega * t) + omega * (np.exp(-k * t) - np.cos(omega * t))
        centers = memory / (k**2 + omega**2) @ self.weight**2
        return self.affine * np.sin(omega * time) - centers / (FRICTION * self.area)

    def moduli(self, omega: float) -> complex:
        """G' + i G'' after a long time."""
        centers = np.sum(self.weight**2 / (self.rate + 1j * omega)) / (FRICTION * self.area)
        return complex(self.affine - centers)


def test_slow_flow_has_the_static_modulus(rest: ld.State) -> None:
    """The reference of the tests below knows the modulus of linear response and of strains."""
    linear = Linear(rest)
    assert linear.moduli(1e-9).real == pytest.approx(rest.moduli().shear_modulus, rel=1e-6)
    found = dynamic_modulus(rest, STRAIN, cycles=2, skip=0, steps=8, tolerance=1e-9)
    assert found.storage == pytest.approx(rest.moduli().shear_modulus, rel=ACCURACY)
    assert abs(found.loss) < ACCURACY * linear.affine
    assert found.storage_error < ACCURACY * linear.affine


@pytest.mark.parametrize("part", [0.03, 1.0])
def test_stress_under_an_oscillating_strain(rest: ld.State, part: float) -> None:
    """At frequencies of the slowest modes and of the mean one."""
    linear = Linear(rest)
    omega = part * linear.rate.mean()
    period = 2.0 * math.pi / omega
    with ld.Simulation(rest, rest.law) as sim:
        states = sim.oscillate(STRAIN, period=period, drag=FRICTION)[1:]
    assert [state.time for state in states] == pytest.approx(period * np.arange(1, 41) / 40)
    strain = np.array([state.shear_strain for state in states])
    assert strain == pytest.approx(STRAIN * np.sin(np.pi * np.arange(1, 41) / 20), abs=1e-20)
    tilt = np.array([state.packing.box[1, 0] for state in states]) / rest.packing.box[1, 1]
    assert tilt == pytest.approx(
        strain + rest.packing.box[1, 0] / rest.packing.box[1, 1], abs=1e-14
    )
    stress = (
        -np.array([state.pressure_tensor[0, 1] for state in states]) + rest.pressure_tensor[0, 1]
    )
    times = np.array([state.time for state in states])
    expected = STRAIN * linear.stress(omega, times)
    assert np.abs(stress - expected).max() < ACCURACY * STRAIN * linear.affine
    assert not states[-1].velocities.any()


def test_storage_and_loss_modulus(rest: ld.State) -> None:
    linear = Linear(rest)
    omega = 0.3 * linear.rate.mean()
    found = dynamic_modulus(
        rest, STRAIN, 2.0 * math.pi / omega, cycles=2, skip=2, steps=8, drag=FRICTION
    )
    expected = linear.moduli(omega)
    settled = np.exp(-linear.rate[2] * 4.0 * math.pi / omega)  # slowest mode, two cycles
    assert settled < 0.3
    allowed = ACCURACY * linear.affine + 3.0 * np.hypot(found.storage_error, found.loss_error)
    assert abs(found.storage + 1j * found.loss - expected) < allowed
    assert found.loss > 0.1 * linear.affine
    assert found.harmonics < 0.02


@pytest.mark.parametrize("strain", [1e-4, 1e-8])
def test_small_strains(strain: float) -> None:
    """Contacts follow any strain, so that G'' is right where it is a hundredth of G'."""
    jammed = ld.jam(ld.bidisperse(32, seed=1)).packing
    with ld.Simulation(jammed.at(0.88), ld.Ring()) as sim:
        state = sim.relax(1e-10)
    expected = complex(state.complex_modulus(2.0 * math.pi / 20.0, drag=1.0))
    assert 0.005 < expected.imag / expected.real < 0.02
    found = dynamic_modulus(state, strain, 20.0, steps=8, drag=1.0)
    assert found.storage_error < 1e-3 * expected.real
    assert found.loss_error < 1e-2 * expected.imag
    assert found.storage == pytest.approx(expected.real, abs=3.0 * found.storage_error)
    assert found.loss == pytest.approx(expected.imag, abs=3.0 * found.loss_error)


@pytest.mark.parametrize("steps", [8, 40])
def test_the_error_of_long_time_steps_is_known(rest: ld.State, steps: int) -> None:
    """And is pi dt/T of G'' at most: forces do not lag behind the box by a step."""
    period = 40.0
    expected = complex(rest.complex_modulus(2.0 * math.pi / period, FRICTION))
    how: dict[str, Any] = {"drag": FRICTION, "timestep": period / 400}
    found = dynamic_modulus(rest, 1e-6, period, cycles=2, skip=3, steps=steps, **how)
    assert found.storage == pytest.approx(expected.real, abs=found.storage_error)
    assert found.loss == pytest.approx(expected.imag, abs=found.loss_error)
    assert found.loss_error == pytest.approx(math.pi / 400 * expected.imag, rel=0.2)


@pytest.mark.parametrize(
    ("strain", "tolerance"), [(1e-5, None), (1e-8, None), (1e-7, 1e-6), (1e-5, 1e-8)]
)
def test_errors_know_the_forces_that_are_left(
    rest: ld.State, strain: float, tolerance: float | None
) -> None:
    """Quasistatic moduli are right within their errors, and those are small by default."""
    exact = rest.moduli().shear_modulus
    found = dynamic_modulus(rest, strain, cycles=2, steps=8, tolerance=tolerance)
    assert found.storage == pytest.approx(exact, abs=3.0 * found.storage_error + 1e-5 * exact)
    assert found.loss == pytest.approx(0.0, abs=3.0 * found.loss_error + 1e-5 * exact)
    if tolerance is None:
        assert found.storage_error < 5e-3 * exact
    elif tolerance > strain:
        assert found.storage_error > 0.1 * exact


def test_refusals(rest: ld.State) -> None:
    with ld.Simulation(rest, rest.law) as sim:
        for values, message in (
            ({"amplitude": 0.0}, "amplitude must be a positive number, not 0"),
            ({"period": 0.0, "drag": 1.0}, "period must be a positive number, not 0"),
            ({"period": 10.0}, "a flow needs the drag of particles against it: give drag"),
            ({"drag": 1.0}, "drag has no meaning without a period"),
            ({"period": 10.0, "drag": 1.0, "tolerance": 1e-6}, "leave tolerance out"),
            ({"steps": 4}, "steps must be at least 8 in a cycle, not 4"),
        ):
            with refused(message):
                sim.oscillate(**{"amplitude": STRAIN, "period": math.inf} | values)


def test_refusals_of_moduli(rest: ld.State) -> None:
    with ld.Simulation(rest, rest.law) as sim:
        run = sim.oscillate(STRAIN, period=math.inf, cycles=2, steps=8, tolerance=1e-2)
        with pytest.raises(
            ld.ParameterError, match=r"at least 2 cycles must be left.*, not 1 of 2"
        ):
            run.complex_modulus(skip=1)
        with pytest.raises(ld.ParameterError, match="skip must not be negative, not -1"):
            run.complex_modulus(skip=-1)
        with pytest.raises(ld.ParameterError, match="this run is another one"):
            sim.shear(1e-3).complex_modulus()
    with ld.Simulation(rest.packing, ld.SoftContact()) as disks:
        with pytest.raises(ld.ParameterError, match=r"SoftContact.* is sheared without a rate"):
            disks.oscillate(STRAIN, period=10.0, drag=1.0)
        soft = disks.relax(1e-9)
    found = dynamic_modulus(soft, STRAIN, cycles=2, skip=0, steps=8, tolerance=1e-10)
    assert found.storage == pytest.approx(soft.moduli().shear_modulus, rel=1e-2)

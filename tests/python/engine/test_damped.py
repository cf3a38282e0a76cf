"""Damped motion to a minimum."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.engine.soft_disks import (
    Enthalpy,
    relax_at_pressure,
    settle,
    settle_at_pressure,
)


def test_critical_damping() -> None:
    """The softest mode falls as (1 + w t) exp(-w t), and stiffer ones no slower."""
    softest = 1e-4
    stiffness = np.array([softest, 0.1, 1.0, 6.0])
    mass, start, part = np.array([1.0, 2.0, 1.0, 1.0]), np.ones(4), 1e-6
    steps: list[int] = []

    def relaxed(gradient: np.ndarray) -> bool:
        return bool(np.abs(gradient).max() < part * softest)

    def harmonic(z: np.ndarray) -> tuple[float, np.ndarray]:
        return 0.5 * float(stiffness @ z**2), stiffness * z

    z, enough = settle(harmonic, start, mass, softest, relaxed, 1.0, 10**6, steps.append)
    assert enough
    assert np.abs(stiffness * z).max() < part * softest
    # (1 + w t) exp(-w t) = 1e-6 at w t = 16.7; the stiffest mode begins with 6/softest of its force
    most = 16.7 + np.log(6.0 / softest)
    assert 16.0 < 0.5 * np.sqrt(softest) * sum(steps) < most
    assert not settle(harmonic, start, mass, softest, relaxed, 1.0, 20, steps.append)[1]


def test_settled_disks() -> None:
    """The minimum is that of the minimizer, also with many small disks around a large one."""
    packing = ld.bidisperse(60, sizes=(0.5, 2.5), phi=0.95, seed=3).push_off()
    minimized = relax_at_pressure(packing, 0.02, 1e-9, 1000, lambda *values: None)
    pushed = minimized.packing.at(minimized.packing.phi * 1.001)
    found = settle_at_pressure(pushed, 0.02, 1e-6, 10_000, lambda *values: None)
    assert found.converged
    assert found.residual <= 1e-6
    assert found.pressure == pytest.approx(0.02, rel=1e-6)
    assert found.packing.phi == pytest.approx(minimized.packing.phi, rel=1e-6)


def test_mass_bounds_frequencies() -> None:
    """With it no mode is beyond the stability of the time step, w^2 < (2/0.5)^2, at any sizes."""
    packing = ld.polydisperse(60, np.geomspace(0.1, 2.0, 60), phi=1.0, seed=1)
    packing = relax_at_pressure(packing, 0.05, 1e-6, 2000, lambda *values: None).packing
    enthalpy = Enthalpy(packing, 0.05)
    z, small = enthalpy.start, 1e-6
    columns = [
        enthalpy(z + small * step)[1] - enthalpy(z - small * step)[1] for step in np.eye(len(z))
    ]
    per_root = 1.0 / np.sqrt(enthalpy.mass)
    hessian = per_root[:, None] * np.array(columns) / (2 * small) * per_root
    assert np.linalg.eigvalsh(0.5 * (hessian + hessian.T)).max() < 0.6 * 16.0

"""Slopes of outlines at their contacts, tilted lines of packings, and what curved lines save."""

import json
from pathlib import Path

import numpy as np
import pytest
from contacts import contacts
from deformable import core
from hypothesis import assume, given
from test_ring_forces import STIFFNESS, pressed

CASES = json.loads((Path(__file__).parents[1] / "data" / "tilt_cases.json").read_text())["cases"]
stiffnesses = pytest.mark.parametrize(("kA", "kP"), STIFFNESS)


@stiffnesses
@given(particle=contacts(size=(1, 9), gap=0.4))
def test_slope(particle, kA, kP):
    """dW/dtheta = p L t, by central differences of the step 1e-5: errors of 1e-10."""
    _, force, ring = pressed(particle, kA, kP)
    step, turning = 1e-5, np.zeros_like(force)
    for c in range(len(force)):
        turned = [
            core.forced_ring(particle.radius, particle.angle + change, force, kA, kP).conjugate
            for change in np.outer([step, -step], np.arange(len(force)) == c)
        ]
        turning[c] = (turned[0] - turned[1]) / (2 * step)
    moments = ring.pressure * ring.contact_length * ring.slope
    np.testing.assert_allclose(moments, turning, rtol=0, atol=1e-8 * ring.energy)
    np.testing.assert_allclose(ring.d_angle, -moments, rtol=0, atol=1e-13 * ring.energy)


@given(particle=contacts(size=(1, 9), gap=0.4))
def test_slope_rate(particle):
    """Against differences of sum L G' at contacts that turn, while all lengths stay."""
    _, force, ring = pressed(particle, 1.0, np.inf)
    assume(force.max() > 0)
    length, step = ring.contact_length, 1e-4
    for c in range(len(force)):
        others, slopes = np.delete(length, c), []
        for angle in particle.angle[c] + np.array([step, -step]):
            t = (angle - np.delete(particle.angle, c)) % (2 * np.pi)
            slopes.append(others @ (np.sin(t) / 4 - (np.pi - t) * np.cos(t) / 2) / np.pi)
        rate = (slopes[0] - slopes[1]) / (2 * step)
        assert rate == pytest.approx(ring.slope_rate[c], abs=1e-7 * length.sum())


@stiffnesses
@given(particle=contacts(size=(1, 9), gap=0.4))
def test_tension(particle, kA, kP):
    """Laplace's law: the tension is that of the perimeter where it changes, else p q."""
    _, _, ring = pressed(particle, kA, kP)
    q = particle.radius + ring.delta - ring.contact_length.sum() / (2 * np.pi)
    exact = ring.pressure * q
    if np.isfinite(kP):
        exact = 2 * np.pi * kP * ring.delta
    scale = ring.pressure * particle.radius
    assert ring.tension == pytest.approx(exact, abs=1e-8 * scale)


@pytest.mark.parametrize("case", CASES, ids=[case["case"] for case in CASES])
def test_packing(case):
    """Packings of an independent code: forces and torques balance on the lines it has found."""
    radius, kinds = np.array(case["radii"]), case["species"]
    centers, rows = np.array(case["centres"]), case["contacts"]
    seen = [[] for _ in centers]
    torques = []
    for contact in rows:
        i, j = contact["i"], contact["j"]
        apart = centers[j] + np.array(contact["image"]) * case["box"] - centers[i]
        normal = np.arctan2(apart[1], apart[0]) + contact["tilt"]
        a = contact["indentation_i"], contact["indentation_j"]
        distance = np.hypot(*apart)
        left = radius[kinds[i]] + radius[kinds[j]] - distance * np.cos(contact["tilt"]) - sum(a)
        assert abs(left) < 1e-14
        torques.append([distance * np.sin(contact["tilt"]), 0.0])
        for side, particle in enumerate((i, j)):
            seen[particle].append((len(torques) - 1, normal + np.pi * side, a[side]))
    energy, force = 0.0, np.array([contact["force"] for contact in rows])
    on_center = np.zeros_like(centers)
    for n, contacts_here in enumerate(seen):
        k, angle, a = (np.array(column) for column in zip(*contacts_here, strict=True))
        stiffness = (float(case[name][kinds[n]]) for name in ("kA", "kP", "skin"))
        ring = core.forced_ring(radius[kinds[n]], angle, force[k], *stiffness)
        energy += ring.energy
        np.testing.assert_allclose(ring.indentation, a, rtol=0, atol=1e-10)
        for pair, slope in zip(k, ring.slope, strict=True):
            torques[pair][1] += slope
        on_center[n] = -force[k] @ np.column_stack([np.cos(angle), np.sin(angle)])
    assert energy == pytest.approx(case["energy"], rel=1e-12)
    torques = np.array(torques) * force[:, None]
    np.testing.assert_allclose(torques[:, 0], torques[:, 1], rtol=0, atol=1e-10 * force.max())
    np.testing.assert_allclose(on_center, case["forces"], rtol=0, atol=1e-9 * force.max())


def test_curved_line():
    """A string under the load p_i - p_j, by its nodes: the work of the load is half lost to it."""
    force, pressures, tensions = 3e-4, (0.02, 0.014), (4e-3, 7e-3)
    length = force * np.mean(1 / np.array(pressures))
    n = 2000
    step, push, hold = length / n, pressures[0] - pressures[1], sum(tensions)
    stiffness = hold / step * (2 * np.eye(n - 1) - np.eye(n - 1, k=1) - np.eye(n - 1, k=-1))
    load = np.full(n - 1, push * step)
    saved = 0.5 * load @ np.linalg.solve(stiffness, load)
    assert core.curvature_energy(force, *pressures, *tensions) == pytest.approx(saved, rel=1e-6)
    assert core.curvature_energy(force, 0.02, 0.02, *tensions) == 0.0
    assert core.curvature_energy(0.0, 0.0, 0.0, *tensions) == 0.0
    assert core.curvature_energy(force, *pressures, -0.01, 0.005) == np.inf

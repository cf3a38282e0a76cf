"""Rings with a line tension: closed forms of droplets, limits, equilibrium between any contacts."""

from itertools import pairwise

import numpy as np
import pytest
from contacts import TENSE, contacts, regular_polygon, sized
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from lammps_deformable import core

INF = np.inf
tense = st.sampled_from([*TENSE.values()])

# n walls at the distance 1 - a: U, p, force of a wall, for R = tension = 1 and a conserved area
POLYGONS = [
    (3, 0.01, 8.15233701254e-4, 1.02615592159, 5.50596863759e-2),
    (4, 0.03, 1.53966476607e-2, 1.17475947318, 0.27903337796),
    (6, 0.001, 3.41114634654e-5, 1.01091176788, 1.14325238837e-2),
    (6, 0.03, 4.73755469022e-2, 1.65475649044, 0.698725225703),
]


def soft(particle, stiffness, skin=0.0):
    kA, kP, tension = stiffness
    args = particle.radius, particle.angle, particle.indentation, kA, kP, skin, tension
    return core.soft_ring(*args)


def forced(particle, force, stiffness, skin=0.0):
    kA, kP, tension = stiffness
    return core.forced_ring(particle.radius, particle.angle, force, kA, kP, skin, tension)


def test_droplets_in_polygons():
    for n, a, energy, pressure, force in POLYGONS:
        polygon = regular_polygon(n, a)
        droplet = soft(polygon, (INF, 0.0, 1.0))
        assert droplet.energy == pytest.approx(energy, rel=1e-9), (n, a)
        assert droplet.pressure == pytest.approx(pressure, rel=1e-9)
        np.testing.assert_allclose(droplet.d_indentation, force, rtol=1e-9)
        assert droplet.area == pytest.approx(np.pi, rel=1e-14)
        loaded = forced(polygon, np.full(n, force), (INF, 0.0, 1.0))
        assert loaded.energy == pytest.approx(energy, rel=1e-9), (n, a)
        assert loaded.pressure == pytest.approx(pressure, rel=1e-9)
        np.testing.assert_allclose(loaded.indentation, a, rtol=1e-9)


@pytest.mark.parametrize(("n", "expected"), [(2, 3.1416), (3, 5.2969), (6, 11.2481)])
def test_stiffness_of_a_droplet(n, expected):
    """F/(gamma a/R) at a = 0: 2 K/n with K = pi A/(A - pi), A = n tan(pi/n), pi for n = 2.

    The force is analytic in a: Richardson's extrapolation from a = 1e-4 leaves terms of a^4.
    """
    area = n * np.tan(np.pi / n) if n > 2 else np.inf
    exact = 2 / n * (np.pi if n == 2 else np.pi * area / (area - np.pi))
    assert exact == pytest.approx(expected, abs=5e-5)
    table = [
        soft(regular_polygon(n, a), (INF, 0.0, 1.0)).d_indentation[0] / a
        for a in 1e-4 / 2.0 ** np.arange(4)
    ]
    for order in range(1, 4):
        table = [(2**order * b - a) / (2**order - 1) for a, b in pairwise(table)]
    assert table[0] == pytest.approx(exact, rel=1e-9)


def test_droplet_between_two_plates():
    """F = 2 pi gamma [(R/2h)^2 - 1/4] at the distance 2h of the plates."""
    for a in (1e-8, 1e-3, 0.1, 0.4):
        droplet = soft(regular_polygon(2, a, radius=1.5), (INF, 0.0, 0.7))
        h = 1.5 - a
        force = 0.5 * np.pi * 0.7 * a * (1.5 + h) / h**2
        np.testing.assert_allclose(droplet.d_indentation, force, rtol=1e-9)


def test_small_forces_are_those_of_morse_and_witten():
    """The outline of a droplet under one small force; deviations are of its second order."""
    radius, tension, force = 1.3, 0.4, 1e-6
    ring = core.forced_ring(radius, [0.0], [force], INF, 0.0, 0.0, tension)
    support = radius + ring.delta
    points = core.outline("ring", support, [0.0], ring.indentation + ring.delta, 400)
    theta = np.arctan2(points[:, 1], points[:, 0]) % (2 * np.pi)
    far = np.abs(np.hypot(*points.T) - radius) < 0.2  # all of them
    t = theta[far]
    shift = (np.pi - t) * np.sin(t) - 0.5 * np.cos(t) - 1
    expected = force * radius / tension * shift / (2 * np.pi)
    found = np.hypot(*points[far].T) - radius
    np.testing.assert_allclose(found, expected, rtol=0, atol=10 * (force / tension) ** 2)


@given(
    stiffness=tense,
    particle=contacts(size=(0, 9), gap=0.3, indentation=(-5e-3, 0.02)),
    skin=st.floats(0, 0.3),
)
@settings(max_examples=200)
def test_equilibrium(stiffness, particle, skin):
    """Laplace's law with the lengths of a ring of this size, and the smallest energy."""
    skin *= particle.radius
    r = particle.radius - skin
    kA, kP, tension = sized(stiffness, r)
    ring = soft(particle, (kA, kP, tension), skin)

    def shape_at(delta):
        return core.ring(particle.radius + delta, particle.angle, particle.indentation + delta)

    def energy_at(delta):
        change = np.pi * delta * (2 * r + delta) - shape_at(delta).area_deficit
        area = 0.5 * kA * change**2 if np.isfinite(kA) else 0.0
        free = tension * 2 * np.pi * delta - tension / r * change
        return area + free + 0.5 * kP * (2 * np.pi * delta) ** 2

    lengths = shape_at(ring.delta).contact_length
    scale = max(lengths.max(initial=0), 1e-300)
    np.testing.assert_allclose(ring.contact_length, lengths, rtol=0, atol=1e-8 * scale)
    q = r + ring.delta - ring.contact_length.sum() / (2 * np.pi)
    pull = tension + kP * 2 * np.pi * ring.delta
    assert ring.pressure * q == pytest.approx(pull, rel=1e-11)
    if np.isfinite(kA):
        assert ring.pressure == pytest.approx(tension / r + kA * ring.area_deficit, rel=1e-10)
    largest = tension * r * max(np.abs(particle.indentation).max(initial=0) / r, 1e-3)
    assert ring.energy == pytest.approx(energy_at(ring.delta), rel=1e-9, abs=1e-12 * largest)
    if np.isfinite(kA) and ring.energy > 0:
        for step in (-1e-3, 1e-3):
            assert energy_at(ring.delta + step * r) > ring.energy


@given(stiffness=tense, particle=contacts(size=(1, 7), gap=0.4))
@settings(max_examples=150)
def test_derivatives(stiffness, particle):
    """Central differences of the relative step 1e-4: errors of 1e-8 and of rounding."""
    stiffness = sized(stiffness, particle.radius)
    ring = soft(particle, stiffness)
    active = ring.contact_length > 1e-3 * ring.contact_length.max(initial=0)
    assume(active.all())
    step = 1e-4 * particle.indentation.min()
    scale = ring.d_indentation.max()
    for c in range(len(active)):
        for name, of in (("indentation", "d_indentation"), ("angle", "d_angle")):
            above, below = (soft(particle.moved(name, c, s), stiffness) for s in (step, -step))
            slope = (above.energy - below.energy) / (2 * step)
            size = scale if name == "indentation" else scale * particle.indentation.max()
            noise = 1e-14 * ring.energy / step
            assert slope == pytest.approx(getattr(ring, of)[c], abs=2e-6 * size + noise)


def test_at_rest():
    """Without forces the pressure is tension/R, and the compliance is finite."""
    for kA, kP, tension in TENSE.values():
        ring = core.soft_ring(1.0, [0.0, 2.0], [-0.1, -0.2], kA, kP, 0.0, tension)
        loaded = core.forced_ring(1.0, [0.0, 2.0], [0.0, 0.0], kA, kP, 0.0, tension)
        for at in (ring, loaded):
            assert (at.energy, at.delta) == (0.0, 0.0), (kA, kP, tension)
        assert loaded.pressure == pytest.approx(tension, rel=1e-15)
        assert np.linalg.eigvalsh(loaded.compliance).min() > 0
        assert loaded.indentation == pytest.approx([0, 0])


def test_no_tension_is_the_limit():
    polygon = regular_polygon(4, 0.02)
    ring, limit = soft(polygon, (1.0, 0.3, 1e-11)), soft(polygon, (1.0, 0.3, 0.0))
    assert ring.energy == pytest.approx(limit.energy, rel=1e-6)
    np.testing.assert_allclose(ring.d_indentation, limit.d_indentation, rtol=1e-6)


def test_bubbles_collapse_at_the_bound():
    """2 pi R (kP + kA R^2) bounds the tension; just below, a ring at rest yields without bound."""
    assert core.unstable_radius(2.0, 0.25, 0.5, 2 * np.pi * 2.0 * 1.5 * 0.999) is None
    assert "collapse" in core.unstable_radius(2.0, 0.25, 0.5, 2 * np.pi * 2.0 * 1.5 * 1.001)
    force = [1e-9]
    soft_, softer = (
        core.forced_ring(1.0, [0.0], force, 1.0, 0.0, 0.0, 2 * np.pi * (1 - margin))
        for margin in (0.01, 0.001)
    )
    assert softer.delta / soft_.delta == pytest.approx(10, rel=0.02)
    with pytest.raises(ValueError, match="collapse"):
        core.soft_ring(1.0, [0.0], [0.01], 1.0, 0.0, 0.0, 6.3)
    for angle in ([0.0], [0.0, 1.5]):
        for squeezed in (0.02, 0.4):
            with pytest.raises(ValueError, match="no room"):
                core.soft_ring(1.0, angle, [squeezed] * len(angle), 1.0, 0.0, 0.0, 6.27)
    with pytest.raises(ValueError, match="no ring"):
        core.forced_ring(1.0, [0.0], [1.0], 1.0, 0.0, 0.0, 6.2)


def test_refusals():
    for stiffness, message in (
        ((INF, 0.0, -1.0), "tension.*not -1.*floppy"),
        ((INF, 0.0, np.nan), "tension.*not nan"),
        ((INF, 0.0, 0.0), "kP.*tension.*not 0"),
        ((INF, -1.0, 1.0), "kP.*not -1"),
        ((1.0, INF, 1.0), "kP must be finite.*not inf"),
    ):
        with pytest.raises(ValueError, match=message):
            core.soft_ring(1.0, [0.0], [0.01], *stiffness[:2], 0.0, stiffness[2])
        problem = core.invalid_stiffness(*stiffness)
        with pytest.raises(ValueError, match=message):
            raise ValueError(problem)

"""Derivatives of contact forces with respect to indentations."""

import numpy as np
import pytest
from contacts import contacts, regular_polygon
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from lammps_deformable import core

INF = float("inf")
STIFFNESS = [(1.0, INF), (2.0, 0.3), (1.0, 1e-6), (1e-3, 1e3), (INF, 1.0)]
stiffnesses = st.sampled_from(STIFFNESS)


def forces(particle, indentation, *stiffness):
    shape = core.soft_ring(particle.radius, particle.angle, indentation, *stiffness)
    return shape.d_indentation, shape.contact_length > 0


@given(
    particle=contacts(size=(1, 9), gap=0.5, indentation=(-5e-3, 0.02)),
    given=stiffnesses,
    skin=st.sampled_from([0.0, 0.1]),
)
@settings(max_examples=200)
def test_derivative_of_the_forces(particle, given, skin):
    """Central differences, while the same contacts are active.

    F ~ a^3: a step h leaves (h/a)^2, and rounding 1e-16 a/h: 1e-8 each where a = 0.01 and h = 1e-6.
    """
    stiffness = *given, skin * particle.radius
    step = 1e-6 * particle.radius
    exact = core.contact_stiffness(
        particle.radius, particle.angle, particle.indentation, *stiffness
    )
    _, active = forces(particle, particle.indentation, *stiffness)
    assume(particle.indentation.max() > 2e-3 * particle.radius)
    for c in range(len(particle.angle)):
        sides = [particle.moved("indentation", c, s).indentation for s in (-step, step)]
        (low, left), (high, right) = (forces(particle, a, *stiffness) for a in sides)
        assume((left == active).all() and (right == active).all())
        numerical = (high - low) / (2 * step)
        np.testing.assert_allclose(exact[c], numerical, rtol=0, atol=1e-5 * np.abs(exact).max())


@given(particle=contacts(size=(1, 9), gap=0.4), given=stiffnesses)
def test_convex(particle, given):
    """Symmetric, and no eigenvalue below zero except by rounding."""
    k = core.contact_stiffness(particle.radius, particle.angle, particle.indentation, *given)
    scale = np.abs(k).max()
    np.testing.assert_allclose(k, k.T, rtol=0, atol=1e-13 * scale)
    assert np.linalg.eigvalsh(k).min() >= -1e-12 * scale


def test_regular_polygons():
    """All contacts with the same force: F = kA K^2 a^3 2/n, so that the rows of K sum to 3 F/a."""
    for n in (2, 3, 6, 12):
        particle = regular_polygon(n, 0.001)
        given = 1.0, particle.angle, particle.indentation, 1.0, INF
        force = core.soft_ring(*given).d_indentation
        stiffness = core.contact_stiffness(*given)
        np.testing.assert_allclose(stiffness.sum(1), 3 * force / 0.001, rtol=1e-9)


def test_contacts_in_one_direction():
    """The deeper one is active; of two equal ones, either."""
    one = core.contact_stiffness(1.0, [0.3], [0.02], 1.0, 1.0)
    two = core.contact_stiffness(1.0, [0.3, 0.3], [0.01, 0.02], 1.0, 1.0)
    assert two[1, 1] == pytest.approx(one[0, 0], rel=1e-12)
    assert two[0, 0] == two[0, 1] == 0


def test_scales():
    particle = regular_polygon(5, 0.02)
    k = [
        core.contact_stiffness(1.0, particle.angle, particle.indentation, s, 0.3 * s) / s
        for s in (1.0, 1e-8, 1e8)
    ]
    np.testing.assert_allclose(k[1:], [k[0], k[0]], rtol=1e-13)

"""Rings with given forces: the same rings as with given indentations."""

import contextlib
from itertools import product

import numpy as np
import pytest
from contacts import TENSE, contacts, sized
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from lammps_deformable import core

INF = float("inf")
STIFFNESS = [(1.0, INF), (2.0, 0.3), (1.0, 1e-6), (1.0, 1e12), (1e-3, 1e3), (INF, 1.0)]
any_stiffness = st.sampled_from([*((kA, kP, 0.0) for kA, kP in STIFFNESS), *TENSE.values()])


def pressed(particle, *stiffness):
    """A ring with given indentations, and the same one with the forces that this needs."""
    shape = core.soft_ring(particle.radius, particle.angle, particle.indentation, *stiffness)
    force = shape.d_indentation
    return shape, force, core.forced_ring(particle.radius, particle.angle, force, *stiffness)


def pressed_in(particle, stiffness, skin=0.0):
    """The same with kA, kP and tension in units of its radius; these too."""
    kA, kP, tension = sized(stiffness, particle.radius - skin)
    return *pressed(particle, kA, kP, skin, tension), (kA, kP, skin, tension)


@given(
    particle=contacts(size=(1, 9), gap=0.4, indentation=(-5e-3, 0.02)),
    stiffness=any_stiffness,
    skin=st.sampled_from([0.0, 0.1]),
)
@settings(max_examples=500)
def test_inverse(particle, stiffness, skin):
    """Forces from indentations and back; lines that bear nothing are outside of the outline."""
    shape, force, ring, _ = pressed_in(particle, stiffness, skin * particle.radius)
    assume(force.max() > 0)
    # the energy under tension is what is left of one at rest
    size, rest = particle.indentation.max(), 10 if stiffness[2] else 1
    np.testing.assert_allclose(
        ring.indentation[force > 0],
        particle.indentation[force > 0],
        rtol=0,
        atol=rest * 1e-10 * size,
    )
    assert (ring.indentation >= particle.indentation - rest * 1e-10 * size).all()
    assert ring.pressure == pytest.approx(shape.pressure, rel=1e-9)
    assert ring.energy == pytest.approx(shape.energy, rel=rest * 1e-9)
    conjugate = force @ particle.indentation - shape.energy
    assert ring.conjugate == pytest.approx(conjugate, rel=rest * 1e-9)
    np.testing.assert_allclose(ring.contact_length, shape.contact_length, rtol=rest * 1e-9)
    largest = max(shape.energy, np.abs(shape.d_angle).max())
    np.testing.assert_allclose(ring.d_angle, shape.d_angle, rtol=0, atol=1e-9 * largest)


@given(particle=contacts(size=(1, 9), gap=0.4), stiffness=any_stiffness)
@settings(max_examples=300)
def test_derivatives(particle, stiffness):
    """dW/df = a, da/df = C by central differences of the relative step 1e-5: errors of 1e-10."""
    _, force, ring, (kA, kP, skin, tension) = pressed_in(particle, stiffness)
    given = particle.radius, particle.angle
    of = lambda f: core.forced_ring(*given, f, kA, kP, skin, tension)  # noqa: E731
    step = 1e-5 * force.max()
    scale = np.abs(ring.compliance).max()
    for c in np.flatnonzero(force > 3 * step):
        change = step * (np.arange(len(force)) == c)
        above, below = of(force + change), of(force - change)
        slope = (above.conjugate - below.conjugate) / (2 * step)
        assert slope == pytest.approx(ring.indentation[c], abs=1e-8 * particle.indentation.max())
        numerical = (above.indentation - below.indentation) / (2 * step)
        np.testing.assert_allclose(ring.compliance[c], numerical, rtol=0, atol=1e-6 * scale)


@given(particle=contacts(size=(1, 6), gap=0.6), stiffness=any_stiffness)
@settings(max_examples=300)
def test_compliance_is_the_inverse_of_the_stiffness(particle, stiffness):
    _, force, ring, given = pressed_in(particle, stiffness)
    assume((force > 1e-3 * force.max()).all())
    k = core.contact_stiffness(particle.radius, particle.angle, particle.indentation, *given)
    unit = ring.compliance @ k
    np.testing.assert_allclose(unit, np.eye(len(force)), rtol=0, atol=1e-12 * np.linalg.cond(k))


@given(particle=contacts(size=(1, 9), gap=0.02), stiffness=any_stiffness)
@settings(max_examples=300)
def test_compliance_is_positive(particle, stiffness):
    try:
        C = pressed_in(particle, stiffness)[2].compliance
    except ValueError:  # a bubble that collapses between so many
        assume(False)
    np.testing.assert_allclose(C, C.T, rtol=0, atol=1e-13 * np.abs(C).max())
    assert np.linalg.eigvalsh(C).min() >= -1e-12 * np.abs(C).max()


@given(
    particle=contacts(size=(1, 7)),
    ratio=st.integers(-6, 12),
    unit=st.integers(-8, 8),
    small=st.integers(-12, 0),
)
def test_extremes(particle, ratio, unit, small):
    """Stiffnesses over decades and tiny indentations: forces and indentations belong together."""
    kA = 10.0**unit
    squeezed = type(particle)(particle.radius, particle.angle, particle.indentation * 10.0**small)
    _, force, ring = pressed(squeezed, kA, kA * 10.0**ratio)
    active = force > 0
    np.testing.assert_allclose(
        ring.indentation[active],
        squeezed.indentation[active],
        rtol=0,
        atol=1e-9 * squeezed.indentation.max(),
    )


def test_tiny_forces():
    """A single force f: a = G(0) f/p, p^3 = k G(0) f^2/2 where the ring hardly expands."""
    for (kA, kP), force in product(STIFFNESS, (0.0, 1e-60, 1e-30)):
        ring = core.forced_ring(1.0, [0.3], [force], kA, kP)
        assert np.isfinite(ring.indentation).all()
        assert (ring.pressure > 0) == (force > 0)
        assert ring.energy >= 0
        if force and np.isinf(kP):
            assert ring.pressure == pytest.approx((kA * 0.375 / np.pi * force**2) ** (1 / 3))


def test_contacts_in_one_direction():
    """Their forces add up: no matrix is inverted."""
    one = core.forced_ring(1.0, [0.3, 2.0], [3e-4, 1e-4], 1.0, 1.0)
    two = core.forced_ring(1.0, [0.3, 2.0, 0.3], [1e-4, 1e-4, 2e-4], 1.0, 1.0)
    assert two.pressure == pytest.approx(one.pressure, rel=1e-14)
    assert two.indentation[0] == two.indentation[2] == pytest.approx(one.indentation[0], rel=1e-13)


def test_no_ring_is_endless():
    """A bubble that cannot bear its forces is refused: it has no expansion of rounding errors."""
    rng, tension = np.random.default_rng(1), 0.3
    found = []
    for _ in range(1000):
        z = rng.integers(1, 7)
        angle, force = rng.uniform(0, 2 * np.pi, z), 10 ** rng.uniform(-2, 3) * rng.uniform(size=z)
        with contextlib.suppress(ValueError):
            found.append(core.forced_ring(0.7, angle, force, 1.0, 0.0, 0.0, tension).delta)
    assert len(found) > 300
    assert max(found) < 1e6 * 0.7


def test_refusals():
    with pytest.raises(ValueError, match=r"force.*-1"):
        core.forced_ring(1.0, [0.0, 3.0], [1.0, -1.0], 1.0, INF)
    with pytest.raises(ValueError, match="kA"):
        core.forced_ring(1.0, [0.0], [1.0], -1.0, INF)

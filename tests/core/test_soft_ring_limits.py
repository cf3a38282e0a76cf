"""Soft rings: limits of the stiffnesses, scales, the skin and the outline."""

from dataclasses import replace

import numpy as np
import pytest
from contacts import IRREGULAR, contacts, soft_ring, stiffnesses
from hypothesis import assume, given
from hypothesis import strategies as st
from lammps_deformable import core


def test_limit_of_a_stiff_perimeter():
    """U = U_inf - (p q)^2/2 kP + ..."""
    stiff = soft_ring(IRREGULAR, 0.5, np.inf)
    assert stiff.energy == 0.5 * 0.5 * IRREGULAR.shape("ring").area_deficit ** 2
    q = IRREGULAR.radius - stiff.contact_length.sum() / (2 * np.pi)
    first = (stiff.pressure * q) ** 2 / 2
    rest = [
        abs((stiff.energy - soft_ring(IRREGULAR, 0.5, kP).energy) * kP / first - 1)
        for kP in (1e3, 1e4)
    ]
    assert rest[0] < 0.01
    assert rest[1] == pytest.approx(rest[0] / 10, rel=0.1)


def test_limit_of_a_stiff_area():
    """U = U_inf - p^2/2 kA + ..."""
    stiff = soft_ring(IRREGULAR, np.inf, 0.5)
    rest = [
        abs((stiff.energy - soft_ring(IRREGULAR, kA, 0.5).energy) * kA * 2 / stiff.pressure**2 - 1)
        for kA in (1e3, 1e4)
    ]
    assert rest[0] < 0.01
    assert rest[1] == pytest.approx(rest[0] / 10, rel=0.1)


def test_neither_limit_is_a_step():
    """From the largest finite ratio to an infinite one, and from the smallest to none."""
    for finite, infinite in (((1.0, 1e300), (1.0, np.inf)), ((1e300, 1.0), (np.inf, 1.0))):
        near, at = soft_ring(IRREGULAR, *finite), soft_ring(IRREGULAR, *infinite)
        assert near.energy == pytest.approx(at.energy, rel=1e-13)
        assert near.pressure == pytest.approx(at.pressure, rel=1e-13)
    # a ratio past the largest number
    assert soft_ring(IRREGULAR, 1e-200, 1e200).delta == 0


@given(stiffness=stiffnesses, contacts=contacts(size=(1, 10), gap=0.3))
def test_scaling(stiffness, contacts):
    """Powers of two scale without rounding: the answer must not change in a single bit."""
    kA, kP = stiffness
    try:
        one = soft_ring(contacts, kA, kP, 0.125)
    except ValueError:  # no shape of this area
        assume(False)
    stiff = soft_ring(contacts, 1024 * kA, 1024 * kP, 0.125)
    assert (stiff.energy, stiff.delta) == (1024 * one.energy, one.delta)
    np.testing.assert_array_equal(stiff.d_indentation, 1024 * one.d_indentation)

    large = replace(contacts, radius=4 * contacts.radius, indentation=4 * contacts.indentation)
    scaled = soft_ring(large, kA / 16, kP, 0.5)
    assert scaled.energy == 16 * one.energy
    np.testing.assert_array_equal(scaled.contact_length, 4 * one.contact_length)


@given(stiffness=stiffnesses, contacts=contacts(), skin=st.floats(0, 0.2))
def test_skin(stiffness, contacts, skin):
    """The same as a ring of the radius R - skin with the same indentations."""
    kA, kP = stiffness
    inner = contacts.radius - skin * contacts.radius
    with_skin = soft_ring(contacts, kA, kP, contacts.radius - inner)
    # R - (R - inner) may differ from inner by a rounding of R
    bare = soft_ring(replace(contacts, radius=inner), kA, kP)
    assert with_skin.energy == pytest.approx(bare.energy, rel=1e-13)
    assert with_skin.area == pytest.approx(bare.area, rel=1e-13)
    np.testing.assert_allclose(with_skin.d_indentation, bare.d_indentation, rtol=1e-12, atol=1e-300)


def test_outline():
    """The outline is a ring of the radius R + delta: its polygon has the area and the perimeter."""
    shape = soft_ring(IRREGULAR, 1.0, 0.05)
    xy = core.outline(
        "ring",
        IRREGULAR.radius + shape.delta,
        IRREGULAR.angle,
        IRREGULAR.indentation + shape.delta,
        20000,
    )
    step = np.roll(xy, -1, axis=0) - xy
    # a polygon of arcs of 2 pi/20000 lacks 1e-7/6 of the area and 1e-7/24 of the perimeter
    area = 0.5 * np.sum(xy[:, 0] * step[:, 1] - xy[:, 1] * step[:, 0])
    assert area == pytest.approx(shape.area, rel=2e-8)
    assert np.hypot(*step.T).sum() == pytest.approx(shape.perimeter, rel=1e-8)
    normal = np.array([np.cos(IRREGULAR.angle), np.sin(IRREGULAR.angle)])
    active = shape.contact_length > 0
    reached = (xy @ normal).max(0)[active]
    np.testing.assert_allclose(reached, (IRREGULAR.radius - IRREGULAR.indentation)[active])

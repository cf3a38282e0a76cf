"""Derivatives against finite differences, and the identities from the symmetry of each law."""

from dataclasses import replace

import numpy as np
import pytest
from contacts import LAWS, changing, contacts
from hypothesis import given, settings
from hypothesis import strategies as st

EPSILON = np.finfo(float).eps
laws = st.sampled_from([*LAWS])


@given(
    law=laws,
    variable=st.sampled_from(["indentation", "angle"]),
    contacts=contacts(),
    contact=st.integers(0, 5),
)
@settings(max_examples=300)
def test_derivative(law, variable, contacts, contact):
    """A central difference is the mean of the derivative over its window."""
    contact %= len(contacts.angle)
    step = 1e-4 * (contacts.radius if variable == "indentation" else 1)
    down, here, up = (contacts.moved(variable, contact, s).shape(law) for s in (-step, 0, step))
    difference = (changing(law, up) - changing(law, down)) / (2 * step)
    derivative = [getattr(shape, f"d_{variable}")[contact] for shape in (down, here, up)]

    # Simpson's rule for the mean misses step^4/180 of the fifth derivative, 1e-18 * 5!/0.8^5 at
    # gaps of 0.8: nothing. What counts is rounding: of angles up to 3 pi, 9e-16/1e-4 = 1e-11 of the
    # step, and of the function, EPSILON/1e-4 = 2e-12 of its size, both times a few operations.
    scale = max(abs(changing(law, here)), np.abs(getattr(here, f"d_{variable}")).max())
    tolerance = 1e-10 * scale
    if law == "ring" and ((up.contact_length > 0) != (down.contact_length > 0)).any():
        tolerance += 0.5 * abs(derivative[2] - derivative[0])  # kinked there, but monotone
    assert abs(difference - np.dot(derivative, [1, 4, 1]) / 6) <= tolerance


@given(law=laws, contacts=contacts())
def test_turning_the_particle_changes_nothing(law, contacts):
    shape = contacts.shape(law)
    # a sum of z differences of terms whose sizes are those of the derivatives or of S
    scale = max(np.abs(shape.d_angle).max(), changing(law, shape))
    assert abs(shape.d_angle.sum()) <= 8 * EPSILON * len(contacts.angle) * scale

    turned = replace(contacts, angle=contacts.angle + 1.234).shape(law)
    # Angles are rounded to EPSILON * |angle|, up to 2 pi + pi + 1.3, and openings are down to 0.8.
    tolerance = 11 / 0.8 * 4 * EPSILON
    assert changing(law, turned) == pytest.approx(changing(law, shape), rel=tolerance)
    np.testing.assert_allclose(
        turned.contact_length,
        shape.contact_length,
        atol=tolerance * np.abs(shape.contact_length).max(),
    )


@given(law=laws, contacts=contacts(), seed=st.integers(0, 1000))
def test_order_of_contacts_does_not_matter(law, contacts, seed):
    order = np.random.default_rng(seed).permutation(len(contacts.angle))
    permuted = replace(
        contacts, angle=contacts.angle[order], indentation=contacts.indentation[order]
    ).shape(law)
    shape = contacts.shape(law)
    assert changing(law, permuted) == pytest.approx(changing(law, shape), rel=1e-13)
    for name in ("d_indentation", "d_angle", "contact_length"):
        expected = getattr(shape, name)[order]
        scale = max(np.abs(expected).max(), changing(law, shape))
        np.testing.assert_allclose(getattr(permuted, name), expected, rtol=0, atol=1e-12 * scale)


@given(law=laws, contacts=contacts())
def test_scaling(law, contacts):
    """Powers of two scale without rounding: the answer must not change in a single bit."""
    scaled = replace(contacts, radius=4 * contacts.radius, indentation=4 * contacts.indentation)
    small, large = contacts.shape(law), scaled.shape(law)
    assert large.area_deficit == 16 * small.area_deficit
    assert large.perimeter_excess == 4 * small.perimeter_excess
    np.testing.assert_array_equal(large.contact_length, 4 * small.contact_length)


@given(law=st.sampled_from(["sector", "ring"]), contacts=contacts(indentation=(-0.01, 0.05)))
def test_deficit_is_half_of_indentation_times_length(law, contacts):
    shape = contacts.shape(law)
    np.testing.assert_array_equal(shape.d_indentation, shape.contact_length)
    terms = 0.5 * contacts.indentation * shape.contact_length
    # lengths of a sector are sums of rounded terms of either sign, each larger than what is left
    assert abs(shape.area_deficit - terms.sum()) <= 1e-13 * np.abs(terms).sum()

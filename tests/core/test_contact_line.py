"""The radical axis in exact rational arithmetic."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lammps_deformable import core

EPSILON = np.finfo(float).eps
radii = st.floats(0.1, 10)


def exact(distance, radius_i, radius_j):
    d, ri, rj = map(Fraction, (distance, radius_i, radius_j))
    return ri - (d**2 + ri**2 - rj**2) / (2 * d)


@given(radius_i=radii, radius_j=radii, overlap=st.floats(-0.5, 0.5))
def test_indentation(radius_i, radius_j, overlap):
    distance = (radius_i + radius_j) * (1 - 0.5 * overlap)
    expected = exact(distance, radius_i, radius_j)
    error = core.contact_line(distance, radius_i, radius_j) - expected
    # the sum of the radii is rounded to EPSILON/2, a factor 2 R_j/2d < 2 follows
    assert abs(error) <= 2 * EPSILON * (radius_i + radius_j)


def test_touching_particles_lose_no_digits():
    """Radii whose sum is exact: the smallest overlap keeps its relative accuracy."""
    for distance in 1.25 - 2.0 ** -np.arange(1, 53):
        expected = float(exact(distance, 0.5, 0.75))
        found = core.contact_line(distance, 0.5, 0.75)
        assert found == pytest.approx(expected, rel=4 * EPSILON), distance


@given(radius_i=radii, radius_j=radii, overlap=st.floats(0.0, 0.3))
def test_both_sides_share_the_overlap(radius_i, radius_j, overlap):
    distance = (radius_i + radius_j) * (1 - overlap)
    shared = core.contact_line(distance, radius_i, radius_j) + core.contact_line(
        distance, radius_j, radius_i
    )
    assert abs(shared - (radius_i + radius_j - distance)) <= 4 * EPSILON * (radius_i + radius_j)


def test_arrays():
    distance, radius = np.array([1.1, 1.15]), np.array([0.5, 0.7])
    one_by_one = [
        core.contact_line(*pair) for pair in zip(distance, radius, radius[::-1], strict=True)
    ]
    np.testing.assert_array_equal(core.contact_line(distance, radius, radius[::-1]), one_by_one)

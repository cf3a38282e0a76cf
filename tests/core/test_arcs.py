"""The arcs of the sector law: by the literal formulas, as the outline, and divided further."""

import numpy as np
import pytest
from contacts import Contacts, contacts, regular_polygon
from hypothesis import given
from hypothesis import strategies as st
from lammps_deformable import core

EPSILON = np.finfo(float).eps


def literal(radius, angle, indentation):
    """The arcs by the formulas of the theory page as they are written there."""
    order = np.argsort(angle)
    t, a = angle[order], indentation[order]
    u, b = np.append(t[1:], t[0] + 2 * np.pi), np.roll(a, -1)
    phi = u - t
    d = 2 - 2 * np.cos(phi) - phi * np.sin(phi)
    alpha, beta = (np.sin(phi) - phi * np.cos(phi)) / d, (phi - np.sin(phi)) / d
    length, q = alpha * a + beta * b, radius - (1 - np.cos(phi)) / d * (a + b)
    p = np.hypot(length, radius - a - q)
    theta = t + np.arctan2(length, radius - a - q)
    return np.column_stack([p * np.cos(theta), p * np.sin(theta), q, t, u])


def flats(arcs):
    """From the end of each arc to the next one's beginning: along its tangent, and across."""
    following = np.roll(arcs, -1, axis=0)
    theta = arcs[:, 4]
    n = np.column_stack([np.cos(theta), np.sin(theta)])
    step = following[:, :2] - arcs[:, :2] + (following[:, 2] - arcs[:, 2])[:, np.newaxis] * n
    return step[:, 1] * n[:, 0] - step[:, 0] * n[:, 1], np.sum(step * n, axis=1)


@given(contacts=contacts())
def test_literal_formulas(contacts):
    arcs = core.sector_arcs(contacts.radius, contacts.angle, contacts.indentation)
    expected = literal(contacts.radius, contacts.angle, contacts.indentation)
    # D = phi^4/12 = 0.03 at the smallest opening of 0.8 is what is left of terms of the size 1,
    # and coefficients up to 12 multiply indentations of 0.02
    np.testing.assert_allclose(arcs[:, :3], expected[:, :3], rtol=0, atol=1e-13 * contacts.radius)
    np.testing.assert_allclose(arcs[:, 3:], expected[:, 3:], rtol=0, atol=8 * EPSILON)


@given(contacts=contacts(), points=st.integers(8, 400))
def test_outline_of_the_arcs(contacts, points):
    arcs = core.sector_arcs(contacts.radius, contacts.angle, contacts.indentation)
    np.testing.assert_array_equal(
        core.arc_outline(arcs, points), contacts.outline("sector", points)
    )


@given(contacts=contacts())
def test_open_arcs_are_the_closed_ones_without_the_last(contacts):
    given = contacts.radius, contacts.angle, contacts.indentation
    if np.ptp(contacts.angle) < 2 * np.pi:
        np.testing.assert_array_equal(
            core.sector_arcs(*given, closed=False), core.sector_arcs(*given)[:-1]
        )


@st.composite
def arcs_with_contacts(draw):
    """An arc of a circle and the contacts that divide it, ends among them."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    openings = 10.0 ** rng.uniform(-5, 0, draw(st.integers(2, 5)))
    radius = rng.uniform(0.3, 3.0)
    # an arc of opening phi has room for q phi^2/6, shared by the contacts at both ends
    room = 0.4 * radius * np.minimum(openings[1:], openings[:-1]) ** 2 / 6
    return Contacts(
        radius,
        rng.uniform(-np.pi, np.pi) + np.append(0.0, np.cumsum(openings)),
        np.concatenate([[0.0], room * rng.random(len(room)), [0.0]]),
    )


@given(contacts=arcs_with_contacts())
def test_divided_arc(contacts):
    """Perimeter and tangents are those of the arc, and the lines of the contacts are reached."""
    radius, angle, indentation = contacts.radius, contacts.angle, contacts.indentation
    arcs = core.sector_arcs(radius, angle, indentation, closed=False)
    opening = np.ptp(angle)
    ends = [[0.0, 0.0, radius, theta, theta] for theta in (angle[-1], angle[0])]
    length, across = flats(np.vstack([arcs, ends]))
    length, across = np.delete(length, -2), np.delete(across, -2)  # not from end to end
    assert (arcs[:, 2] > 0).all()
    # centers have the size of the radius; angles of up to 4 + 5 are rounded to 1e-15
    rounding = 20 * EPSILON * radius
    np.testing.assert_allclose(across, 0.0, rtol=0, atol=rounding)
    assert (length > -rounding).all()
    perimeter = np.sum(arcs[:, 2] * (arcs[:, 4] - arcs[:, 3])) + length.sum()
    assert perimeter == pytest.approx(radius * opening, rel=0, abs=len(arcs) * rounding)
    normal = np.column_stack([np.cos(angle), np.sin(angle)])
    reach = np.sum(arcs[:, :2] * normal[:-1], axis=1) + arcs[:, 2]
    np.testing.assert_allclose(reach, radius - indentation[:-1], rtol=0, atol=rounding)


def test_a_corner_of_a_square():
    """A right angle: q' = q - a/(2 - pi/2), the flat of the end (pi/2 - 1) a/(2 - pi/2)."""
    (arc,) = core.sector_arcs(1.0, [0.0, np.pi / 2], [0.0, 0.1], closed=False)
    gamma = 1 / (2 - np.pi / 2)
    expected = [0.1 * gamma, 0.1 * (np.pi / 2 - 1) * gamma, 1 - 0.1 * gamma, 0.0, np.pi / 2]
    np.testing.assert_allclose(arc, expected, rtol=0, atol=4 * EPSILON)


def test_fewer_contacts_than_a_sector_needs():
    for z in (0, 1):
        given = 1.3, np.full(z, 0.4), np.full(z, 0.02)
        np.testing.assert_array_equal(core.sector_arcs(*given), [[0.0, 0.0, 1.3, 0.0, 2 * np.pi]])
        assert core.sector_arcs(*given, closed=False).shape == (0, 5)


def test_beyond_the_model_the_radius_is_negative():
    contacts = regular_polygon(6, 0.1)
    arcs = core.sector_arcs(1.0, contacts.angle, contacts.indentation)
    np.testing.assert_allclose(arcs[:, 2], contacts.shape("sector").arc_radius, rtol=1e-15)
    assert (arcs[:, 2] < 0).all()


def test_bad_contacts():
    for angle, indentation, closed, message in (
        ([0.0, 0.0, 2.0], [0.0, 0.01, 0.0], False, "same direction"),
        ([0.0, 3.0, 7.0], [0.0, 0.01, 0.0], False, r"angle spans 7\.0.*in a turn"),
        ([0.0, 1.0, 2.0], [0.0, 1.5, 0.0], False, r"indentation\[1\] is 1\.5"),
    ):
        with pytest.raises(ValueError, match=message):
            core.sector_arcs(1.0, angle, indentation, closed)


def test_bad_arcs():
    for arcs, points, message in (
        ([0, 0, 1, 0, 1], 180, r"arcs must have the shape \(m, 5\)"),
        ([[0, 0, 1, 0, 1], [0, 0, np.nan, 0, 1]], 180, r"arcs\[1\] must be five finite numbers"),
        ([[0, 0, 1, 0, 1e9]], 180, r"arcs\[0\] must be .* at most one turn"),
        ([[0, 0, 1, 0, 1]], 3, "points is 3"),
    ):
        with pytest.raises(ValueError, match=message):
            core.arc_outline(arcs, points)

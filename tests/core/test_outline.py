"""Outlines have the area and the perimeter of the law, and the lines bound them."""

from itertools import pairwise

import numpy as np
import pytest
from contacts import LAWS, Contacts
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from lammps_deformable import core

laws = st.sampled_from([*LAWS])


@st.composite
def contacts_on_a_grid(draw):
    """Directions at multiples of 2 pi/64, so that refining an outline halves its every step."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    z = draw(st.integers(3, 6))
    # no sector beyond half a turn: its contacts would end before they begin
    openings = 8 + rng.multinomial(64 - 8 * z, np.full(z, 1 / z))
    assume(openings.max() < 30)
    angle = 0.2 + 2 * np.pi / 64 * np.cumsum(openings)
    radius = rng.uniform(0.5, 2.0)
    return Contacts(radius, angle, radius * rng.uniform(0.005, 0.012, z))


def area_and_perimeter(outline):
    following = np.roll(outline, -1, axis=0)
    area = 0.5 * (outline[:, 0] * following[:, 1] - outline[:, 1] * following[:, 0]).sum()
    return np.array([area, np.hypot(*(following - outline).T).sum()])


def extrapolated(outline_of):
    """Area and perimeter of the curve itself, by Romberg's rule: polygons err in even powers."""
    # one point more than a multiple of 64 keeps the division of each arc off the rounding
    table = [area_and_perimeter(outline_of(64 * m + 1)) for m in (4, 8, 16, 32)]
    for order in (4, 16, 64):
        table = [(order * b - a) / (order - 1) for a, b in pairwise(table)]
    return table[0]


@given(law=laws, contacts=contacts_on_a_grid())
@settings(max_examples=100)
def test_area_and_perimeter(law, contacts):
    shape = contacts.shape(law)
    expected = (
        np.pi * contacts.radius**2 - shape.area_deficit,
        2 * np.pi * contacts.radius + shape.perimeter_excess,
    )
    # steps of 2 pi/256 leave (2 pi/256)^8/9! = 4e-19 after three extrapolations; the rest is
    # the rounding of sums of up to 2000 terms
    np.testing.assert_allclose(
        extrapolated(lambda points: contacts.outline(law, points)), expected, rtol=2e-13
    )


@given(law=laws, contacts=contacts_on_a_grid())
def test_lines_bound_the_outline(law, contacts):
    shape, outline = contacts.shape(law), contacts.outline(law)
    normal = np.column_stack([np.cos(contacts.angle), np.sin(contacts.angle)])
    beyond = (outline @ normal.T - (contacts.radius - contacts.indentation)) / contacts.radius
    pressed = shape.contact_length > 0
    if law != "ring" and (~pressed).any():  # a sector's line that the outline bulges over
        return
    # positions are rounded to a few 1e-16 of the radius
    assert beyond.max() < 1e-14
    # both ends of every contact are points of the outline, as far apart as the contact is long
    tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
    for c in np.flatnonzero(pressed):
        along = (outline @ tangent[c])[np.abs(beyond[:, c]) < 1e-14]
        assert np.ptp(along) == pytest.approx(shape.contact_length[c], abs=1e-14 * contacts.radius)


def test_unpressed_outline_is_the_circle():
    for law in LAWS:
        outline = Contacts(0.7, np.array([]), np.array([])).outline(law, 8)
        np.testing.assert_allclose(np.hypot(*outline.T), 0.7, rtol=1e-15)
        assert len(outline) == 8


@laws
@pytest.mark.parametrize("pressed", [0.0, 0.01])
def test_a_drawn_polygon_has_the_area_of_the_shape(law, pressed):
    """Pictures and measured areas agree, of particles without contacts too."""
    angle = np.array([0.3, 2.0, 4.1]) if pressed else np.array([])
    contacts = Contacts(0.7, angle, np.full(len(angle), pressed))
    outline = core.outline(law, 0.7, angle, contacts.indentation, 90, same_area=True)
    deficit = contacts.shape(law).area_deficit if pressed else 0.0
    area = area_and_perimeter(outline)[0]
    assert area == pytest.approx(np.pi * 0.7**2 - deficit, rel=1e-6 if pressed else 1e-14)

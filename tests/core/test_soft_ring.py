"""Soft rings between any contacts: equilibrium, derivatives, limits, scales."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from contacts import (
    IRREGULAR,
    STIFFNESSES,
    Contacts,
    contacts,
    regular_polygon,
    soft_ring,
    stiffnesses,
)
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from lammps_deformable import core


def ring_at(contacts, delta):
    return core.ring(contacts.radius + delta, contacts.angle, contacts.indentation + delta)


def change_of_area(contacts, skin, delta):
    radius = contacts.radius - skin
    return np.pi * delta * (2 * radius + delta) - ring_at(contacts, delta).area_deficit


def energy_at(contacts, kA, kP, skin, delta):
    change = change_of_area(contacts, skin, delta)
    return 0.5 * kA * change**2 + 0.5 * kP * (2 * np.pi * delta) ** 2


def assert_equilibrium(contacts, kA, kP, skin):
    """Laplace's law, with lengths that are those of a ring of this size."""
    shape, radius = soft_ring(contacts, kA, kP, skin), contacts.radius - skin
    ring = ring_at(contacts, shape.delta)
    # the lengths share the condition of G, 1/gap; the expansion is rounded to 1e-13 of itself
    scale = max(ring.contact_length.max(initial=0), 1e-300)
    np.testing.assert_allclose(shape.contact_length, ring.contact_length, atol=1e-9 * scale, rtol=0)
    size = radius + shape.delta
    deficit = -change_of_area(contacts, skin, shape.delta)
    # a difference from S, so to the rounding of S
    assert shape.area_deficit == pytest.approx(deficit, rel=1e-10, abs=1e-12 * ring.area_deficit)
    q = size - shape.contact_length.sum() / (2 * np.pi)
    tension = kP * 2 * np.pi * shape.delta
    error = abs(shape.pressure * q - tension)
    assert error <= 1e-11 * (abs(shape.pressure) * size + abs(tension))
    if np.isfinite(kA):
        assert shape.pressure == pytest.approx(kA * shape.area_deficit, rel=1e-14)
    direction = np.array([np.cos(contacts.angle), np.sin(contacts.angle)])
    push = np.hypot(*(direction @ shape.contact_length)) / np.pi
    assert shape.arc_radius == pytest.approx(q - push, abs=1e-13 * radius)
    assert shape.perimeter == pytest.approx(2 * np.pi * size, rel=1e-15)
    assert shape.area == pytest.approx(np.pi * radius**2 - shape.area_deficit, rel=1e-15)
    np.testing.assert_allclose(shape.d_indentation, shape.pressure * shape.contact_length)
    return shape


powers = st.floats(-3, 3).map(lambda power: 10.0**power)


@given(
    contacts=contacts(size=(0, 12), gap=0.02, indentation=(-0.01, 0.03)),
    kA=powers,
    kP=powers,
    skin=st.floats(0, 0.3),
)
@settings(max_examples=300)
def test_equilibrium(contacts, kA, kP, skin):
    kP, skin = kP * contacts.radius**2, skin * contacts.radius
    shape = assert_equilibrium(contacts, kA, kP, skin)
    # no other expansion costs less
    if shape.arc_radius > 0:
        for part in (0.0, 0.5, 0.9, 0.99, 1.01, 1.1, 1.5):
            other = energy_at(contacts, kA, kP, skin, part * shape.delta)
            assert shape.energy <= other * (1 + 1e-12)
        here = energy_at(contacts, kA, kP, skin, shape.delta)
        assert shape.energy == pytest.approx(here, rel=1e-9)


@given(contacts=contacts(size=(1, 12), gap=0.02, indentation=(-0.01, 0.01)), skin=st.floats(0, 0.3))
@settings(max_examples=200)
def test_area_conserved(contacts, skin):
    skin *= contacts.radius
    try:
        shape = assert_equilibrium(contacts, np.inf, 1.0, skin)
    except ValueError:  # no shape at any expansion
        for delta in np.linspace(0, 0.3, 301) * contacts.radius:
            assert change_of_area(contacts, skin, delta) < 0
        return
    assert shape.area_deficit == 0


@given(contacts=contacts(size=(30, 30), gap=0.05, indentation=(-0.001, 0.001)), kP=powers)
@settings(max_examples=50)
def test_many_small_neighbors(contacts, kP):
    assert_equilibrium(contacts, 1.0, kP * contacts.radius**2, 0.0)


def test_no_contact():
    without = [], [0.3, 2.0]  # none, or lines outside of the circle
    for stiffness, angle in product(STIFFNESSES.values(), without):
        shape = core.soft_ring(1.5, angle, [-0.01] * len(angle), *stiffness, 0.5)
        assert shape.energy == shape.pressure == shape.delta == shape.area_deficit == 0
        assert (shape.area, shape.perimeter, shape.arc_radius) == (np.pi, 2 * np.pi, 1.0)
        assert shape.contact_length.tolist() == [0] * len(angle)


def test_expansion_activates_contacts():
    """A line between the outlines of the expanded ring and of the inextensible one."""
    six = regular_polygon(6, 0.03)
    between = six.angle[0] + np.pi / 6
    expansion = soft_ring(six, 1.0, 0.1).delta
    top = (six.outline("ring", 20000) @ [np.cos(between), np.sin(between)]).max()
    stretched = replace(six, indentation=six.indentation + expansion, radius=six.radius + expansion)
    higher = (stretched.outline("ring", 20000) @ [np.cos(between), np.sin(between)]).max()
    assert higher > top + 1e-3
    seven = replace(
        six,
        angle=np.append(six.angle, between),
        indentation=np.append(six.indentation, six.radius - 0.5 * (top + higher)),
    )
    assert soft_ring(seven, 1.0, np.inf).contact_length[6] == 0
    assert soft_ring(seven, 1.0, 0.1).contact_length[6] > 0


# ---- derivatives ----


@given(
    variable=st.sampled_from(["indentation", "angle"]),
    stiffness=stiffnesses,
    contacts=contacts(),
    contact=st.integers(0, 5),
)
@settings(max_examples=300)
def test_derivative(variable, stiffness, contacts, contact):
    """A central difference is the mean over its window, as in test_derivatives."""
    kA, kP = stiffness
    contact %= len(contacts.angle)
    step = 3e-5 * (contacts.radius if variable == "indentation" else 1)
    moved = [contacts.moved(variable, contact, s) for s in (-step, 0, step)]
    down, here, up = (soft_ring(c, kA, kP * contacts.radius**2, 0.1) for c in moved)
    difference = (up.energy - down.energy) / (2 * step)
    derivative = [getattr(shape, f"d_{variable}")[contact] for shape in (down, here, up)]
    # U is S^2 and p S: twice the rounding there, and the same window
    scale = max(here.energy, np.abs(getattr(here, f"d_{variable}")).max())
    tolerance = 2e-10 * scale
    if ((up.contact_length > 0) != (down.contact_length > 0)).any():
        tolerance += 0.5 * abs(derivative[2] - derivative[0])  # kinked there, but monotone
    assert abs(difference - np.dot(derivative, [1, 4, 1]) / 6) <= tolerance


@pytest.mark.parametrize(("a", "kP"), [(0.06, 0.1), (0.1, 1e-3), (0.2, 10.0), (0.5, 0.1)])
def test_beyond_the_model(a, kP):
    """With negative arc radii all is finite, and forces are still derivatives."""
    polygon, step = regular_polygon(6, a), 1e-5
    shape = soft_ring(polygon, 1.0, kP)
    assert a < 0.1 or shape.arc_radius < 0
    difference = [
        soft_ring(replace(polygon, indentation=polygon.indentation + s), 1.0, kP).energy
        for s in (-step, step)
    ]
    slope = (difference[1] - difference[0]) / (2 * step)
    # the third derivative leaves step^2/6 of what varies over (A - pi)/A = 0.09: 1e-8
    assert shape.d_indentation.sum() == pytest.approx(slope, rel=1e-7)


def test_newton_without_bounds_finds_another_root():
    """One contact behind the center of a ring in a thick skin: one of several is right."""
    for a in (0.70, 0.72, 0.74):
        one = Contacts(1.0, np.array([0.3]), np.array([a]))
        for kP in (1e-2, 3e-2):
            assert assert_equilibrium(one, 1.0, kP, 0.5).delta > 0, (a, kP)


def test_no_room_for_the_area():
    """A hexagon of inradius h has the area 2 sqrt(3) h^2 and no more."""
    h = np.sqrt(np.pi / (2 * np.sqrt(3)))
    fits = soft_ring(regular_polygon(6, 1 - h - 1e-6), np.inf, 1.0)
    assert 0 < fits.arc_radius < 0.01
    with pytest.raises(ValueError, match=r"indentation: .*area"):
        soft_ring(regular_polygon(6, 1 - h + 1e-6), np.inf, 1.0)


# ---- limits of the stiffnesses, scales, the skin and the outline ----


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

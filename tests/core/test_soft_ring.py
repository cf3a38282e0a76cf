"""Soft rings between any contacts: equilibrium and derivatives."""

from dataclasses import replace

import numpy as np
import pytest
from contacts import STIFFNESSES, Contacts, contacts, regular_polygon, soft_ring, stiffnesses
from hypothesis import given, settings
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


@pytest.mark.parametrize(("kA", "kP"), STIFFNESSES.values(), ids=STIFFNESSES)
def test_no_contact(kA, kP):
    for angle in ([], [0.3, 2.0]):  # none, or lines outside of the circle
        shape = core.soft_ring(1.5, angle, [-0.01] * len(angle), kA, kP, 0.5)
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


@pytest.mark.parametrize("variable", ["indentation", "angle"])
@given(stiffness=stiffnesses, contacts=contacts(), contact=st.integers(0, 5))
@settings(max_examples=200)
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

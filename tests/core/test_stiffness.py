"""Rings that breathe: closed forms in 60 digits, the conditions of rest, derivatives and limits."""

from dataclasses import replace
from decimal import Decimal, getcontext

import numpy as np
import pytest
from contacts import Contacts, contacts, regular_polygon
from deformable import core
from hypothesis import given, settings
from hypothesis import strategies as st

getcontext().prec = 60
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")
STIFFNESSES = {
    "soft perimeter": (1.0, 0.01),
    "equal": (1.0, 1.0),
    "stiff perimeter": (0.5, 1e3),
    "area conserved": (np.inf, 0.7),
    "perimeter conserved": (2.0, np.inf),
}
stiffnesses = pytest.mark.parametrize(("kA", "kP"), STIFFNESSES.values(), ids=STIFFNESSES)


def soft_ring(contacts, kA, kP, skin=0.0):
    return core.soft_ring(contacts.radius, contacts.angle, contacts.indentation, kA, kP, skin)


# ---- regular polygons: S = K (a + delta)^2 ----


def tangent(x):
    """tan x by the series of sine and cosine."""
    sine, cosine, term, n = Decimal(0), Decimal(0), Decimal(1), 0
    while abs(term) > Decimal("1e-70"):
        even, odd = term, term * x / (n + 1)
        sign = -1 if n % 4 else 1
        cosine += sign * even
        sine += sign * odd
        term, n = odd * x / (n + 2), n + 2
    return sine / cosine


def polygon_constant(n):
    """K in 60 digits; n = 1: one contact, n = 2: two parallel walls."""
    if n < 3:
        return {1: 2 * PI / 3, 2: PI}[n]
    area = n * tangent(PI / n)
    return PI * area / (area - PI)


class Polygon:
    """The ring in a regular polygon in 60 digits, by brute force: every float below is exact."""

    def __init__(self, n, a, kA, kP, radius=1.0):
        self.constant, self.a, self.radius = polygon_constant(n), Decimal(a), Decimal(radius)
        self.kA, self.kP = (None if np.isinf(k) else Decimal(k) for k in (kA, kP))
        self.delta = self.largest_without_deficit() if self.kA is None else self.softest()
        pull = self.kP * 2 * PI * self.delta
        mean = self.radius + self.delta - self.length() / (2 * PI)
        self.pressure = pull / mean if self.kA is None else self.kA * self.deficit(self.delta)
        self.force = self.pressure * self.length() / n

    def deficit(self, delta):
        return self.constant * (self.a + delta) ** 2 - PI * delta * (2 * self.radius + delta)

    def length(self):
        return 2 * self.constant * (self.a + self.delta)

    def energy(self, delta=None):
        delta = self.delta if delta is None else delta
        stretch = self.kP * (2 * PI * delta) ** 2 / 2
        return stretch if self.kA is None else stretch + self.kA * self.deficit(delta) ** 2 / 2

    def softest(self):
        """Smallest energy by thirds: it has one minimum where q > 0, and delta > 0 there."""
        low, high = Decimal(0), self.a
        while high - low > Decimal("1e-28") * high:
            third = (high - low) / 3
            if self.energy(low + third) < self.energy(high - third):
                high -= third
            else:
                low += third
        return low

    def largest_without_deficit(self):
        low, high = Decimal(0), self.a
        while high - low > Decimal("1e-40") * high:
            middle = (low + high) / 2
            low, high = (middle, high) if self.deficit(middle) > 0 else (low, middle)
        return low


@pytest.mark.parametrize(
    ("n", "kP", "energy", "force"),
    [
        (6, np.inf, "4.6116e-04", "1.0248e-02"),
        (6, 1.0, "3.1918e-04", "7.6520e-03"),
        (6, 0.1, "8.8575e-05", "2.4476e-03"),
        (4, np.inf, "8.6794e-05", "2.8931e-03"),
        (4, 1.0, "4.9976e-05", "1.7250e-03"),
        (4, 0.1, "1.0417e-05", "3.7368e-04"),
    ],
)
def test_documented_values(n, kP, energy, force):
    """Those of docs/theory.md."""
    shape = soft_ring(regular_polygon(n, 0.03), 1.0, kP)
    assert f"{shape.energy:.4e}" == energy
    assert {f"{f:.4e}" for f in shape.d_indentation} == {force}


def assert_polygon(n, a, kA, kP, tolerance):
    shape, exact = soft_ring(regular_polygon(n, a), kA, kP), Polygon(n, a, kA, kP)
    assert shape.energy == pytest.approx(float(exact.energy()), rel=tolerance)
    assert shape.delta == pytest.approx(float(exact.delta), rel=tolerance)
    assert shape.pressure == pytest.approx(float(exact.pressure), rel=tolerance)
    assert shape.contact_length.sum() == pytest.approx(float(exact.length()), rel=tolerance)
    np.testing.assert_allclose(shape.d_indentation, float(exact.force), rtol=tolerance)


@pytest.mark.parametrize("n", [1, 2, 3, 4, 6, 7, 8, 30])
@pytest.mark.parametrize("a", [1e-8, 1e-3, 0.3])
@pytest.mark.parametrize("kP", [1e-6, 1e-3, 1.0, 1e3, 1e12, "area"])
def test_regular_polygon(n, a, kP):
    """Indentations in parts of the one, (A_n - pi)/A_n = pi/K, that leaves no area to spare.

    kP in parts of kA. Rounding is that of G and of its inverse: 1e-16 times K for S, less for
    what is not a difference.
    """
    constant = float(polygon_constant(n))
    kA, kP = (np.inf, 1.0) if kP == "area" else (1.0, kP)
    assert_polygon(n, min(a, 0.3) * np.pi / constant, kA, kP, 1e-14 * max(constant, 10))


@pytest.mark.parametrize("kA", [1e-8, 1.0, 1e8])
def test_scale_of_the_stiffness(kA):
    assert_polygon(5, 0.02, kA, 0.1 * kA, 1e-13)


# ---- any contacts: what holds at rest ----


def ring_at(contacts, delta):
    return core.ring(contacts.radius + delta, contacts.angle, contacts.indentation + delta)


def change_of_area(contacts, skin, delta):
    radius = contacts.radius - skin
    return np.pi * delta * (2 * radius + delta) - ring_at(contacts, delta).area_deficit


def energy_at(contacts, kA, kP, skin, delta):
    change = change_of_area(contacts, skin, delta)
    return 0.5 * kA * change**2 + 0.5 * kP * (2 * np.pi * delta) ** 2


def assert_at_rest(contacts, kA, kP, skin):
    """Laplace's law, with lengths that are those of a ring of this size."""
    shape, radius = soft_ring(contacts, kA, kP, skin), contacts.radius - skin
    ring = ring_at(contacts, shape.delta)
    # the lengths share the condition of G, 1/gap; a breath is rounded to 1e-13 of itself
    scale = max(ring.contact_length.max(initial=0), 1e-300)
    np.testing.assert_allclose(shape.contact_length, ring.contact_length, atol=1e-9 * scale, rtol=0)
    size = radius + shape.delta
    deficit = -change_of_area(contacts, skin, shape.delta)
    # what is left of S after the breath, so to the rounding of S
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
def test_at_rest(contacts, kA, kP, skin):
    kP, skin = kP * contacts.radius**2, skin * contacts.radius
    shape = assert_at_rest(contacts, kA, kP, skin)
    # no other size of the ring costs less
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
        shape = assert_at_rest(contacts, np.inf, 1.0, skin)
    except ValueError:  # no room: none, whatever the breath
        for delta in np.linspace(0, 0.3, 301) * contacts.radius:
            assert change_of_area(contacts, skin, delta) < 0
        return
    assert shape.area_deficit == 0


@given(contacts=contacts(size=(30, 30), gap=0.05, indentation=(-0.001, 0.001)), kP=powers)
@settings(max_examples=50)
def test_many_small_neighbours(contacts, kP):
    assert_at_rest(contacts, 1.0, kP * contacts.radius**2, 0.0)


@stiffnesses
def test_no_contact(kA, kP):
    for angle in ([], [0.3, 2.0]):  # none, or some that stay off
        shape = core.soft_ring(1.5, angle, [-0.01] * len(angle), kA, kP, 0.5)
        assert shape.energy == shape.pressure == shape.delta == shape.area_deficit == 0
        assert (shape.area, shape.perimeter, shape.arc_radius) == (np.pi, 2 * np.pi, 1.0)
        assert shape.contact_length.tolist() == [0] * len(angle)


def test_a_breath_takes_in_contacts():
    """A line between the outlines of the ring that breathes and of the one that does not."""
    six = regular_polygon(6, 0.03)
    between = six.angle[0] + np.pi / 6
    breath = soft_ring(six, 1.0, 0.1).delta
    top = (six.outline("ring", 20000) @ [np.cos(between), np.sin(between)]).max()
    stretched = replace(six, indentation=six.indentation + breath, radius=six.radius + breath)
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


@stiffnesses
@pytest.mark.parametrize("variable", ["indentation", "angle"])
@given(contacts=contacts(), contact=st.integers(0, 5))
@settings(max_examples=60)
def test_derivative(kA, kP, variable, contacts, contact):
    """A central difference is the mean over its window, as in test_derivatives."""
    contact %= len(contacts.angle)
    step = 1e-4 * (contacts.radius if variable == "indentation" else 1)
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


@pytest.mark.parametrize("kP", [1e-3, 0.1, 10.0])
@pytest.mark.parametrize("a", [0.06, 0.1, 0.2, 0.5])
def test_beyond_the_model(a, kP):
    """Past the end of the free arcs all is finite, and forces are still derivatives."""
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


@pytest.mark.parametrize("kP", [1e-2, 3e-2])
@pytest.mark.parametrize("a", [0.70, 0.72, 0.74])
def test_newton_alone_would_find_another_root(a, kP):
    """One contact behind the centre of a ring in a thick skin: one of several is right."""
    one = Contacts(1.0, np.array([0.3]), np.array([a]))
    assert assert_at_rest(one, 1.0, kP, 0.5).delta > 0


def test_no_room_for_the_area():
    """A hexagon of inradius h has the area 2 sqrt(3) h^2 and no more."""
    h = np.sqrt(np.pi / (2 * np.sqrt(3)))
    fits = soft_ring(regular_polygon(6, 1 - h - 1e-6), np.inf, 1.0)
    assert 0 < fits.arc_radius < 0.01
    with pytest.raises(ValueError, match="leave no room for a ring of this area"):
        soft_ring(regular_polygon(6, 1 - h + 1e-6), np.inf, 1.0)


# ---- limits and scales ----

irregular = Contacts(
    1.2, np.array([0.0, 1.3, 2.6, 4.0, 5.2]), np.array([0.02, 0.03, 0.01, 0.03, 0])
)


def test_limit_of_a_stiff_perimeter():
    """U = U_inf - (p q)^2/2 kP + ..."""
    stiff = soft_ring(irregular, 0.5, np.inf)
    assert stiff.energy == 0.5 * 0.5 * irregular.shape("ring").area_deficit ** 2
    q = irregular.radius - stiff.contact_length.sum() / (2 * np.pi)
    first = (stiff.pressure * q) ** 2 / 2
    rest = [
        abs((stiff.energy - soft_ring(irregular, 0.5, kP).energy) * kP / first - 1)
        for kP in (1e3, 1e4)
    ]
    assert rest[0] < 0.01
    assert rest[1] == pytest.approx(rest[0] / 10, rel=0.1)


def test_limit_of_a_stiff_area():
    """U = U_inf - p^2/2 kA + ..."""
    stiff = soft_ring(irregular, np.inf, 0.5)
    rest = [
        abs((stiff.energy - soft_ring(irregular, kA, 0.5).energy) * kA * 2 / stiff.pressure**2 - 1)
        for kA in (1e3, 1e4)
    ]
    assert rest[0] < 0.01
    assert rest[1] == pytest.approx(rest[0] / 10, rel=0.1)


def test_neither_limit_is_a_step():
    """From the largest finite ratio to an infinite one, and from the smallest to none."""
    for finite, infinite in (((1.0, 1e300), (1.0, np.inf)), ((1e300, 1.0), (np.inf, 1.0))):
        near, at = soft_ring(irregular, *finite), soft_ring(irregular, *infinite)
        assert near.energy == pytest.approx(at.energy, rel=1e-13)
        assert near.pressure == pytest.approx(at.pressure, rel=1e-13)
    # a ratio past the largest number
    assert soft_ring(irregular, 1e-200, 1e200).delta == 0


@stiffnesses
@given(contacts=contacts(size=(1, 10), gap=0.3))
@settings(max_examples=30)
def test_scaling(kA, kP, contacts):
    """Powers of two scale without rounding: the answer must not change in a single bit."""
    one = soft_ring(contacts, kA, kP, 0.125)
    stiff = soft_ring(contacts, 1024 * kA, 1024 * kP, 0.125)
    assert (stiff.energy, stiff.delta) == (1024 * one.energy, one.delta)
    np.testing.assert_array_equal(stiff.d_indentation, 1024 * one.d_indentation)

    large = replace(contacts, radius=4 * contacts.radius, indentation=4 * contacts.indentation)
    scaled = soft_ring(large, kA / 16, kP, 0.5)
    assert scaled.energy == 16 * one.energy
    np.testing.assert_array_equal(scaled.contact_length, 4 * one.contact_length)


@stiffnesses
@given(contacts=contacts(), skin=st.floats(0, 0.2))
@settings(max_examples=30)
def test_skin(kA, kP, contacts, skin):
    """The ring inside of the skin is the smaller one between the same indentations."""
    inner = contacts.radius - skin * contacts.radius
    with_skin = soft_ring(contacts, kA, kP, contacts.radius - inner)
    # R - (R - inner) may differ from inner by a rounding of R
    bare = soft_ring(replace(contacts, radius=inner), kA, kP)
    assert with_skin.energy == pytest.approx(bare.energy, rel=1e-13)
    assert with_skin.area == pytest.approx(bare.area, rel=1e-13)
    np.testing.assert_allclose(with_skin.d_indentation, bare.d_indentation, rtol=1e-12, atol=1e-300)


def test_outline():
    """The outline is a ring of the radius R + delta: its polygon has the area and the perimeter."""
    shape = soft_ring(irregular, 1.0, 0.05)
    xy = core.outline(
        "ring",
        irregular.radius + shape.delta,
        irregular.angle,
        irregular.indentation + shape.delta,
        20000,
    )
    step = np.roll(xy, -1, axis=0) - xy
    # a polygon of arcs of 2 pi/20000 lacks 1e-7/6 of the area and 1e-7/24 of the perimeter
    area = 0.5 * np.sum(xy[:, 0] * step[:, 1] - xy[:, 1] * step[:, 0])
    assert area == pytest.approx(shape.area, rel=2e-8)
    assert np.hypot(*step.T).sum() == pytest.approx(shape.perimeter, rel=1e-8)
    normal = np.array([np.cos(irregular.angle), np.sin(irregular.angle)])
    carries = shape.contact_length > 0
    reached = (xy @ normal).max(0)[carries]
    np.testing.assert_allclose(reached, (irregular.radius - irregular.indentation)[carries])


@pytest.mark.parametrize(
    ("kA", "kP", "skin", "message"),
    [
        (0.0, 1.0, 0.0, "kA is 0"),
        (-1.0, 1.0, 0.0, "kA is -1"),
        (np.nan, 1.0, 0.0, r"kA is .*nan"),
        (1.0, 0.0, 0.0, "kP is 0"),
        (1.0, -np.inf, 0.0, "kP is -inf"),
        (1.0, np.nan, 0.0, r"kP is .*nan"),
        (np.inf, np.inf, 0.0, "kA and kP are both inf"),
        (1.0, 1.0, -0.1, "skin is -0.1.*radius 1.2"),
        (1.0, 1.0, 1.2, "skin is 1.2.*radius 1.2"),
        (1.0, 1.0, np.nan, r"skin is .*nan"),
    ],
)
def test_bad_stiffness(kA, kP, skin, message):
    with pytest.raises(ValueError, match=message):
        soft_ring(irregular, kA, kP, skin)

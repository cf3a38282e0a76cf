"""Soft rings in regular polygons: closed forms in 60 digits."""

from decimal import Decimal, getcontext

import numpy as np
import pytest
from contacts import regular_polygon, soft_ring
from turns import in_turn

getcontext().prec = 60
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")


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


# n, kP, energy and force in docs/theory/closed_forms.md
DOCUMENTED = [
    (6, np.inf, "4.6116e-04", "1.0248e-02"),
    (6, 1.0, "3.1918e-04", "7.6520e-03"),
    (6, 0.1, "8.8575e-05", "2.4476e-03"),
    (4, np.inf, "8.6794e-05", "2.8931e-03"),
    (4, 1.0, "4.9976e-05", "1.7250e-03"),
    (4, 0.1, "1.0417e-05", "3.7368e-04"),
]


def test_documented_values():
    for n, kP, energy, force in DOCUMENTED:
        shape = soft_ring(regular_polygon(n, 0.03), 1.0, kP)
        found = f"{shape.energy:.4e}", {f"{f:.4e}" for f in shape.d_indentation}
        assert found == (energy, {force}), (n, kP)


def assert_polygon(n, a, kA, kP, tolerance):
    shape, exact = soft_ring(regular_polygon(n, a), kA, kP), Polygon(n, a, kA, kP)
    assert shape.energy == pytest.approx(float(exact.energy()), rel=tolerance)
    assert shape.delta == pytest.approx(float(exact.delta), rel=tolerance)
    assert shape.pressure == pytest.approx(float(exact.pressure), rel=tolerance)
    assert shape.contact_length.sum() == pytest.approx(float(exact.length()), rel=tolerance)
    np.testing.assert_allclose(shape.d_indentation, float(exact.force), rtol=tolerance)


STIFFNESS = [(1.0, kP) for kP in (1e-6, 1e-3, 1.0, 1e3, 1e12)] + [(np.inf, 1.0)]
# each stiffness with each indentation, and numbers of contacts in turn
PRESSED = [(*given, a) for given in STIFFNESS for a in (1e-8, 0.3)]
CASES = in_turn(PRESSED, [1, 2, 3, 4, 6, 7, 8, 30])


@pytest.mark.parametrize(("kA", "kP", "a", "n"), CASES)
def test_regular_polygon(n, a, kA, kP):
    """Indentations in parts of the one, (A_n - pi)/A_n = pi/K, that leaves no area to spare.

    Rounding is that of G and of its inverse: 1e-16 times K for S, less for what is not a
    difference.
    """
    constant = float(polygon_constant(n))
    assert_polygon(n, min(a, 0.3) * np.pi / constant, kA, kP, 1e-14 * max(constant, 10))


@pytest.mark.parametrize("kA", [1e-8, 1e8])
def test_scale_of_the_stiffness(kA):
    assert_polygon(5, 0.02, kA, 0.1 * kA, 1e-13)

"""Two droplets that hang together, beside the theory of small angles: docs/theory/droplets.md."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

PAGE = Path(__file__).parents[2] / "docs" / "theory" / "droplets.md"
ANGLES = (0.3, 0.5, 0.7)


def caps(angle):
    """Exact energy and indentation of each droplet: spherical caps that keep its volume."""
    c, s = np.cos(angle), np.sin(angle)
    radius = (4 / (2 + 3 * c - c**3)) ** (1 / 3)
    area = 2 * np.pi * radius**2 * (1 + c) + np.pi * (radius * s) ** 2 * c  # a film pulls by cos
    return area - 4 * np.pi, 1 - radius * c


def force(r, angle):
    return 2 * np.pi * (r * r - r * angle)


def indentation(r, angle):
    return r * r / 2 - force(r, angle) / (4 * np.pi) * (11 / 6 + 2 * np.log(r / 2))


def test_without_an_angle_it_is_morse_and_wittens():
    for f in (1e-3, 0.1):
        r = np.sqrt(f / (2 * np.pi))
        expected = f / (4 * np.pi) * (np.log(8 * np.pi / f) - 5 / 6)
        assert indentation(r, 0.0) == pytest.approx(expected, rel=1e-14)


def test_it_is_exact_for_small_angles():
    """Its energy is the integral of f da from a film without a size."""
    for angle in (1e-3, 1e-2):
        small = 1e-6 * angle

        def rate(r, angle=angle, small=small):
            change = indentation(r + small, angle) - indentation(r - small, angle)
            return force(r, angle) * change / (2 * small)

        energy, at_rest = quad(rate, 2 * small, angle)[0], indentation(angle, angle)
        assert energy == pytest.approx(-np.pi * angle**4 / 4, rel=1e-5)
        assert at_rest == pytest.approx(angle**2 / 2, rel=1e-12)
        exact = caps(angle)
        assert at_rest == pytest.approx(exact[1], rel=angle**2)
        if angle > 5e-3:  # rounding of the area
            assert energy == pytest.approx(exact[0], rel=1e-3)


def test_errors_of_the_page():
    text = " ".join(PAGE.read_text().split())
    off = [100 * np.array([np.pi * t**4 / 4, t**2 / 2]) / np.abs(caps(t)) - 100 for t in ANGLES]
    energies, places = np.round(off).astype(int).T
    told = re.search(r"off by (\d+), (\d+) and (\d+) % at θ = 0.3, 0.5 and 0.7 \((.*?) γ\)", text)
    assert told
    assert [int(number) for number in told.groups()[:3]] == energies.tolist()
    gained = [round(2 * (1 - np.cos(t)), 2) for t in ANGLES]
    assert told[4] == "w = " + ", ".join(map(str, gained))
    assert f"the indentation by {places[0]}, {places[1]} and {places[2]} %" in text

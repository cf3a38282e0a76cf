"""The contact laws against 60-digit arithmetic and closed forms."""

import json
from pathlib import Path

import numpy as np
import pytest
from closed_forms import polygon_stiffness
from contacts import LAWS, regular_polygon

CASES = json.loads((Path(__file__).parents[1] / "data" / "kernel_cases.json").read_text())["cases"]
TOLERANCE = {"sector": 1e-12, "ring": 1e-10}


@pytest.mark.parametrize("law", TOLERANCE)
def test_known_answers(law):
    cases = [case for case in CASES if law in case]  # some have no sector
    assert len(cases) > 30
    for case in cases:
        shape = LAWS[law](case["radius"], np.array(case["angle"]), np.array(case["indentation"]))
        for name, expected in case[law].items():
            scale = np.abs(expected).max()
            if name == "d_angle":
                # A difference of the terms of both sides of a contact, each at least of the size of
                # S: where symmetry makes them cancel, their rounding is all that is left.
                scale = max(scale, case[law]["area_deficit"])
            error = np.abs(getattr(shape, name) - expected).max()
            assert error <= TOLERANCE[law] * scale, (case["case"], len(case["angle"]), name)


@pytest.mark.parametrize("law", TOLERANCE)
def test_regular_polygons(law):
    a = 0.01
    for n in range(2, 13):
        shape, stiffness = regular_polygon(n, a).shape(law), polygon_stiffness(n)
        assert shape.area_deficit == pytest.approx(stiffness * a**2, rel=1e-12), n
        np.testing.assert_allclose(shape.contact_length, 2 * stiffness * a / n, rtol=1e-12)
    for n, vanishing in ((4, 0.2146), (6, 0.0931)):  # of free arcs
        last_digit = np.array([-5e-5, 5e-5])  # half of it
        radii = [
            np.min(regular_polygon(n, a).shape(law).arc_radius) for a in vanishing + last_digit
        ]
        assert radii[0] > 0 > radii[1], n


@pytest.mark.parametrize("law", LAWS)
def test_fewer_contacts_than_a_sector_needs(law):
    for z in (0, 1):
        shape = LAWS[law](1.3, np.full(z, 0.4), np.full(z, 0.02))
        if law == "ring" and z == 1:  # S = a^2/2G(0)
            assert shape.area_deficit == pytest.approx(0.02**2 * 2 * np.pi / 3, rel=1e-14)
        else:
            assert shape.area_deficit == shape.perimeter_excess == 0
        assert len(shape.d_indentation) == len(shape.d_angle) == len(shape.contact_length) == z


@pytest.mark.parametrize("apart", [1e-3, 1e-9])
def test_sector_of_nearly_a_turn(apart):
    """Contacts that nearly coincide: what a sector lacks to a turn, e, keeps its digits.

    S = (alpha(e) + alpha(2 pi - e)) a^2/2 with alpha of the theory page, 4/e - 2e/15 + ... at e.
    """
    a, phi, sine = 0.01, 2 * np.pi - apart, np.sin(apart)
    versines = 4 * np.sin(apart / 2) ** 2  # 2 - 2 cos e
    wide = -(sine + phi * np.cos(apart)) / (versines + phi * sine)
    narrow = 4 / apart - 2 * apart / 15
    shape = LAWS["sector"](1.0, np.array([0.0, apart]), np.array([a, 0.0]))
    assert shape.area_deficit == pytest.approx((wide + narrow) * a**2 / 2, rel=1e-12)

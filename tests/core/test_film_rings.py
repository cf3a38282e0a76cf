"""Rings whose outline meets films at an angle, and what may stick."""

import json
from pathlib import Path

import numpy as np
import pytest
from lammps_deformable import core
from test_curved import polygon

INF = np.inf
DATA = Path(__file__).parents[1] / "data" / "curved_cases.json"
STICKY = [case for case in json.loads(DATA.read_text()) if case["adhesion"]]


def meeting_angle(own, other, w):
    """Of an outline and its film, by Neumann's triangle."""
    film = own + other - w
    return np.arccos((film**2 + own**2 - other**2) / (2 * own * film))


@pytest.mark.parametrize("case", STICKY, ids=[case["name"] for case in STICKY])
def test_packing(case):
    """Pressures, tensions and the energy that an independent code has found."""
    x, box, w = np.array(case["x"]), np.array(case["box"]), case["adhesion"]
    tension, sides = case["line_tension"], [[] for _ in x]
    for row in case["contacts"]:
        i, j = row["i"], row["j"]
        apart = x[j] - x[i] - box * np.rint((x[j] - x[i]) / box)
        angle = np.arctan2(apart[1], apart[0]) + row["tilt"]
        for own, other, turn, sign in ((i, j, 0.0, 1.0), (j, i, np.pi, -1.0)):
            theta = meeting_angle(tension[own], tension[other], w)
            bend = sign * row["half_angle"]
            sides[own].append((angle + turn, row["force"], bend, theta, row["length"][0]))
    energy = 0.0
    for n, rows in enumerate(sides):
        angle, force, bend, theta, film = np.transpose(rows)
        material = (float(case[name][n]) for name in ("kA", "kP", "skin", "tension"))
        ring = core.forced_ring(
            case["radius"][n], angle, force, *material, half_angle=bend, contact_angle=theta
        )
        assert ring.pressure == pytest.approx(case["pressure"][n], rel=1e-9)
        assert ring.tension == pytest.approx(tension[n], rel=1e-9)
        q = ring.tension / ring.pressure
        chord = ring.contact_length + 2 * q * np.sin(theta + bend)
        np.testing.assert_allclose(chord * bend / np.sin(bend), film, rtol=1e-9)
        energy += ring.energy - 0.5 * w * film.sum()
    assert energy == pytest.approx(case["energy"], rel=1e-9)


@pytest.mark.parametrize(
    ("kA", "kP", "force"), [(INF, 0.0, -0.05), (INF, 0.7, 0.1), (2.0, 0.0, 0.0), (3.0, 0.4, -0.05)]
)
def test_area_and_perimeter_of_the_outline(kA, kP, force):
    """As test_curved.py has it for contacts without an angle; forces balance."""
    gamma, n = 1.0, 5
    angle, theta = np.arange(n) * 2 * np.pi / n, np.full(n, 0.35)
    bends = np.array([0.1, -0.05, 0.0, 0.02, -0.1])
    forces = np.full(n, force)
    ring = core.forced_ring(
        1.0, angle, forces, kA, kP, 0.0, gamma, half_angle=bends, contact_angle=theta
    )
    assert ring.tension == pytest.approx(gamma + kP * 2 * np.pi * ring.delta, rel=1e-12)
    shape = ring.support_radius, angle, ring.contact_length, bends
    fine = core.curved_outline(*shape, 20_000, contact_angle=theta)
    area, perimeter = polygon(fine)
    assert perimeter == pytest.approx(2 * np.pi * (1.0 + ring.delta), rel=2e-7)
    assert area == pytest.approx(np.pi - (ring.pressure - gamma) / kA, rel=2e-7)
    coarse = polygon(core.curved_outline(*shape, 180, True, theta))[0]
    assert coarse == pytest.approx(area, rel=1e-5)


def test_a_corner_has_the_angle():
    """Between the film and the free outline, on both sides of it."""
    theta = 0.5
    angle, force = np.array([0.0, 2.0, 4.0]), np.array([0.1, 0.1, 0.1])
    contact = np.array([theta, 0.0, 0.0])
    ring = core.forced_ring(1.0, angle, force, INF, 0.0, 0.0, 1.0, contact_angle=contact)
    points = 20_000
    outline = core.curved_outline(
        ring.support_radius, angle, ring.contact_length, np.zeros(3), points, contact_angle=contact
    )
    edges = np.roll(outline, -1, axis=0) - outline
    direction = np.arctan2(edges[:, 1], edges[:, 0])
    turns = np.remainder(np.roll(direction, -1) - direction + np.pi, 2 * np.pi) - np.pi
    # forces do not balance: radii of curvature vary, and with them the angle, by a part
    assert np.sort(turns)[-2:] == pytest.approx([theta] * 2, rel=0.1)
    assert np.sort(turns)[-3] < 1e-3


def test_refused():
    for change, message in (
        ({"contact_angle": [0.1]}, "length of angle, 2, not 1"),
        ({"contact_angle": [0.1, -0.1]}, "not -0.1"),
        ({"tension": 0.0, "kP": 1.0}, "tension and a skin of 0, not 0 and 0"),
        ({"force": [0.1, -0.1]}, "not -0.1"),
    ):
        given = {"angle": [0.0, 3.0], "force": [0.1, 0.1], "kA": INF, "kP": 0.0, "tension": 1.0}
        given |= {"contact_angle": [0.1, 0.0]}
        with pytest.raises(ValueError, match=message):
            core.forced_ring(1.0, **(given | change))


def test_adhesion():
    assert core.invalid_adhesion(0.0) is core.invalid_adhesion(1e-300) is None
    for adhesion in (-0.1, INF, np.nan):
        assert core.invalid_adhesion(adhesion).endswith(f"not {adhesion:g}")


def test_what_sticks_has_a_tension():
    assert core.invalid_for_adhesion(0.0, 1.0, INF, 0.1) is None
    assert core.invalid_for_adhesion(0.3, INF, 0.0, 0.0, 0.16) is None
    assert "engulfs" in core.invalid_for_adhesion(0.3, INF, 0.0, 0.0, 0.15)
    assert "angle at rest" in core.invalid_for_adhesion(0.3, 1.0, 1.0)
    assert "kP = inf" in core.invalid_for_adhesion(0.3, 1.0, INF)
    assert "skin of 0, not 0.1" in core.invalid_for_adhesion(0.3, INF, 0.0, 0.1, 1.0)

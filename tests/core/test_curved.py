"""Rings whose contacts are arcs: slopes of outlines, and packings of an independent code."""

import json
from pathlib import Path

import numpy as np
import pytest
from contacts import contacts
from hypothesis import assume, given
from hypothesis import strategies as st
from lammps_deformable import core
from test_ring_forces import STIFFNESS, pressed

DATA = Path(__file__).parents[1] / "data" / "curved_cases.json"
CASES = [case for case in json.loads(DATA.read_text()) if case["adhesion"] == 0.0]
cases = pytest.mark.parametrize("case", CASES, ids=[case["name"] for case in CASES])
stiffnesses = st.sampled_from(STIFFNESS)


@given(particle=contacts(size=(1, 9), gap=0.4), stiffness=stiffnesses)
def test_slope(particle, stiffness):
    """dW/dtheta = p L t, by central differences of the step 1e-5: errors of 1e-10."""
    _, force, ring = pressed(particle, *stiffness)
    step, turning = 1e-5, np.zeros_like(force)
    for c in range(len(force)):
        turned = [
            core.forced_ring(particle.radius, particle.angle + change, force, *stiffness).conjugate
            for change in np.outer([step, -step], np.arange(len(force)) == c)
        ]
        turning[c] = (turned[0] - turned[1]) / (2 * step)
    moments = ring.pressure * ring.contact_length * ring.slope
    np.testing.assert_allclose(moments, turning, rtol=0, atol=1e-8 * ring.energy)
    np.testing.assert_allclose(ring.d_angle, -moments, rtol=0, atol=1e-13 * ring.energy)


@given(particle=contacts(size=(1, 9), gap=0.4))
def test_slope_rate(particle):
    """Against differences of sum L G' at contacts that turn, while all lengths stay."""
    _, force, ring = pressed(particle, 1.0, np.inf)
    assume(force.max() > 0)
    length, step = ring.contact_length, 1e-4
    for c in range(len(force)):
        others, slopes = np.delete(length, c), []
        for angle in particle.angle[c] + np.array([step, -step]):
            t = (angle - np.delete(particle.angle, c)) % (2 * np.pi)
            slopes.append(others @ (np.sin(t) / 4 - (np.pi - t) * np.cos(t) / 2) / np.pi)
        rate = (slopes[0] - slopes[1]) / (2 * step)
        assert rate == pytest.approx(ring.slope_rate[c], abs=1e-7 * length.sum())


@given(particle=contacts(size=(1, 9), gap=0.4), stiffness=stiffnesses)
def test_tension(particle, stiffness):
    """Laplace's law: the tension is that of the perimeter where it changes, else p q."""
    kA, kP = stiffness
    _, _, ring = pressed(particle, kA, kP)
    q = particle.radius + ring.delta - ring.contact_length.sum() / (2 * np.pi)
    exact = ring.pressure * q
    if np.isfinite(kP):
        exact = 2 * np.pi * kP * ring.delta
    scale = ring.pressure * particle.radius
    assert ring.tension == pytest.approx(exact, abs=1e-8 * scale)


def polygon(outline):
    """Area and perimeter."""
    following = np.roll(outline, -1, axis=0)
    area = 0.5 * np.sum(outline[:, 0] * following[:, 1] - outline[:, 1] * following[:, 0])
    return area, np.hypot(*(following - outline).T).sum()


@given(
    parts=st.lists(st.floats(-0.8, 1.0), min_size=5, max_size=5),
    size=st.floats(0.004, 0.02),
    stiffness=stiffnesses,
)
def test_area_and_perimeter_of_the_outline(parts, size, stiffness):
    """The formulas, against a polygon of 20 000 points of the outline that they belong to.

    Forces balance, as at rest, so that free parts are arcs. A concave contact has a chord as long
    as L/2 > q |sin b|.
    """
    kA, kP = stiffness
    angle, force = np.arange(5) * 2 * np.pi / 5, np.full(5, size * min(kA, kP))
    straight = core.forced_ring(1.0, angle, force, kA, kP)
    q = straight.tension / straight.pressure
    sine = np.minimum(0.5, straight.contact_length / (2 * q))
    bends = np.arcsin(sine * parts)
    ring = core.forced_ring(1.0, angle, force, kA, kP, half_angle=bends)
    shape = ring.support_radius, angle, ring.contact_length, bends
    perimeter = polygon(core.curved_outline(*shape, points=20_000))[1]
    area = polygon(core.curved_outline(*shape, points=20_000, same_area=True))[0]
    assert perimeter == pytest.approx(2 * np.pi * (1.0 + ring.delta), rel=2e-7)
    deficit = (ring.pressure / kA) if np.isfinite(kA) else 0.0
    assert area == pytest.approx(np.pi - deficit, rel=2e-7)
    coarse = polygon(core.curved_outline(*shape, points=180, same_area=True))[0]
    assert coarse == pytest.approx(area, rel=1e-5)


def test_straight_contacts_are_those_without_half_angles():
    angle, force = [0.0, 2.0, 4.0], [1e-3, 2e-3, 1.5e-3]
    straight = core.forced_ring(1.0, angle, force, 1.0, 0.5)
    bent = core.forced_ring(1.0, angle, force, 1.0, 0.5, half_angle=[0.0, 0.0, 0.0])
    for name in ("energy", "pressure", "delta", "tension", "support_radius"):
        assert getattr(bent, name) == getattr(straight, name)
    assert (bent.indentation == straight.indentation).all()
    assert straight.support_radius == 1.0 + straight.delta


@cases
def test_packing(case):
    """Forces, torques and pressures balance on the lines that an independent code has found."""
    values = {name: np.array(case[name], float) for name in ("radius", "kA", "kP", "skin")}
    centers, box = np.array(case["x"]), np.array(case["box"])
    rows = case["contacts"]
    seen = [[] for _ in centers]
    apart = []
    for k, contact in enumerate(rows):
        i, j = contact["i"], contact["j"]
        vector = centers[j] - centers[i]
        apart.append(vector - box * np.round(vector / box))
        normal = np.arctan2(*apart[-1][::-1]) + contact["tilt"]
        for side, particle in enumerate((i, j)):
            sign = 1 - 2 * side
            seen[particle].append((k, normal + np.pi * side, sign * contact["half_angle"], side))
    force = np.array([contact["force"] for contact in rows])
    depth, slope, q, outer, per_p = np.zeros((5, len(rows), 2))
    energy, on_center = 0.0, np.zeros_like(centers)
    for n, its in enumerate(seen):
        k, angle, bend, side = (np.array(column) for column in zip(*its, strict=True))
        material = [float(values[name][n]) for name in ("kA", "kP", "skin")]
        gamma, radius = case["tension"][n], values["radius"][n]
        ring = core.forced_ring(radius, angle, force[k], *material, gamma, half_angle=bend)
        energy += ring.energy
        assert ring.pressure == pytest.approx(case["pressure"][n], rel=1e-10)
        assert ring.tension == pytest.approx(case["line_tension"][n], rel=1e-10)
        inner = radius - material[2]
        perimeter = 2 * np.pi * (inner + ring.delta)
        assert perimeter == pytest.approx(case["perimeter"][n], rel=1e-10)
        depth[k, side], slope[k, side] = ring.indentation, ring.slope
        q[k, side], per_p[k, side] = ring.tension / ring.pressure, 1 / ring.pressure
        outer[k, side] = q[k, side] + material[2]
        on_center[n] = -force[k] @ np.column_stack([np.cos(angle), np.sin(angle)])
        film = ring.contact_length + 2 * q[k, side] * np.sin(bend)
        film *= np.where(bend == 0.0, 1.0, bend / np.sin(np.where(bend == 0.0, 1.0, bend)))
        assert film == pytest.approx([rows[m]["length"][s] for m, s in zip(k, side, strict=True)])
    assert energy == pytest.approx(case["energy"], rel=1e-11)
    np.testing.assert_allclose(on_center, case["force"], rtol=0, atol=1e-9 * force.max())
    distance, tilt = np.hypot(*np.array(apart).T), np.array([row["tilt"] for row in rows])
    pairs = np.array([(row["i"], row["j"]) for row in rows])
    left = values["radius"][pairs].sum(1) - distance * np.cos(tilt) - depth.sum(1)
    assert np.abs(left).max() < 1e-10
    assert slope.sum(1) == pytest.approx(distance * np.sin(tilt), abs=1e-10)
    sine = force * (per_p[:, 1] - per_p[:, 0]) / (2 * outer.sum(1))
    assert sine == pytest.approx(np.sin([row["half_angle"] for row in rows]), abs=1e-10)


def test_errors():
    for words, message in (
        ({"half_angle": [0.1]}, "half_angle and force"),
        ({"half_angle": [0.1, 0.6]}, "bend by pi/6"),
        ({"half_angle": [0.1, np.nan]}, "half_angle"),
    ):
        with pytest.raises(ValueError, match=message):
            core.forced_ring(1.0, [0.0, 3.0], [1e-3, 1e-3], 1.0, 1.0, **words)


def test_errors_of_the_outline():
    for change, message in (
        ({"length": [-0.1, 0.1]}, "length"),
        ({"length": [0.1]}, "same length"),
        ({"half_angle": [0.1, 0.5 * np.pi]}, "half_angle"),
        ({"points": 3}, "points"),
    ):
        given = {"radius": 1.0, "angle": [0.0, 3.0], "length": [0.1, 0.1], "half_angle": [0.0, 0.0]}
        with pytest.raises(ValueError, match=message):
            core.curved_outline(**(given | change))


def test_errors_of_blocks():
    angle = np.arange(5) * 2 * np.pi / 5
    columns = 1.9 * np.cos(angle), 1.9 * np.sin(angle), 1 / 1.9, 1.0, 1e-3, angle, 0.0
    sides = np.column_stack([np.broadcast_to(column, 5) for column in columns])
    for row, value, message in ((0, 6, "fewer rows"), (0, 4, "more rows"), (2, -1.0, "kA")):
        particles = np.array([[5.0, 1.0, 1.0, 1.0, 0.0, 0.0]])
        particles[0, row] = value
        with pytest.raises(ValueError, match=message):
            core.curved_blocks(particles, sides)

"""Springs and dashpots of one contact: closed forms, bounds, where the energy goes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lammps_deformable import core, core_for_tests

numbers = st.floats(0, 10)
ways = st.lists(st.floats(-1, 1), min_size=1, max_size=20)


def slide(mu, kt, gt, steps, dt, normal):
    """Length of the spring and force along a path, and whether it slides."""
    xi, found = 0.0, []
    for way in steps:
        xi, force, slides = core_for_tests.rub(mu, kt, gt, xi, way, dt, normal)
        found.append((xi, force, slides))
    return np.array(found)


def test_a_spring_sticks_then_slides():
    found = slide(0.5, 2.0, 0.0, [0.1] * 10, 0.01, 1.0)
    np.testing.assert_allclose(found[:2, 1], [0.2, 0.4])
    np.testing.assert_allclose(found[2:, 1], 0.5)
    np.testing.assert_allclose(found[2:, 0], 0.25)
    assert found[:, 2].tolist() == [0, 0] + [1] * 8
    back = core_for_tests.rub(0.5, 2.0, 0.0, 0.25, -0.1, 0.01, 1.0)
    assert back == pytest.approx((0.15, 0.3, False))


def test_where_it_slides_the_dashpot_relaxes():
    """dxi/dt = (f - kt xi)/gt: xi = f/kt (1 - exp(-kt t/gt))."""
    mu, kt, gt, dt = 0.5, 2.0, 1.0, 1e-4
    found = slide(mu, kt, gt, [1.0] * 10000, dt, 1.0)  # so fast that it slides from the beginning
    time = dt * np.arange(1, 10001)
    np.testing.assert_allclose(found[:, 0], mu / kt * (1 - np.exp(-kt * time / gt)), rtol=3e-4)
    np.testing.assert_allclose(found[:, 1], mu)


@given(st.floats(0, 2), numbers, numbers, ways, st.floats(0.01, 1), st.floats(-1, 1))
def test_coulombs_bound(mu, kt, gt, steps, dt, normal):
    most = mu * max(normal, 0.0)
    for _, force, slides in slide(mu, kt, gt, steps, dt, normal):
        assert abs(force) <= most
        assert slides == 0 or abs(force) == most


def test_no_bound():
    """mu = inf does not slip where it is pressed; what is not pressed does not rub."""
    np.testing.assert_allclose(slide(np.inf, 2.0, 0.0, [0.1] * 50, 0.1, 1e-3)[-1, :2], [5, 10])
    assert core_for_tests.rub(np.inf, 2.0, 0.0, 1.0, 0.1, 0.1, 0.0) == (0.0, 0.0, True)


@given(st.floats(0, 2), numbers, numbers, ways, st.floats(0.01, 1))
def test_work_is_stored_or_lost(mu, kt, gt, steps, dt):
    """Of the mean force of each step, to rounding."""
    xi = force = work = lost = scale = 0.0
    for way in steps:
        before = xi, force
        xi, force, _ = core_for_tests.rub(mu, kt, gt, xi, way, dt, 1.0)
        work += 0.5 * (before[1] + force) * way
        parts = core_for_tests.rub_loss(kt, *before, xi, force, way)
        lost += sum(parts)
        scale += abs(work) + sum(map(abs, parts)) + kt * xi**2
    assert work == pytest.approx(lost + 0.5 * kt * xi**2, abs=1e-12 * scale)


def test_damping_never_pulls():
    assert core_for_tests.contact_damping(2.0, -0.1, 0.1, 0.5) == -2.0
    assert core_for_tests.contact_damping(2.0, 0.01, 0.1, 0.5) == pytest.approx(0.2)
    assert core_for_tests.contact_damping(2.0, 0.1, 0.1, 0.5) == 0.5
    assert core_for_tests.contact_damping(2.0, 0.1, 0.1, -0.5) == 0.0


@pytest.mark.parametrize(("kt", "gt", "damp"), [(3, 0, 0), (3, 2, 0), (1e-9, 0, 2)])
def test_time_step(kt, gt, damp):
    """A quarter of what leapfrog with this spring and dashpot is stable with."""
    mass, lever = 1.5, 3.0
    dt = core.friction_time_step(0.5, kt, gt, damp, mass, lever)
    part = mass / 2 if damp else mass / (2 * lever)
    k, g = (0, damp) if damp else (kt, gt)
    assert k * dt**2 + 2 * g * dt == pytest.approx(part)
    for factor, stable in ((0.99, True), (1.01, False)):  # k dt^2 + 2 g dt = 4 m
        step = factor * (4 * part) / (g + np.sqrt(g**2 + 4 * k * part))
        x, v = 1.0, 0.1
        for _ in range(1000):
            v -= step / part * (k * x + g * v)
            x += step * v
        assert (abs(v) < 1e3) == stable


def test_what_is_refused():
    for values, message in (
        ((-1, 1, 0, 0), "mu must be 0, positive or inf, not -1"),
        ((np.nan, 1, 0, 0), "mu must be .*, not nan"),
        ((1, np.inf, 0, 0), "kt must be .*, not inf"),
        ((1, 1, -2, 0), "gt must be .*, not -2"),
        ((1, 1, 0, -3), "damp must be .*, not -3"),
    ):
        assert core.invalid_friction(0.5, 1.0) is None
        assert core.invalid_friction(np.inf, 1.0, 0.0, 2.0) is None
        with pytest.raises(ValueError, match=message):
            core.friction_time_step(*values, 1.0, 1.0)
        with pytest.raises(ValueError, match=r"dt is 0.*positive"):
            core_for_tests.rub(1, 1, 1, 0, 0, 0, 0)


def unit(v):
    return v / np.linalg.norm(v)


@given(st.integers(0, 10**6), st.floats(1e-9, 3.1))
def test_the_shortest_rotation(seed, angle):
    """It takes n to m, keeps lengths, and its axis. Of an unknown n the part across m is left."""
    rng = np.random.default_rng(seed)
    n = unit(rng.normal(size=3))
    side = unit(np.cross(n, rng.normal(size=3)))
    m = np.cos(angle) * n + np.sin(angle) * side
    v, axis = rng.normal(size=3), np.cross(n, side)
    found = np.array(core_for_tests.turned(v, n, m))
    assert np.linalg.norm(found) == pytest.approx(np.linalg.norm(v), rel=1e-9)
    np.testing.assert_allclose(core_for_tests.turned(n, n, m), m, rtol=0, atol=1e-9)
    np.testing.assert_allclose(core_for_tests.turned(axis, n, m), axis, rtol=0, atol=1e-9)
    assert found @ m == pytest.approx(v @ n, abs=1e-9)
    unknown = np.array(core_for_tests.turned(v, np.zeros(3), m))
    np.testing.assert_allclose(unknown, v - v @ m * m, rtol=0, atol=1e-14)


def test_turned_in_the_plane():
    """What is along z stays to the last bit, whatever the normal does."""
    n, m = unit([0.3, 0.7, 0.0]), unit([-0.2, 0.9, 0.0])
    assert core_for_tests.turned([0, 0, 0.123], n, m) == (0, 0, 0.123)
    assert core_for_tests.turned([0, 0, 0.123], n, -n) == (0, 0, 0.123)


def test_films():
    """c S v^(n-1), linear below (c S/most)^(1/(1-n))."""
    film = core_for_tests.film_constant
    assert film(2.0, 0.5, 3.0, 4.0, np.inf) == pytest.approx(3.0)
    assert film(2.0, 1.0, 3.0, 4.0, 1.0) == 6.0
    assert film(2.0, 0.5, 3.0, 0.0, 10.0) == 10.0
    edge = (2.0 * 3.0 / 10.0) ** 2
    assert film(2.0, 0.5, 3.0, 0.99 * edge, 10.0) == 10.0
    assert film(2.0, 0.5, 3.0, 1.01 * edge, 10.0) == pytest.approx(10.0 / np.sqrt(1.01))
    assert film(2.0, 0.5, 0.0, 0.0, 10.0) == 0.0

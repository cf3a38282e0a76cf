"""The LCP of the ring against a naive solver and against its own duality gap."""

import numpy as np
import pytest
from contacts import Contacts, contacts
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import solve_triangular
from scipy.optimize import minimize_scalar, nnls

DEPTH = 0.102  # G > -DEPTH


def green(t):
    t = np.abs(t) % (2 * np.pi)
    return (0.5 + np.cos(t) / 4 - (np.pi - t) * np.sin(t) / 2) / np.pi


def reference(contacts):
    """Maximize a.L - L.G.L/2 over L >= 0 as a least-squares problem, on G = C C^T."""
    factor = np.linalg.cholesky(green(contacts.angle[:, None] - contacts.angle))
    target = solve_triangular(factor, contacts.indentation, lower=True)
    length, _ = nnls(factor.T, target)
    return length


def assert_optimal(contacts, relative=1e-10):
    """S is right to `relative`: the duality gap of the lengths returned bounds its error.

    With L >= 0 and slack g = a - G L, the largest a.M - M.G.M/2 over M >= 0 lies between that of L,
    which is L.G.L/2 + L.g, and L.G.L/2 + max(g, 0) sum M.
    """
    shape = contacts.shape("ring")
    length, a = shape.contact_length, contacts.indentation
    assert np.isfinite(shape.d_angle).all()
    assert (length >= 0).all()
    gap = a - green(contacts.angle[:, None] - contacts.angle) @ length
    error = abs(length @ gap) + max(gap.max(), 0) * length.sum()
    assert error <= relative * shape.area_deficit
    assert shape.area_deficit == pytest.approx(a @ length / 2, rel=relative)
    return shape


@given(contacts=contacts(size=(1, 12), gap=0.02, indentation=(-0.01, 0.03)))
@settings(max_examples=300)
def test_against_least_squares(contacts):
    shape, expected = assert_optimal(contacts), reference(contacts)
    # lengths share the condition of G, about 1/gap = 50 times what S has
    scale = max(expected.max(), 1e-300)
    np.testing.assert_allclose(shape.contact_length, expected, rtol=0, atol=1e-9 * scale)


@given(
    seed=st.integers(0, 2**32 - 1),
    z=st.sampled_from([4, 8, 15, 25, 40]),
    outside=st.floats(0, 1),
    depth=st.sampled_from([0.002, 0.005, 0.01]),
)
@settings(max_examples=500)
def test_lines_that_the_outline_bulges_up_to(seed, z, outside, depth):
    """Many lines outside of the circle: bulges activate them one after another."""
    rng = np.random.default_rng(seed)
    a = np.where(rng.random(z) < outside, -depth, 0.03) * rng.random(z)
    a[0] = 0.02
    assert_optimal(Contacts(1.0, rng.uniform(0, 2 * np.pi, z), a))


@given(
    apart=st.sampled_from([0.0, *np.logspace(-15, -6, 10).tolist()]),
    contacts=contacts(size=(2, 10), gap=0.1),
    seed=st.integers(0, 2**32 - 1),
)
@settings(max_examples=200)
def test_nearly_equal_directions(apart, contacts, seed):
    """Twins of some contacts, as deep, or deeper or shallower by anything from 1e-15 to 1e-3."""
    rng = np.random.default_rng(seed)
    twin = rng.integers(0, len(contacts.angle), rng.integers(1, 4))
    depth = rng.choice([0, 1, -1], len(twin)) * 10 ** rng.uniform(-15, -3, len(twin))
    angle = np.append(contacts.angle, contacts.angle[twin] + apart)
    indentation = np.append(contacts.indentation, contacts.indentation[twin] + depth)
    order = rng.permutation(len(angle))
    assert_optimal(Contacts(contacts.radius, angle[order], indentation[order]))


def test_all_directions_equal():
    for z in (2, 7, 40):
        indentation = np.linspace(0.01, 0.02, z)
        shape = assert_optimal(Contacts(1.0, np.full(z, 0.3), indentation))
        assert shape.area_deficit == pytest.approx(0.02**2 * 2 * np.pi / 3, rel=1e-13)


def test_half_plane():
    """Contacts on one side only: the Steiner point holds the ring."""
    for opening in (3.0, 1.0, 1e-2, 1e-4):
        assert_optimal(Contacts(1.0, np.array([0.0, opening]), np.array([0.02, 0.015])))


@pytest.mark.parametrize("variable", ["indentation", "angle"])
def test_contacts_appear_and_vanish_continuously(variable):
    """Along a path on which contacts switch, steps of the derivatives shrink with the path's."""

    def largest_steps(steps):
        start = Contacts(1.0, np.array([0.0, 1.6, 3.0, 4.4]), np.array([0.02, 0.02, 0.005, 0.02]))
        moving, begin, end = {"indentation": (2, -0.02, 0.02), "angle": (1, 0.0, 1.3)}[variable]
        path = np.linspace(begin, end, steps + 1)
        shapes = [start.moved(variable, moving, step).shape("ring") for step in path]
        switches = {tuple(s.contact_length > 0) for s in shapes}
        assert len(switches) > 1
        return np.array(
            [
                np.abs(np.diff([getattr(s, name) for s in shapes], axis=0)).max()
                for name in ("contact_length", "d_angle")
            ]
        )

    # ten times finer: ten times smaller, but for the few per cent that coarse steps cut off a peak
    assert (largest_steps(2000) < 0.11 * largest_steps(200)).all()


def test_depth_of_the_green_function():
    """No outline bulges by more than DEPTH sum L, and one contact makes it bulge that far."""
    deepest = minimize_scalar(green, bounds=(0.5, 2.5), method="bounded", options={"xatol": 1e-9})
    assert DEPTH - 1e-4 < -deepest.fun < DEPTH

    one = Contacts(1.0, np.array([0.0]), np.array([0.02]))
    theta = deepest.x
    height = (one.outline("ring", 20000) @ [np.cos(theta), np.sin(theta)]).max()
    # the highest of points 2 pi/20000 apart on an outline of radius 1: short of the top by 1e-7/8
    bulge = -deepest.fun * one.shape("ring").contact_length[0]
    assert height - 1 == pytest.approx(bulge, abs=2e-8)

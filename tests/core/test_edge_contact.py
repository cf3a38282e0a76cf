"""Contacts of a vertex with edges: check values, corners, derivatives, degenerate places."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from lammps_deformable import core

KR, C = 10.0, 0.05
EPSILON = np.finfo(float).eps
FLAT = np.array([(-0.1, 0), (0, 0), (0.1, 0)])
CONVEX = np.array([(-0.1, -0.05), (0, 0), (0.1, -0.05)])
CONCAVE = np.array([(-0.1, 0.02), (0, 0), (0.1, 0.02)])


def on_chain(vertex, chain):
    """Energy of a vertex at a chain of edges, and its force. The ends of the chain are far away."""
    terms = [core.edge_contact(vertex, v, w, KR, C) for v, w in pairwise(chain)]
    return sum(energy for energy, _, _ in terms), sum(force[0] for _, force, _ in terms)


CHECKED = [
    (FLAT, (0.02, 0.03), 2.000000e-3, (0, 0.2)),
    (CONVEX, (0.002, 0.03), 1.986703622e-3, (0.013260, 0.198893)),
    (CONCAVE, (0, 0.03), 2.236425883e-3, (0, 0.203658)),
    (CONCAVE, (0.003, 0.03), 2.269700853e-3, (-0.022060, 0.206139)),
]


def test_check_values():
    """Half of the last digit given."""
    for chain, vertex, energy, force in CHECKED:
        found, on_vertex = on_chain(vertex, chain)
        assert found == pytest.approx(energy, abs=5e-13), vertex
        np.testing.assert_allclose(on_vertex, force, rtol=0, atol=5e-7)


@pytest.mark.parametrize("chain", [FLAT, CONVEX, CONCAVE], ids=["flat", "convex", "concave"])
def test_slides_over_a_corner_without_a_jump(chain):
    """The force changes by no more than the largest second derivative times the step.

    At the height h: kr (c - h)/h for each of three terms, kr for the lines, below 4 kr here.
    """
    step = 1e-5
    x = np.arange(-0.03, 0.03, step)
    forces = np.array([on_chain((s, 0.03), chain)[1] for s in x])
    assert np.abs(np.diff(forces, axis=0)).max() < 4 * KR * step


@given(chain=st.sampled_from([CONVEX, CONCAVE]), x=st.floats(-0.04, 0.04), y=st.floats(0.01, 0.06))
def test_sense_of_the_chain_is_arbitrary(chain, x, y):
    """Each inner vertex is subtracted once, by the edge that begins there; not so the last one."""
    (energy, force), (other, back) = (on_chain((x, y), points) for points in (chain, chain[::-1]))
    assume(min(np.hypot(*(np.array([x, y]) - end)) for end in chain[[0, -1]]) > C)
    assert other == pytest.approx(energy, rel=1e-12, abs=1e-16)
    np.testing.assert_allclose(back, force, rtol=0, atol=1e-13)


# A vertex beside the edge from (0, 0) to (0.1, 0), by where its foot is, and which vertex is near
PLACES = {
    "line": (0.07, 0.03),
    "line, other side": (0.07, -0.03),
    "line and first vertex": (0.02, 0.03),
    "end": (0.113, -0.02),
    "nothing": (-0.01, 0.03),
    "far": (0.05, 0.06),
}
# a short edge, with the first vertex in reach beyond its end
SHORT = {"end and first vertex": (0.02, 0.03)}
CASES = [(place, 0.1) for place in PLACES.values()] + [(place, 0.01) for place in SHORT.values()]


@pytest.mark.parametrize(("place", "length"), CASES, ids=[*PLACES, *SHORT])
def test_derivatives(place, length):
    """Central differences: third derivatives below 10 kr/d^2, steps of 1e-6 leave 1e-12 of that."""
    turn = 0.7
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    places = np.array([place, (0, 0), (length, 0)]) @ rotation.T + (0.3, -0.2)
    _, forces, stiffness = core.edge_contact(*places, KR, C)
    step = 1e-6
    moved = step * np.eye(6).reshape(6, 3, 2)
    high = [core.edge_contact(*(places + m), KR, C) for m in moved]
    low = [core.edge_contact(*(places - m), KR, C) for m in moved]
    slope = [(h[0] - e[0]) / (2 * step) for h, e in zip(high, low, strict=True)]
    # energies of 5e-3, rounded: 1e-18/step
    np.testing.assert_allclose(-np.array(slope), forces.ravel(), rtol=0, atol=1e-8)
    curve = [(h[1] - e[1]).ravel() / (2 * step) for h, e in zip(high, low, strict=True)]
    np.testing.assert_allclose(-np.array(curve), stiffness, rtol=0, atol=1e-7 * KR)
    np.testing.assert_allclose(stiffness, stiffness.T, rtol=0, atol=1e-14 * KR / length)
    # no force and no torque in all, and a shift of all three points changes nothing
    assert np.abs(forces.sum(0)).max() <= 4 * EPSILON
    torque = places[:, 0] * forces[:, 1] - places[:, 1] * forces[:, 0]
    assert abs(torque.sum()) <= 8 * EPSILON
    shift = np.tile(np.eye(2), (3, 1))
    assert np.abs(stiffness @ shift).max() <= 1e-13 * KR * C / length


def test_all_branches_are_reached():
    """Which of the cases act at all, and which on the end of the edge."""
    energy = [core.edge_contact(place, (0, 0), (w, 0), KR, C)[0] for place, w in CASES]
    assert [np.sign(e) for e in energy] == [1, 1, 1, 1, 0, 0, 1]


coordinates = st.one_of(
    st.floats(-0.1, 0.1), st.sampled_from([0.0, 1e-170, -1e-170, 1e-150, 1e-300, 5e-324, 0.05])
)


@example(place=(0.0234375, 1e-170), end=(0.0, 0.05586788904546047))
@given(place=st.tuples(coordinates, coordinates), end=st.tuples(coordinates, coordinates))
def test_always_finite(place, end):
    """Also where points coincide. Forces are bounded by two contacts.

    The energy is phi(d) - phi(r) with d <= r, and each distance is right to two units in the last
    place: where they are equal, the energy is zero to 4 EPSILON KR C^2, of either sign.
    """
    energy, forces, stiffness = core.edge_contact(place, (0, 0), end, KR, C)
    assert -4 * EPSILON * KR * C**2 <= energy <= KR / 2 * C**2
    assert np.abs(forces).max() <= 2 * KR * C * (1 + 4 * EPSILON)
    assert np.isfinite(stiffness).all()


def test_points_that_coincide():
    on_edge, forces, _ = core.edge_contact((0.07, 0), (0, 0), (0.1, 0), KR, C)
    assert on_edge == pytest.approx(KR / 2 * C**2, rel=1e-15)
    assert not forces.any()
    for place in [(0, 0), (0.03, 0.01)]:  # an edge of length 0 is its vertex
        energy, forces, stiffness = core.edge_contact(place, (0, 0), (0, 0), KR, C)
        assert energy == 0
        assert not forces.any()
        assert not stiffness.any()
    energy, forces, _ = core.edge_contact((0.1, 0), (0, 0), (0.1, 0), KR, C)
    assert energy == pytest.approx(KR / 2 * C**2, rel=1e-15)
    assert not forces.any()


def test_refusals():
    for arguments, message in (
        (((0, 0, 0), (0, 0), (1, 0), KR, C), "vertex has 3"),
        (((0, 0), (0, np.nan), (1, 0), KR, C), r"begin\[1\] is nan"),
        (((0, 0), (0, 0), (1, 0), KR, -1.0), "c is -1"),
    ):
        with pytest.raises(ValueError, match=message):
            core.edge_contact(*arguments)

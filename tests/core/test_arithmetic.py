"""Sums and angles with the same last digits on every processor, and rows of numbers as text."""

import math

import numpy as np
import pytest
from lammps_deformable import core


def in_eight_parts(a: np.ndarray, b: np.ndarray) -> float:
    """The same order of sums, without vectors."""
    part = [0.0] * 8
    for k, (x, y) in enumerate(zip(a.ravel().tolist(), b.ravel().tolist(), strict=True)):
        part[k % 8] += x * y
    return ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]))


def test_sums_have_the_order_that_is_told() -> None:
    for size in (0, 1, 7, 8, 9, 1000):
        rng = np.random.default_rng(size)
        a, b = rng.normal(size=(2, size))
        assert core.dot(a, b) == in_eight_parts(a, b)
        assert core.norm(a) == math.sqrt(in_eight_parts(a, a))
        assert core.dot(a, b) == pytest.approx(math.fsum(a * b), rel=1e-12, abs=1e-12)


def test_arrays_of_any_shape_and_order_of_memory() -> None:
    a, b = np.random.default_rng(1).normal(size=(2, 6, 2))
    assert core.dot(a, b) == in_eight_parts(a, b)
    assert core.dot(a.T, b.T) == in_eight_parts(a.T.copy(), b.T.copy())


def test_a_product_is_added_in_place() -> None:
    y, x = np.random.default_rng(3).normal(size=(2, 11))
    expected = y + -0.3 * x
    core.axpy(y, -0.3, x)
    assert np.array_equal(y, expected)


def test_other_sizes_are_refused() -> None:
    with pytest.raises(ValueError, match="as many numbers, not 2 and 3"):
        core.dot(np.ones(2), np.ones(3))
    with pytest.raises(ValueError, match="as many numbers, not 2 and 3"):
        core.axpy(np.ones(2), 1.0, np.ones(3))


def test_unit_vectors_and_angles_are_those_of_the_c_library() -> None:
    angle = np.random.default_rng(2).uniform(-np.pi, np.pi, 50)
    vectors = core.unit_vectors(angle)
    assert vectors.tolist() == [[math.cos(a), math.sin(a)] for a in angle]
    assert core.angles(vectors).tolist() == [math.atan2(y, x) for x, y in vectors]


def test_rows_are_those_of_repr() -> None:
    rng = np.random.default_rng(3)
    of_any_bits = rng.integers(0, 2**64, 20_000, np.uint64).view(np.float64)
    edges = [0.0, -0.0, 1e-4, 1e16, 5e-324, 2.0**53, math.pi, math.inf, -math.inf, math.nan]
    around = [np.nextafter(x, end) for x in edges for end in (-math.inf, math.inf)]
    usual = rng.normal(size=10_000) * 10.0 ** rng.integers(-6, 19, 10_000)
    short = rng.integers(-999, 1000, 1000) / 10.0 ** rng.integers(0, 9, 1000)
    values = np.concatenate([of_any_bits, edges, around, usual, usual.round(), short, -short])
    values = values[: len(values) // 3 * 3]
    rows = [" ".join(map(repr, row)) for row in values.reshape(-1, 3).tolist()]
    assert core.rows_of(values, [False] * 3).splitlines() == rows
    whole = [2**53, -(2**53), 0, -1, 31, 2**31 - 1]
    mixed = np.column_stack([whole, [0.5] * 6, whole]).astype(np.float64)
    rows = [f"{n} 0.5 {float(n)!r}" for n in whole]
    assert core.rows_of(mixed, [True, False, False]).splitlines() == rows
    assert core.rows_of(np.empty((0, 2)), [True, False]) == ""
    with pytest.raises(ValueError, match="rows of 2 numbers, not 3 numbers"):
        core.rows_of(np.ones(3), [True, False])

"""Sums and angles whose last digits are the same on every processor."""

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


def test_other_sizes_are_refused() -> None:
    with pytest.raises(ValueError, match="as many numbers, not 2 and 3"):
        core.dot(np.ones(2), np.ones(3))


def test_unit_vectors_and_angles_are_those_of_the_c_library() -> None:
    angle = np.random.default_rng(2).uniform(-np.pi, np.pi, 50)
    vectors = core.unit_vectors(angle)
    assert vectors.tolist() == [[math.cos(a), math.sin(a)] for a in angle]
    assert core.angles(vectors).tolist() == [math.atan2(y, x) for x, y in vectors]

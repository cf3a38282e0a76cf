"""Soft disks and spheres: energy, virial and gradient of listed pairs."""

import lammps_deformable as ld
import numpy as np
import pytest

FIRST, SECOND = np.array([0, 0, 1]), np.array([1, 2, 1])
SHIFT, CONTACT = np.array([[0.0, 0.0], [0.0, 0.0], [0.8, 0.0]]), np.array([1.0, 1.2, 1.0])
X = np.array([[0.0, 0.0], [0.3, 0.4], [3.0, 0.0]])


def test_values_of_three_pairs() -> None:
    """d = 0.6 and an image at 0.96 at a scale of 1.2; the third pair does not touch."""
    energy, virial, gradient = ld.core.SoftDisks(3, FIRST, SECOND, SHIFT, CONTACT)(X, 1.2)
    assert energy == pytest.approx(0.5 * (0.4**2 + 0.04**2), rel=1e-14)
    assert virial == pytest.approx(0.4 * 0.6 + 0.04 * 0.96, rel=1e-14)
    # -1.2 (0.4) (0.6, 0.8) on disk 1; its image pushes itself from both sides
    assert gradient == pytest.approx([0.288, 0.384, -0.288, -0.384, 0.0, 0.0], rel=1e-14)


def test_spheres_in_a_plane_are_disks() -> None:
    """In any of the three planes."""
    expected = ld.core.SoftDisks(3, FIRST, SECOND, SHIFT, CONTACT)(X, 1.2)
    for axis in range(3):
        shift, x = (np.insert(values, axis, 0.0, axis=1) for values in (SHIFT, X))
        spheres = ld.core.SoftSpheres(3, FIRST, SECOND, shift, CONTACT)
        energy, virial, gradient = spheres(x, 1.2)
        assert (energy, virial) == pytest.approx(expected[:2], rel=1e-14)
        flat = np.insert(expected[2].reshape(-1, 2), axis, 0.0, axis=1)
        assert gradient == pytest.approx(flat.ravel(), rel=1e-14)


@pytest.mark.parametrize("dimension", [2, 3])
def test_gradient_is_that_of_finite_differences(dimension: int) -> None:
    rng, step = np.random.default_rng(1), 1e-6
    i, j = np.triu_indices(20, 1)
    kernel = ld.core.SoftDisks if dimension == 2 else ld.core.SoftSpheres
    disks = kernel(20, i, j, np.zeros((190, dimension)), np.full(190, 0.4))
    x, way = rng.random((20, dimension)), rng.normal(size=(20, dimension))
    above, below = (disks(x + sign * step * way, 1.3)[0] for sign in (1.0, -1.0))
    slope = float(disks(x, 1.3)[2] @ way.ravel())
    assert slope == pytest.approx((above - below) / (2.0 * step), rel=1e-6)


def test_disks_at_one_place_push_in_no_direction() -> None:
    energy, virial, gradient = ld.core.SoftDisks(
        2, np.array([0]), np.array([1]), np.zeros((1, 2)), np.array([1.0])
    )(np.zeros((2, 2)), 1.0)
    assert (energy, virial, gradient.tolist()) == (0.5, 0.0, [0.0] * 4)


def test_wrong_pairs_are_refused() -> None:
    with pytest.raises(ValueError, match="each of 3 pairs"):
        ld.core.SoftDisks(3, FIRST, SECOND, SHIFT[:2], CONTACT)
    with pytest.raises(ValueError, match="pair 1 has the disk 2 of 2"):
        ld.core.SoftDisks(2, FIRST, SECOND, SHIFT, CONTACT)
    with pytest.raises(ValueError, match="x has 2 rows"):
        ld.core.SoftDisks(3, FIRST, SECOND, SHIFT, CONTACT)(X[:2], 1.0)


def test_few_springs_between_many_disks() -> None:
    """Single precision holds P: epsilon is a part of the springs, however many disks have none."""
    disks = 200_000
    x = np.column_stack([np.arange(disks, dtype=float), np.zeros(disks)])
    pair, along, weight = (np.array([0]), np.array([1])), np.array([[1.0, 0.0]]), np.ones(1)
    springs = ld.core.DiskSprings(x, *pair, along, weight, epsilon=3e-3)
    q = np.tile([1.0, -1.0], disks)
    np.testing.assert_allclose(springs(q), q / 3e-3, rtol=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_springs_are_the_matrix_of_the_formula(dimension: int) -> None:
    """P^-1 q against the matrix written out, in single precision."""
    random = np.random.default_rng(1)
    x = random.uniform(0.0, 5.0, (40, dimension))
    i, j = random.integers(0, 40, (2, 150))
    i, j = i[i != j], np.where(np.arange(150) % 10, j, -1)[i != j]
    n = random.normal(size=(len(i), dimension))
    n /= np.linalg.norm(n, axis=1)[:, None]
    weight = random.uniform(0.1, 1.0, len(i))
    matrix = np.zeros((40, dimension, 40, dimension))
    for a, b, along, w in zip(i, j, n, weight, strict=True):
        block = w * np.outer(along, along)
        matrix[a, :, a] += block
        if b >= 0:
            matrix[b, :, b] += block
            matrix[a, :, b] -= block
            matrix[b, :, a] -= block
    p = matrix.reshape(40 * dimension, -1)
    p += 0.01 * np.trace(p) / len(p) * np.eye(len(p))
    q = random.normal(size=len(p))
    found = ld.core.DiskSprings(x, i, j, n, weight, 0.01)(q)
    np.testing.assert_allclose(p @ found, q, atol=1e-4)


def test_springs_need_rows_of_one_dimension() -> None:
    pair, weight = (np.array([0]), np.array([1])), np.ones(1)
    with pytest.raises(ValueError, match="two columns, or three"):
        ld.core.DiskSprings(np.zeros((2, 3)), *pair, np.ones((1, 2)), weight, 0.01)
    with pytest.raises(ValueError, match="two columns, or three"):
        ld.core.DiskSprings(np.zeros((2, 4)), *pair, np.ones((1, 4)), weight, 0.01)

"""Linear systems by factors."""

import numpy as np
import pytest
from lammps_deformable.state.hessian_matrix import factored
from scipy.sparse import csr_matrix, diags, random


def test_product_with_the_inverse() -> None:
    """Also of a matrix with pivots of both signs, and of several columns."""
    rng = np.random.default_rng(1)
    some = random(40, 40, density=0.05, random_state=1, format="csr")
    matrix = some + some.T + diags(np.where(np.arange(40) < 30, 5.0, -5.0))
    right = rng.normal(size=(40, 3))
    inverse = factored(matrix)
    assert matrix @ inverse(right) == pytest.approx(right, abs=1e-13)
    assert inverse(right)[:, 1].tolist() == inverse(right[:, 1]).tolist()


def test_a_singular_matrix_is_told() -> None:
    with pytest.raises(RuntimeError):
        factored(csr_matrix(np.ones((2, 2))))

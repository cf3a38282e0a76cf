"""Factors of sparse matrices whose last digits are the same on every processor."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def factored(matrix: Any) -> Callable[[Floats], Floats]:
    """Product with the inverse of a sparse symmetric matrix, by QDLDL.

    It adds in one order everywhere. SuperLU does not: it calls the kernels of linear algebra that
    are made for each processor.

    Args:
        matrix: of `scipy.sparse`, shape (n, n).

    Returns:
        A function of right sides, shape (n,) or (n, k).

    Raises:
        RuntimeError: a pivot is zero: the matrix is singular, or needs exchanges of rows.
    """
    import qdldl
    from scipy.sparse import triu

    solve: Callable[[Floats], Floats] = qdldl.Solver(triu(matrix, format="csc"), upper=True).solve

    def product(right: Floats) -> Floats:
        if right.ndim == 1:
            return solve(right)
        return np.stack([solve(column) for column in right.T], axis=1)

    return product

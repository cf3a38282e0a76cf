"""Bond-orientational order of particles, by the sides of their Voronoi cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..common.checks import count

if TYPE_CHECKING:
    from .voronoi import Cells

Floats = NDArray[np.float64]


def hexatic(cells: Cells, number: int, k: int) -> NDArray[np.complex128]:
    """See `State.hexatic`, of so many particles."""
    x, y = cells.direction.T
    order = np.zeros(number, dtype=np.complex128)
    np.add.at(order, cells.i, cells.side * (x + 1j * y) ** count("k", k))
    total = np.bincount(cells.i, cells.side, minlength=number)
    return np.divide(order, total, out=np.full(number, np.nan + 0j), where=total > 0.0)


def steinhardt(cells: Cells, number: int, degree: int) -> Floats:
    """See `State.steinhardt`, of so many particles."""
    from scipy.special import eval_legendre

    count("l", degree)
    ends = np.searchsorted(cells.i, np.arange(1, number))
    order = np.full(number, np.nan)
    for n, (direction, side) in enumerate(
        zip(np.split(cells.direction, ends), np.split(cells.side, ends), strict=True)
    ):
        if len(side):
            cosine = np.clip(direction @ direction.T, -1.0, 1.0)
            order[n] = np.sqrt(max(side @ eval_legendre(degree, cosine) @ side, 0.0)) / side.sum()
    return order

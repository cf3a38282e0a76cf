"""Density waves of centers in a periodic box, and their static structure factor."""

from __future__ import annotations

from functools import reduce

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..model.lattice import fractional, lengths
from ..model.neighbors import forward
from ..model.packing import Packing
from ..model.room import closed

Floats = NDArray[np.float64]

# Farthest from a whole number of periods in the box that a wave may be.
_WHOLE = 1e-6

# Phases that are in memory at a time.
_PHASES = 2_000_000


def structure_factor(packing: Packing, k_max: float, bins: int) -> tuple[Floats, Floats]:
    """See `Analysis.structure_factor`."""
    _refuse_container(packing)
    fractions, box = fractional(packing.positions, packing.box), packing.box
    # k = 2 pi (h, m, ..) B^-T, and h = k.a / 2 pi is below k_max |a| / 2 pi
    most = (k_max * lengths(box) / (2.0 * np.pi)).astype(int).tolist()
    # of k and -k, which are one wave, that with h >= 0
    orders = [np.arange(most[0] + 1), *(np.arange(-each, each + 1) for each in most[1:])]
    total = np.zeros((np.prod([len(h) for h in orders[:-1]]), len(orders[-1])), dtype=complex)
    block = max(_PHASES // len(total), 1)
    for first in range(0, len(packing), block):
        places = fractions[first : first + block].T
        phases = [
            np.exp(2.0j * np.pi * np.outer(h, x)) for h, x in zip(orders, places, strict=True)
        ]
        *some, last = phases
        before = reduce(lambda a, b: (a[:, None] * b).reshape(-1, b.shape[1]), some)
        total += before @ last.T
    power = np.abs(total).ravel() ** 2 / len(packing)
    grid = np.stack(np.meshgrid(*orders, indexing="ij"), axis=-1).reshape(-1, len(box))
    k = lengths(2.0 * np.pi * grid @ np.linalg.inv(box).T)
    kept = (k <= k_max) & forward(grid)
    edges = np.linspace(0.0, k_max, bins + 1)
    count, summed = (np.histogram(k[kept], edges, weights=each)[0] for each in (None, power[kept]))
    middle = 0.5 * (edges[1:] + edges[:-1])
    return middle, np.where(count > 0, summed / np.maximum(count, 1), np.nan)


def density_waves(packing: Packing, k: Floats) -> NDArray[np.complex128]:
    """See `Analysis.density_waves`."""
    _refuse_container(packing)
    if k.ndim != 2 or k.shape[1] != packing.dimension:
        raise ParameterError(f"k must have shape (M, {packing.dimension}), not {k.shape}")
    periods = k @ packing.box.T / (2.0 * np.pi)
    off = np.abs(periods - np.rint(periods)).max(axis=1, initial=0.0)
    if off.max(initial=0.0) > _WHOLE:
        n = int(off.argmax())
        nearest = 2.0 * np.pi * np.linalg.solve(packing.box, np.rint(periods[n]))
        raise ParameterError(
            f"k = {k[n].tolist()} is no wave vector of the box: it has {periods[n].tolist()} "
            f"periods along its sides, not whole numbers; the nearest one is {nearest.tolist()}"
        )
    return np.array([np.exp(1.0j * (packing.positions @ wave)).mean() for wave in k])


def _refuse_container(packing: Packing) -> None:
    if any(closed(packing.walls, packing.dimension)):
        raise ParameterError(
            "the structure factor needs a periodic box: a container has no wave vectors of its own"
        )

"""The strain around each particle between two states, and what it leaves over: D^2_min."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..model.neighbors import pairs_within
from ..model.packing import Packing
from .displacements import Snapshot, affine, nonaffine, packing_of

Floats = NDArray[np.float64]

# Neighbors on a line, or in a plane, do not tell a strain: the determinant of sum v v^T over the
# power of its trace.
_ON_A_LINE = 1e-10


class LocalStrain(NamedTuple):
    """The strain around each particle.

    Attributes:
        gradient: of the displacement, du_a/dx_b, that fits the motion of the neighbors best, shape
            (N, d, d); nan where all neighbors are on one line, or in one plane.
        d2min: D^2_min, the sum over neighbors of the squared distance from that fit, shape (N,)
            [length^2].
        neighbors: their number, shape (N,).
    """

    gradient: Floats
    d2min: Floats
    neighbors: NDArray[np.int64]

    @property
    def strain(self) -> Floats:
        """Symmetric part of the gradient, without rotation, shape (N, d, d)."""
        return 0.5 * (self.gradient + np.swapaxes(self.gradient, 1, 2))


def local_strain(before: Snapshot | Packing, now: Snapshot, r_max: float) -> LocalStrain:
    """See `Analysis.local_strain`."""
    beside, start = nonaffine(before, now), packing_of("before", before)
    i, j, shift = pairs_within(start, r_max)
    v = start.positions[j] + shift - start.positions[i]
    w = affine(before, now, v) + beside[j] - beside[i]
    i, v, w = np.concatenate([i, j]), np.concatenate([v, -v]), np.concatenate([w, -w])
    dimension = start.dimension
    total = np.zeros((2, len(start), dimension, dimension))
    np.add.at(total[0], i, v[:, :, None] * v[:, None, :])
    np.add.at(total[1], i, (w - v)[:, :, None] * v[:, None, :])
    within, moved = total
    size = np.trace(within, axis1=1, axis2=2) ** dimension
    flat = np.linalg.det(within) <= _ON_A_LINE * size
    gradient = moved @ np.linalg.inv(np.where(flat[:, None, None], np.eye(dimension), within))
    gradient[flat] = np.nan
    left = w - v - np.einsum("mab,mb->ma", gradient[i], v)
    number = len(start)
    d2min = np.zeros(number)
    np.add.at(d2min, i, np.sum(left**2, axis=1))
    d2min[flat] = np.nan
    return LocalStrain(gradient, d2min, np.bincount(i, minlength=number))


def usual_distance(packing: Packing) -> float:
    """Distance up to which particles are neighbors, 3 times the mean radius [length]."""
    return 3.0 * float(packing.radius.mean())

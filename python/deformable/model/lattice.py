"""Positions in a box and their fractions of its lattice vectors.

The last digits are the same on every processor: those of a product of matrices are not, and a
minimizer of disks makes another packing of that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def cartesian(fractions: Floats, box: Floats) -> Floats:
    """Positions x = f box, shape (..., 2) [length].

    Args:
        fractions: f, or whole numbers of lattice vectors, shape (..., 2).
        box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length].
    """
    f, g = fractions[..., 0], fractions[..., 1]
    (lx, _), (xy, ly) = box.tolist()
    return np.stack([f * lx + g * xy, g * ly], axis=-1)


def fractional(positions: Floats, box: Floats) -> Floats:
    """Fractions f with x = f box, shape (..., 2); see `cartesian`."""
    (lx, _), (xy, ly) = box.tolist()
    g = positions[..., 1] / ly
    return np.stack([(positions[..., 0] - g * xy) / lx, g], axis=-1)


def nearest_image(vectors: Floats, box: Floats, shut: tuple[bool, bool]) -> Floats:
    """Vectors between images that are nearest along y, and then along x, shape (n, 2) [length].

    Args:
        vectors: between any images, shape (n, 2) [length].
        box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length].
        shut: whether walls close the directions x and y, which then have no images.
    """
    (lx, _), (xy, ly) = box.tolist()
    x, y = vectors.T
    up = 0.0 if shut[1] else np.rint(y / ly)
    x, y = x - up * xy, y - up * ly
    across = 0.0 if shut[0] else np.rint(x / lx)
    return np.column_stack([x - across * lx, y])

"""Lattice vectors of a box, positions in it and their fractions of these.

The last digits are the same on every processor: those of a product of matrices are not, and a
minimizer of disks makes another packing of that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError
from ..common.validate import numbers, shown

Floats = NDArray[np.float64]

# Largest tilt of a box over its width: LAMMPS loses particles, or hangs, at some more.
_MOST_TILTED = 30.0


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


def lattice_vectors(box: ArrayLike) -> NDArray[np.float64]:
    """The box, if it is ((lx, 0), (xy, ly)) with finite numbers, lx, ly > 0 and |xy| <= 30 lx.

    (lx, ly) stands for a rectangle.
    """
    vectors = numbers("box", box)
    if vectors.shape == (2,):
        vectors = np.diag(vectors)
    if vectors.shape != (2, 2) or vectors[0, 1] != 0.0 or not (vectors.diagonal() > 0.0).all():
        raise ParameterError(
            "box must be (lx, ly) or ((lx, 0), (xy, ly)) with lx, ly > 0, not "
            f"{shown(vectors.tolist())}"
        )
    (lx, _), (xy, _) = vectors.tolist()
    if abs(xy) > _MOST_TILTED * lx:
        raise ParameterError(
            f"box must be tilted by at most {_MOST_TILTED:g} of its widths, not {xy / lx:.3g}: the "
            f"box with xy = {xy - lx * np.rint(xy / lx):.6g} has the same images"
        )
    vectors.setflags(write=False)
    return vectors


def shown_box(box: NDArray[np.float64]) -> str:
    """A box in a few words, for `repr`."""
    (lx, _), (xy, ly) = box.tolist()
    return f"box {lx:.4g} x {ly:.4g}" + (f" tilted by {xy:.4g}" if xy else "")

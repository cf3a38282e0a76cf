"""The periodic box: lattice vectors, positions in it, and their fractions of these.

Products of matrices have other last digits on other processors, and a minimizer of disks makes
another packing of that. So sums stand here term by term.
"""

from __future__ import annotations

from functools import reduce
from itertools import combinations
from operator import add
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import numbers, shown, whole
from .errors import ParameterError, UndefinedError

if TYPE_CHECKING:
    from collections.abc import Sequence


def refuse_space(what: str, dimension: int, way_out: str, attribute: bool = False) -> None:
    """Refuse three dimensions.

    Args:
        what: name of what is defined in the plane only.
        dimension: of the packing.
        way_out: what to do in three dimensions.
        attribute: it is one of a packing, which `hasattr` may ask for.

    Raises:
        ParameterError: there are three dimensions.
    """
    if dimension == 3:
        raise (UndefinedError if attribute else ParameterError)(
            f"{what} is for packings in the plane, and this one has three dimensions: {way_out}"
        )


def dimension_of(dimension: int) -> int:
    """The dimension, if it is 2 or 3."""
    if (number := whole("dimension", dimension)) not in (2, 3):
        raise ParameterError(f"dimension must be 2 or 3, not {shown(dimension)}")
    return number


Floats = NDArray[np.float64]

# Largest tilt of a box over its width: LAMMPS loses particles, or hangs, at some more.
_MOST_TILTED = 30.0


# LAMMPS finds neighbors by bins, which it refuses to make much wider than the box is thick.
_THIN = 10.0


def half_thickness(radius: float) -> float:
    """Half the thickness of LAMMPS' box in the plane, for a largest radius [length].

    It changes no result: particles are at z = 0, and stresses are those of an area.
    """
    return 0.5 if radius <= _THIN else float(radius)


def cartesian(fractions: Floats, box: Floats) -> Floats:
    """Positions x = f box, shape (..., d) [length].

    Args:
        fractions: f, or whole numbers of lattice vectors, shape (..., d).
        box: lattice vectors as rows, ((lx, 0), (xy, ly)) or, in three dimensions,
            ((lx, 0, 0), (xy, ly, 0), (xz, yz, lz)), shape (d, d) [length].
    """
    axes = range(len(box))
    columns = ([fractions[..., k] * box[k, axis] for k in axes if k >= axis] for axis in axes)
    return np.stack([reduce(add, parts) for parts in columns], axis=-1)


def fractional(positions: Floats, box: Floats) -> Floats:
    """Fractions f with x = f box, shape (..., d); see `cartesian`."""
    found = np.empty(np.shape(positions))
    for axis in reversed(range(len(box))):
        left = positions[..., axis]
        for k in range(axis + 1, len(box)):
            left = left - found[..., k] * box[k, axis]
        found[..., axis] = left / box[axis, axis]
    return found


def nearest_image(vectors: Floats, box: Floats, shut: Sequence[bool]) -> Floats:
    """Vectors between images that are nearest along the last axis, and so on to x, shape (n, d).

    Args:
        vectors: between any images, shape (n, d) [length].
        box: lattice vectors as rows, see `cartesian`, shape (d, d) [length].
        shut: whether walls close each direction, which then has no images.
    """
    found = np.array(vectors)
    for axis in reversed(range(len(box))):
        if not shut[axis]:
            found -= np.rint(found[:, axis] / box[axis, axis])[:, None] * box[axis]
    return found


def lengths(vectors: Floats) -> Floats:
    """Lengths of vectors, shape (..., d), with the digits of `np.hypot`."""
    found: Floats = reduce(np.hypot, np.moveaxis(vectors, -1, 0))
    return found


def widths(box: Floats) -> Floats:
    """Distances between opposite sides of the box, shape (d,) [length]."""
    if len(box) == 2:
        found: Floats = np.prod(box.diagonal()) / np.hypot(*box[::-1].T)
        return found
    sides = np.cross(np.roll(box, -1, axis=0), np.roll(box, -2, axis=0))
    return np.prod(box.diagonal()) / lengths(sides)


def lattice_vectors(box: ArrayLike) -> Floats:
    """The box, if it has the form of `cartesian`, sides above 0, and tilts of at most 30 sides.

    (lx, ly) stands for a rectangle, (lx, ly, lz) for a cuboid.
    """
    vectors = numbers("box", box)
    if vectors.shape in ((2,), (3,)):
        vectors = np.diag(vectors)
    square = vectors.shape in ((2, 2), (3, 3))
    if not square or np.triu(vectors, 1).any() or not (vectors.diagonal() > 0.0).all():
        raise ParameterError(
            "box must be (lx, ly) or rows ((lx, 0), (xy, ly)) with lx, ly > 0, or in space "
            "(lx, ly, lz) or ((lx, 0, 0), (xy, ly, 0), (xz, yz, lz)), not "
            f"{shown(vectors.tolist())}"
        )
    for upper, lower in combinations(range(len(vectors)), 2):
        tilt, side = vectors[lower, upper], vectors[upper, upper]
        if abs(tilt) > _MOST_TILTED * side:
            name = "xyz"[upper] + "xyz"[lower]
            raise ParameterError(
                f"box must be tilted by at most {_MOST_TILTED:g} of its widths, not "
                f"{tilt / side:.3g}: the box with {name} = "
                f"{tilt - side * np.rint(tilt / side):.6g} has the same images"
            )
    vectors.setflags(write=False)
    return vectors


def shown_box(box: Floats) -> str:
    """A box in a few words, for `repr`."""
    tilts = [f"{tilt:.4g}" for tilt in box[np.tril_indices(len(box), -1)].tolist() if tilt]
    sides = " x ".join(f"{side:.4g}" for side in box.diagonal().tolist())
    return f"box {sides}" + (f" tilted by {', '.join(tilts)}" if tilts else "")


def in_space(vectors: Floats) -> Floats:
    """Vectors of the plane with z = 0, those of space as they are, shape (N, 3)."""
    return np.column_stack([vectors, np.zeros((len(vectors), 3 - vectors.shape[1]))])

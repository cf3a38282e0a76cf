"""Crystals of equal particles: the triangular lattice, and the cubic ones in three dimensions."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ._checks import count, numbers, positive, shown
from .errors import ParameterError
from .packing import Packing

if TYPE_CHECKING:
    from collections.abc import Sequence

# Packing fraction of disks that touch.
TOUCH = math.pi / math.sqrt(12.0)

# Particles in the cubic cell, in its sides, and the distance of neighbors.
_CUBIC = {
    "sc": ([(0.0, 0.0, 0.0)], 1.0),
    "bcc": ([(0.0, 0.0, 0.0), (0.5, 0.5, 0.5)], math.sqrt(0.75)),
    "fcc": (
        [(0.0, 0.0, 0.0), (0.5, 0.5, 0.0), (0.5, 0.0, 0.5), (0.0, 0.5, 0.5)],
        math.sqrt(0.5),
    ),
}


def triangular(columns: int, rows: int, radius: float = 0.5, phi: float = TOUCH) -> Packing:
    """Equal particles on a triangular lattice that fits into its periodic box.

        triangular(16, 16, phi=0.95)

    Rows lie along x at distances of sqrt(3)/2 of the spacing, every second one is shifted by half
    of it. From the packing fraction pi/sqrt(12) = 0.9069 on neighbors touch.

    Args:
        columns: number of particles in a row.
        rows: number of rows, even.
        radius: of the particles [length].
        phi: packing fraction, sum pi R^2 / box area, at most 10.

    Returns:
        The packing, of columns times rows particles, row by row.

    Raises:
        ParameterError: a value is out of range, e.g. an odd number of rows.
    """
    columns, rows, radius = (
        count("columns", columns),
        count("rows", rows),
        positive("radius", radius),
    )
    if rows % 2:
        raise ParameterError(
            f"rows must be even, not {rows}: every second row is shifted, and the box is periodic"
        )
    height = math.sqrt(0.75)
    column, row = np.tile(np.arange(columns), rows), np.repeat(np.arange(rows), columns)
    touching = Packing(
        positions=2.0 * radius * np.column_stack([column + 0.5 * (row % 2), height * row]),
        species=np.zeros(columns * rows, dtype=np.int64),
        radii=np.array([radius]),
        box=2.0 * radius * np.diag([columns, height * rows]),
    )
    return touching.at(phi)


def cubic(
    lattice: str, cells: int | Sequence[int], radius: float = 0.5, phi: float | None = None
) -> Packing:
    """Equal spheres on a cubic lattice that fits into its periodic box.

        cubic("fcc", 4, phi=0.8)

    Neighbors touch from the packing fraction pi/sqrt(18) = 0.7405 on in fcc, sqrt(3) pi/8 = 0.6802
    in bcc, pi/6 = 0.5236 in sc.

    Args:
        lattice: `fcc` (face-centered), `bcc` (body-centered) or `sc` (simple cubic).
        cells: number of cubic cells along each side of the box, or along x, y and z; a cell has 4,
            2 or 1 spheres.
        radius: of the spheres [length].
        phi: packing fraction, sum 4 pi R^3 / (3 box volume), at most 10; that of spheres that touch
            if not given.

    Returns:
        The packing, cell by cell.

    Raises:
        ParameterError: a value is out of range, or there is no such lattice.
    """
    if not isinstance(lattice, str) or lattice not in _CUBIC:
        raise ParameterError(f"lattice must be {', '.join(_CUBIC)}, not {shown(lattice)}")
    sides = numbers("cells", cells)
    if sides.shape not in ((), (3,)):
        raise ParameterError(f"cells must be one number, or three, not {shown(cells)}")
    along = [count("cells", side) for side in np.broadcast_to(sides, 3).tolist()]
    basis, distance = _CUBIC[lattice]
    corners = np.stack(np.meshgrid(*map(np.arange, along), indexing="ij"), axis=-1)
    places = (corners.reshape(-1, 1, 3) + np.array(basis)).reshape(-1, 3)
    side = 2.0 * positive("radius", radius) / distance
    touching = Packing(
        positions=side * places,
        species=np.zeros(len(places), dtype=np.int64),
        radii=np.array([radius]),
        box=side * np.array(along, dtype=np.float64),
    )
    return touching if phi is None else touching.at(phi)

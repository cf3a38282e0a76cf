"""The triangular lattice, the densest packing of equal particles."""

from __future__ import annotations

import math

import numpy as np

from ..common.errors import ParameterError
from ..common.validate import count, positive
from .packing import Packing

# Packing fraction of disks that touch.
TOUCH = math.pi / math.sqrt(12.0)


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

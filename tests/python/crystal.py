"""A triangular lattice, where everything is known exactly."""

import lammps_deformable as ld
import numpy as np

RADIUS = 0.5


def crystal(indentation: float, columns: int = 4, rows: int = 4) -> ld.Packing:
    """Equal particles of radius 0.5 on a triangular lattice that indents them by a part of it.

    Each is a hexagon of inradius h = R (1 - a/R), in a rectangular box.
    """
    spacing = 2.0 * RADIUS * (1.0 - indentation)
    height = spacing * np.sqrt(0.75)
    k, m = (index.ravel() for index in np.meshgrid(np.arange(columns), np.arange(rows)))
    return ld.Packing(
        np.column_stack([(k + 0.5 * (m % 2)) * spacing, m * height]),
        RADIUS,
        [[columns * spacing, 0.0], [0.0, rows * height]],
    )

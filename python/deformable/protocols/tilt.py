"""Boxes that simple shear tilts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..engine.lammps import run


def sheared(points: NDArray[np.float64], strain: float) -> NDArray[np.float64]:
    """Points, or the rows of a box, after simple shear along x, shape (n, 2) [length]."""
    x, y = points.T
    return np.column_stack([x + strain * y, y])


def straighten(sim: Any) -> None:
    """Replace the box by the equivalent one with the smallest tilt; the particles stay."""
    (lx, _), (xy, _) = sim.box.tolist()
    widths = round(xy / lx)
    if widths:
        run(sim.lmp, f"change_box all xy final {xy - widths * lx!r} units box")

"""Boxes that simple shear tilts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..engine.lammps import run


def sheared(points: NDArray[np.float64], strain: float) -> NDArray[np.float64]:
    """Points, or the rows of a box, after simple shear along x, shape (n, d) [length]."""
    moved = np.array(points)
    moved[:, 0] += strain * points[:, 1]
    return moved


def straighten(sim: Any) -> None:
    """Replace the box by the equivalent one with the smallest tilt; the particles stay."""
    lx, xy = float(sim.box[0, 0]), float(sim.box[1, 0])
    widths = round(xy / lx)
    if widths:
        run(sim.lmp, f"change_box all xy final {xy - widths * lx!r} units box")

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
    """Replace the box by the equivalent one with the smallest tilts; the particles stay."""
    box = sim.box
    straight = straightened(box)
    places = {"xy": (1, 0), "xz": (2, 0), "yz": (2, 1)}
    ends = [
        f"{name} final {float(straight[place])!r}"
        for name, place in places.items()
        if max(place) < len(box) and straight[place] != box[place]
    ]
    if ends:
        run(sim.lmp, f"change_box all {' '.join(ends)} units box")


def straightened(box: NDArray[np.float64]) -> NDArray[np.float64]:
    """The equivalent box with the smallest tilts, shape (d, d) [length]."""
    straight = box.copy()
    for row in range(1, len(box)):
        for column in range(row - 1, -1, -1):
            widths = round(float(straight[row, column] / straight[column, column]))
            straight[row] -= widths * straight[column]
    return straight

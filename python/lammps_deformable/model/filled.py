"""The area or volume that particles fill."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def filled_area(area: Floats, perimeter: Floats, skin: Floats) -> Floats:
    """A + P s + pi s^2 of particles of the area A and the perimeter P within skins of thickness s.

    Args:
        area: shape (N,) [length^2].
        perimeter: shape (N,) [length].
        skin: shape (N,) [length].
    """
    return area + skin * perimeter + np.pi * skin**2


def undeformed(radius: Floats, dimension: int) -> float:
    """Area of all disks, sum pi R^2, or volume of all spheres, sum 4 pi R^3/3."""
    if dimension == 2:
        return float(np.pi * np.sum(radius**2))
    return float(4.0 / 3.0 * np.pi * np.sum(radius**3))


def root(ratio: float, dimension: int) -> float:
    """The ratio of lengths to a ratio of areas, or of volumes."""
    return float(np.sqrt(ratio) if dimension == 2 else np.cbrt(ratio))

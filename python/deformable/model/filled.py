"""The area that a particle fills."""

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

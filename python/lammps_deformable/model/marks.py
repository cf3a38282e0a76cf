"""Lines that a picture has on its particles, and on their periodic images."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Mark(NamedTuple):
    """Lines of one color.

    Attributes:
        lines: of each particle, arrays of shape (m, 2) [length].
        widths: of each particle, of its lines [points].
        color: a name of matplotlib.
    """

    lines: Sequence[Sequence[NDArray[np.float64]]]
    widths: Sequence[Sequence[float]]
    color: str

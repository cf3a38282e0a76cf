"""Pressure and shear stress of a packing, from its stress."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


class Stressed:
    """A state with a `stress`."""

    stress: NDArray[np.float64]

    @property
    def pressure(self) -> float:
        """Pressure of the packing, trace of `stress` over the dimension d [energy/length^d]."""
        return float(np.trace(self.stress) / len(self.stress))

    @property
    def shear_stress(self) -> float:
        """Shear stress that resists a shear along x, -`stress[0, 1]` [energy/length^d]."""
        return -float(self.stress[0, 1])

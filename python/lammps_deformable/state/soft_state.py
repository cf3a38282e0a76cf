"""What states of soft disks and of soft spheres have in common."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.packing import Packing
from .analysis import Analysis
from .contact_network import ContactNetwork
from .numbers import numbers_of
from .soft_response import SoftResponse
from .stressed import Stressed


@dataclass(frozen=True, eq=False, repr=False)
class SoftState(SoftResponse, Stressed, ContactNetwork, Analysis):
    """Soft particles that overlap, of contact stiffness k; attributes are those of `DiskState`."""

    packing: Packing
    law: None
    energy: float
    stress: NDArray[np.float64]
    pairs: NDArray[np.int64]
    residual: float
    stalled: bool
    wall_pairs: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    strain: float | None = None

    @property
    def phi(self) -> float:
        """Packing fraction, sum pi R^2 / `packing.area`; overlaps count twice."""
        return self.packing.phi

    @property
    def particle_pressure(self) -> NDArray[np.float64]:
        """Pressure of each particle, trace of `particle_stress` over the dimension, (N,)."""
        return np.trace(self.particle_stress, axis1=1, axis2=2) / self.packing.dimension

    def numbers(self) -> dict[str, Any]:
        """The state in numbers, by name; `strain` is None without shear."""
        return numbers_of(self)

    @property
    def _contact_sides(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        i, j = self.pairs.T
        walled = self.wall_pairs[:, 0]
        return np.concatenate([i, j, walled]), np.concatenate([j, i, np.full_like(walled, -1)])

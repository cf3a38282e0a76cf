"""A state of soft disks: a snapshot, which later steps do not change."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..model.packing import Packing
from .contact_network import ContactNetwork


@dataclass(frozen=True, eq=False, repr=False)
class DiskState(ContactNetwork):
    """A snapshot of soft disks of contact stiffness k. Particles are numbered from 0.

    Attributes:
        packing: centers, species, radii and box.
        law: None, which stands for soft disks.
        energy: of all particles [k length^2].
        stress: pressure tensor of the packing, compression positive, shape (2, 2) [k].
        pairs: numbers of particles that overlap, each pair once, shape (M, 2).
        residual: largest force on a particle over the mean contact force; 0 without contacts.
        stalled: the relaxation stopped before the tolerance.
        wall_pairs: numbers of particles that overlap with walls, and of these walls in
            `packing.walls`, shape (K, 2).
        strain: shear strain since the start of `shear`; None in other states.
    """

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
    def pressure(self) -> float:
        """Pressure of the packing, half the trace of `stress` [k]."""
        return float(np.trace(self.stress) / 2.0)

    @property
    def _contact_sides(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        i, j = self.pairs.T
        walled = self.wall_pairs[:, 0]
        return np.concatenate([i, j, walled]), np.concatenate([j, i, np.full_like(walled, -1)])

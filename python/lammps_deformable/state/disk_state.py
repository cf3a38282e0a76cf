"""A state of soft disks: a snapshot, which later steps do not change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .disk_contacts import chords, halves
from .pictures import Pictures
from .plane_analysis import PlaneAnalysis
from .soft_state import SoftState

if TYPE_CHECKING:
    from ..model.picture import Halves


@dataclass(frozen=True, eq=False, repr=False)
class DiskState(SoftState, PlaneAnalysis, Pictures):
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
        strain: shear strain of all calls of `shear`; None before the first one.
    """

    _NAMES: ClassVar[tuple[str, ...]] = ("filled_area", "particle_pressure", "rattlers")

    @property
    def filled_area(self) -> NDArray[np.float64]:
        """pi R^2 of each particle, shape (N,) [length^2]."""
        return np.pi * self.packing.radius**2

    def particle_values(self) -> dict[str, NDArray[Any]]:
        """Values of the disks by the names of a trajectory, arrays of shape (N,)."""
        i, _ = self._contact_sides
        return {
            "radius": self.packing.radius,
            "area": self.filled_area,
            "pressure": self.particle_pressure,
            "contacts": np.bincount(i, minlength=len(self.packing)),
            "rattler": self.rattlers.astype(int),
        }

    @property
    def outlines(self) -> list[NDArray[np.float64]]:
        """Circles, closed polygons of shape (m, 2) [length]."""
        return self.packing.outlines

    def _flats(self) -> list[list[NDArray[np.float64]]]:
        return chords(self.packing, self._contact_forces)

    def _halves(self) -> list[Halves]:
        return halves(self.packing, self._contact_forces)

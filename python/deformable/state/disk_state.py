"""A state of soft disks: a snapshot, which later steps do not change."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..core import disk_blocks
from ..model.neighbors import near_pairs
from .contact_forces import ContactForces
from .disk_contacts import chords, halves
from .hessian import Hessian
from .linear_response import LinearResponse
from .pictures import Pictures
from .plane_analysis import PlaneAnalysis
from .sides import Sides, bearing, between, by_centers, by_strains, joined, with_walls
from .soft_state import SoftState

if TYPE_CHECKING:
    from ..model.picture import Halves


@dataclass(frozen=True, eq=False, repr=False)
class DiskState(SoftState, LinearResponse, PlaneAnalysis, Pictures):
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

    wall_pairs: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 2), np.int64))

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

    def hessian(self, rattlers: bool = True) -> Hessian:
        """Second derivatives of the energy by the centers, and by strains.

        Each contact adds n n^T - (o/d) t t^T for its direction n and overlap o. The second part is
        the prestress.

        Args:
            rattlers: False leaves out the contacts of rattlers, which bear nothing; a contact that
                bears a thousandth of the mean contact force or more stays.
        """
        sides, contact, kept = self._overlaps()
        if not rattlers:
            sides, contact = sides.part(kept), contact[kept]
        x, y = sides.vector.T
        blocks = disk_blocks(x, y, sides.turn, contact)
        return Hessian(
            self.packing, blocks, by_centers(sides, len(self.packing)), by_strains(sides)
        )

    def rattler_contacts(self) -> tuple[Sides, NDArray[np.float64]]:
        """Contacts that `hessian(rattlers=False)` leaves out, and their overlaps."""
        sides, contact, kept = self._overlaps()
        return sides.part(~kept), (contact - sides.distance)[~kept]

    def _overlaps(self) -> tuple[Sides, NDArray[np.float64], NDArray[np.bool_]]:
        """Contacts, the distances at which they open, and whether they bear, all of them once."""
        packing, radius = self.packing, self.packing.radius
        i, j, shift = near_pairs(packing, 0.0)
        pairs = between(i, j, packing.positions[j] + shift - packing.positions[i])
        sides = joined(pairs, with_walls(packing, 0.0))
        contact = radius[sides.i] + np.where(sides.j < 0, 0.0, radius[sides.j])
        overlap, count = contact - sides.distance, len(i)
        both = np.append(overlap, overlap[:count])
        kept = bearing(np.append(sides.i, j), np.append(sides.j, i), both, len(packing))
        return sides, contact, kept[: len(contact)]

    @property
    def _contact_forces(self) -> ContactForces:
        sides, contact, _ = self._overlaps()
        overlap, wall = contact - sides.distance, sides.j < 0
        part = np.where(wall, 1.0, (self.packing.radius[sides.i] - 0.5 * overlap) / sides.distance)
        force = -(overlap / sides.distance)[:, None] * sides.vector
        return ContactForces(sides.i, sides.j, sides.vector, part, force)

    def _flats(self) -> list[list[NDArray[np.float64]]]:
        return chords(self.packing, self._contact_forces)

    def _halves(self) -> list[Halves]:
        return halves(self.packing, self._contact_forces)

    @property
    def _contact_sides(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        i, j = self.pairs.T
        walled = self.wall_pairs[:, 0]
        return np.concatenate([i, j, walled]), np.concatenate([j, i, np.full_like(walled, -1)])

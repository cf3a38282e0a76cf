"""Second derivatives of the energy of a state of soft disks or spheres, and its contacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..core import disk_blocks
from ..model.neighbors import near_pairs
from ..model.packing import Packing
from .contact_forces import ContactForces
from .hessian import Hessian
from .linear_response import LinearResponse
from .sides import Sides, bearing, between, by_centers, by_strains, joined, with_walls


class SoftResponse(LinearResponse):
    """Linear response of a `DiskState` or `SphereState`."""

    packing: Packing

    def hessian(self, rattlers: bool = True) -> Hessian:
        """Second derivatives of the energy by the centers, and by strains.

        Each contact adds n n^T - (o/d) (1 - n n^T) for its direction n and overlap o. The second
        part is the prestress.

        Args:
            rattlers: False leaves out the contacts of rattlers, which bear nothing; a contact that
                bears a thousandth of the mean contact force or more stays.

        Raises:
            ParameterError: spheres touch a cylinder, cone or post.
        """
        sides, contact, kept = self._overlaps()
        if not rattlers:
            sides, contact = sides.part(kept), contact[kept]
        if np.isnan(sides.turn).any():
            raise ParameterError(
                "second derivatives of soft spheres do not know cylinders, cones and posts: take "
                "other walls, or a state in which none touches one"
            )
        blocks = disk_blocks(sides.vector, sides.turn, contact)
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
        ends = np.append(sides.i, j), np.append(sides.j, i)
        kept = bearing(*ends, both, len(packing), packing.dimension)
        return sides, contact, kept[: len(contact)]

    @property
    def _contact_forces(self) -> ContactForces:
        sides, contact, _ = self._overlaps()
        overlap, wall = contact - sides.distance, sides.j < 0
        part = np.where(wall, 1.0, (self.packing.radius[sides.i] - 0.5 * overlap) / sides.distance)
        force = -(overlap / sides.distance)[:, None] * sides.vector
        return ContactForces(sides.i, sides.j, sides.vector, part, force)

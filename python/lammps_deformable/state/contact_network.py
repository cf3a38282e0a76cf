"""The contact network of a packing: its active contacts without those of rattlers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..common.validate import zero_or_more
from ..model.droplet import AnyLaw
from ..model.free_motions import free_motions
from ..model.lattice import lengths
from ..model.packing import Packing
from .contact_forces import ContactForces


def without_rattlers(
    i: NDArray[np.int64], j: NDArray[np.int64], number: int, at_most: int = 2
) -> NDArray[np.bool_]:
    """Whether contacts remain after rattlers are removed one after another, shape (M,).

    Args:
        i: particle of each side of a contact, shape (M,).
        j: its partner, -1 for a wall, shape (M,).
        number: of particles.
        at_most: contacts of a rattler.
    """
    remaining = np.ones(len(i), dtype=bool)
    while True:
        z = np.bincount(i[remaining], minlength=number)
        rigid = np.append(z > at_most, True)  # the last one is for walls, j = -1
        kept = remaining & rigid[i] & rigid[j]
        if (kept == remaining).all():
            return kept
        remaining = kept


class ContactNetwork(ABC):
    """Numbers of a state's contacts after rattlers are removed one after another.

    A rattler is a particle with fewer than three active contacts with other particles that are no
    rattlers, or with walls; in three dimensions with fewer than four. Where contacts rub, two hold
    a particle, and a rattler has fewer than two.
    """

    packing: Packing
    law: AnyLaw | None

    @property
    @abstractmethod
    def phi(self) -> float:
        """Packing fraction."""

    @property
    @abstractmethod
    def pressure(self) -> float:
        """Pressure of the packing."""

    def __repr__(self) -> str:
        soft = "soft disks" if self.packing.dimension == 2 else "soft spheres"
        law = soft if self.law is None else f"law {self.law!r}"
        numbers = f"phi = {self.phi:.4f}, pressure = {self.pressure:.3g}"
        return (
            f"<{type(self).__name__}: {len(self.packing)} particles, {law}, {numbers}, "
            f"z = {self.coordination:.2f}>"
        )

    @property
    @abstractmethod
    def _contact_sides(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Particle and partner of each side of an active contact, shape (M,); -1 is a wall."""

    @property
    @abstractmethod
    def _contact_forces(self) -> ContactForces:
        """All active contacts, each once."""

    @property
    def _rubs(self) -> bool:
        """Whether contacts have friction."""
        return False

    @property
    def _of_rattlers(self) -> int:
        """Contacts of a rattler at most."""
        return 1 if self._rubs else self.packing.dimension

    @cached_property
    def _in_network(self) -> NDArray[np.bool_]:
        """Whether each of `_contact_sides` belongs to a contact without a rattler."""
        return without_rattlers(*self._contact_sides, len(self.packing), self._of_rattlers)

    @property
    def network_degree(self) -> NDArray[np.int64]:
        """Number of network contacts of each particle, 0 of rattlers, shape (N,)."""
        particles = self._contact_sides[0][self._in_network]
        return np.bincount(particles, minlength=len(self.packing))

    @property
    def rattlers(self) -> NDArray[np.bool_]:
        """Particles with fewer than three active contacts with non-rattlers, shape (N,).

        In three dimensions with fewer than four, with friction with fewer than two.
        """
        return self.network_degree == 0

    @property
    def coordination(self) -> float:
        """Mean number z of network contacts of a particle that is no rattler; 0 without any."""
        rigid = int(np.sum(~self.rattlers))
        return float(np.sum(self._in_network) / rigid) if rigid else 0.0

    @property
    def network_contacts(self) -> int:
        """Number of active contacts without those of rattlers, each counted once."""
        wall = self._contact_sides[1][self._in_network] < 0
        return int(np.sum(wall) + np.sum(~wall) // 2)

    @property
    def isostatic_contacts(self) -> int:
        """Smallest number of contacts that supports a pressure, d N' - d + 1 in a periodic box.

        That is 2 N' - 1 in the plane, 3 N' - 2 in three dimensions. The N' particles that are not
        rattlers have d N' - m degrees of freedom; one more contact makes a state of self stress
        possible. m is the number of motions of all together that no
        wall resists: d without walls, 1 in a channel or a round container, else 0. The result is 0
        if all are rattlers.

        With friction particles turn, and a contact has two forces, f and f_t: it is the half of 3
        N' - 1 in a periodic box, and of 3 N' + 1 between walls, rounded up. Contacts that use all
        of their friction have one force only, so that each adds a half.
        """
        return self._isostatic(int(np.sum(~self.rattlers)))

    def _isostatic(self, rigid: int) -> int:
        dimension = self.packing.dimension
        if self._rubs:
            free = 0 if self.packing.walls else dimension
            return (3 * rigid + 2 - free) // 2 if rigid else 0
        free = free_motions(self.packing.walls, dimension)
        return max(dimension * rigid + 1 - free, 0) if rigid else 0

    def excess_coordination(self, threshold: float = 0.0) -> float:
        """z - z_iso: how many more contacts than an isostatic network a particle has.

            z - z_iso = 2 (network_contacts - isostatic_contacts) / N'

        for the N' particles that are no rattlers; 0 if all are. At the onset of jamming it is 0,
        up to a few contacts.

        Args:
            threshold: contacts count from this part of the mean contact force of the network on.
                Rattlers are then particles with too few contacts that count, and so on.

        Raises:
            ParameterError: the threshold is negative or no number.
        """
        contacts, size = self._contact_forces, (len(self.packing), self._of_rattlers)
        i, j, strength = contacts.i, contacts.j, lengths(contacts.force)
        kept = _network(i, j, *size)
        if zero_or_more("threshold", threshold) > 0.0 and kept.any():
            counts = strength >= threshold * strength[kept].mean()
            i, j = i[counts], j[counts]
            kept = _network(i, j, *size)
        i, j = i[kept], j[kept]
        rigid = len(np.unique(np.append(i, j[j >= 0])))
        return 2.0 * (len(i) - self._isostatic(rigid)) / rigid if rigid else 0.0


def _network(
    i: NDArray[np.int64], j: NDArray[np.int64], number: int, at_most: int
) -> NDArray[np.bool_]:
    """As `without_rattlers`, of contacts that are listed once."""
    pair = j >= 0
    sides = np.append(i, j[pair]), np.append(j, i[pair])
    return without_rattlers(*sides, number, at_most)[: len(i)]

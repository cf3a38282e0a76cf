"""What bears a packing: its contacts without those of rattlers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..common.renamed import FormerAttributes
from ..model.packing import Packing


def without_rattlers(i: NDArray[np.int64], j: NDArray[np.int64], number: int) -> NDArray[np.bool_]:
    """Which contacts are left once rattlers are taken out one after another, shape (M,).

    Args:
        i: particle of each side of a contact, shape (M,).
        j: its partner, -1 for a wall, shape (M,).
        number: of particles.
    """
    bonds = np.ones(len(i), dtype=bool)
    while True:
        z = np.bincount(i[bonds], minlength=number)
        held = np.append(z >= 3, True)  # walls, j = -1, are
        kept = bonds & held[i] & held[j]
        if (kept == bonds).all():
            return kept
        bonds = kept


class ContactNetwork(FormerAttributes, ABC):
    """Contacts of a state, counted once rattlers are taken out one after another.

    A rattler has fewer than three contacts with particles that are none.
    """

    _FORMER: ClassVar[dict[str, str]] = {
        "model": "law",
        "bearing_contacts": "network_contacts",
        "contacts_seen": "particle_contacts",
    }

    packing: Packing

    @property
    @abstractmethod
    def _ends(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Both ends of each bearing contact, as either side sees it; -1 is a wall."""

    @cached_property
    def _bonds(self) -> NDArray[np.bool_]:
        """Which contacts are left, one value for each of `_ends`."""
        return without_rattlers(*self._ends, len(self.packing))

    @property
    def rattlers(self) -> NDArray[np.bool_]:
        """Particles with fewer than three bearing contacts, rattlers not counted, shape (N,)."""
        return np.bincount(self._ends[0][self._bonds], minlength=len(self.packing)) == 0

    @property
    def coordination(self) -> float:
        """Mean number z of bearing contacts of the particles that are not rattlers; else 0."""
        held = int(np.sum(~self.rattlers))
        return float(np.sum(self._bonds) / held) if held else 0.0

    @property
    def network_contacts(self) -> int:
        """Number of bearing contacts, each counted once, those of rattlers left out."""
        wall = self._ends[1][self._bonds] < 0
        return int(np.sum(wall) + np.sum(~wall) // 2)

    @property
    def isostatic_contacts(self) -> int:
        """The fewest contacts that bear a pressure in a periodic box, 2 N' - 1; 0 without any.

        The N' particles that are not rattlers have 2 N' - 2 ways to move against each other; one
        contact more than these makes a state of stress.
        """
        return max(2 * int(np.sum(~self.rattlers)) - 1, 0)

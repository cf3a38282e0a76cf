"""Whether a packing that is loose was rigid before: it has lost its rigidity then."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..model.packing import Packing
from .relaxed_disks import relax_in_box

# Forces over those of contacts of a rigid start; rounding of phi.
BALANCED, _ROUNDING = 0.1, 1e-12


class Rigidity:
    """What relaxed states of a simulation tell, one after the other.

    Args:
        start: where the simulation started; None if that does not count.

    Attributes:
        start: the start, until the first state is relaxed.
        phi: packing fraction of the last rigid packing; infinite without.
    """

    def __init__(self, start: Packing | None) -> None:
        self.start, self.phi = start, np.inf

    def lost(self, phi: float, loose: bool, balanced: Callable[[Packing], bool]) -> bool:
        """Whether a packing is loose at this phi, and was rigid at this or a lower one.

        Args:
            phi: of the undeformed particles.
            loose: whether it is loose now.
            balanced: whether contact forces of the law about balance in a packing.
        """
        start, self.start = self.start, None  # what came before counts from the second state on
        dense = start is not None and loose and phi >= (1.0 - _ROUNDING) * start.phi
        if start and dense and (_holds_disks(start) or balanced(start)):
            self.phi = 0.0
        lost = loose and phi >= self.phi
        self.phi = np.inf if loose else phi
        return lost


def _holds_disks(packing: Packing) -> bool:
    """Whether forces of soft disks about balance, as in `jam`."""
    disks = relax_in_box(packing, np.inf, 0.0, lambda *_: None)  # at once: they do not move
    return disks.pressure > 0.0 and disks.residual <= BALANCED

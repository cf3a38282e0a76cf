"""Separation of particles that overlap too far."""

from __future__ import annotations

from dataclasses import replace

from ..common.errors import StalledWarning, collected, warn
from ..common.ranks import alone
from ..particles.laws import SoftContact, natural_pressure
from ..particles.packing import Packing
from .simulation import Simulation, relax_above

# Pressure of soft disks for `push_off`. It ends at forces of 1e-3 of this pressure times the
# smallest radius, far below those of disks at random positions.
_PUSHED_OFF = 1e-3


def push_off(packing: Packing) -> Packing:
    """See `Packing.push_off`."""
    bare = packing.replace(walls=[replace(wall, adhesion=0.0) for wall in packing.walls])
    sim = Simulation(bare, SoftContact(), comm=alone())
    with sim, collected(StalledWarning):  # with another text
        facet = float(packing.radii.min()) ** (packing.dimension - 1)  # about that of a contact
        pushed = relax_above(
            sim, 1e-3, _PUSHED_OFF * natural_pressure(packing, SoftContact()) * facet
        )
    if not pushed.converged:
        warn(
            f"separating the particles stalled: the largest force is {pushed.residual:.2g} of the "
            "mean contact force",
            StalledWarning,
        )
    return packing.replace(positions=pushed.packing.positions)

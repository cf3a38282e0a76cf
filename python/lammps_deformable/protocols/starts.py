"""Simulations that begin from a packing or a state, and a start without deep overlaps."""

from __future__ import annotations

import warnings

from mpi4py import MPI

from ..common.errors import StalledWarning
from ..common.validate import expect
from ..engine.disks import Disks
from ..engine.droplet_simulation import DropletSimulation
from ..engine.simulation import Simulation
from ..engine.spheres import Spheres
from ..model.droplet import AnyLaw, Droplet
from ..model.onset import natural_pressure
from ..model.packing import Packing
from ..state.disk_state import DiskState
from ..state.droplet_state import DropletState
from ..state.sphere_state import SphereState
from ..state.state import State

# Pressure of soft disks for `push_off`. It ends at forces of 1e-3 of this pressure times the
# smallest radius, far below those of disks at random positions.
_PUSHED_OFF = 1e-3


def push_off(packing: Packing) -> Packing:
    """Relax particles as soft disks or spheres, in their box, to reduce their overlaps.

    Particles at random positions overlap too deeply for contacts in front of their centers. Soft
    ones have no such limit. The result is a start for `Simulation`, at any packing fraction.

    Args:
        packing: e.g. from `bidisperse`, with any overlaps; or from `Packing.between`, its walls
            repel the particles.

    Returns:
        The packing with balanced forces between soft particles.

    Warns:
        StalledWarning: the forces are not balanced.
    """
    expect("packing", packing, Packing)
    with soft(packing) as disks, warnings.catch_warnings():
        warnings.simplefilter("ignore", StalledWarning)  # with another text
        facet = float(packing.radius.min()) ** (packing.dimension - 1)  # about that of a contact
        pushed = disks.relax(1e-3, _PUSHED_OFF * natural_pressure(packing, None) * facet)
    if pushed.stalled:
        warnings.warn(
            f"separating the particles stalled: the largest force is {pushed.residual:.2g} of the "
            "mean contact force",
            StalledWarning,
            stacklevel=2,
        )
    return pushed.packing


def soft(packing: Packing) -> Disks | Spheres:
    """Soft disks, or spheres."""
    return Disks(packing) if packing.dimension == 2 else Spheres(packing)


def simulate(
    start: Packing | State | DropletState | DiskState | SphereState,
    law: AnyLaw | None,
    comm: MPI.Comm = MPI.COMM_SELF,
) -> Disks | Spheres | Simulation | DropletSimulation:
    """A simulation of a contact law, or of soft disks or spheres, which no ranks share."""
    if law is None or isinstance(start, (DiskState, SphereState)):
        return soft(start if isinstance(start, Packing) else start.packing)
    if isinstance(law, Droplet) and not isinstance(start, State):
        return DropletSimulation(start, law, comm)
    return Simulation(start, law, comm)  # type: ignore[arg-type]

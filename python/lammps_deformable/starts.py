"""Simulations that begin from a packing or a state, and a start without deep overlaps.

Packings whose box has found its shape: they are stable against shear too.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

from mpi4py import MPI

from ._checks import expect
from .errors import StalledWarning, UnjammedWarning
from .laws import AnyLaw, Droplet, excess_phi, natural_pressure, pressure_above_onset
from .packing import Packing
from .relax import TOLERANCE
from .simulation import DropletSimulation, Simulation
from .soft_disks import Disks, Report, Spheres
from .state import DiskState, DropletState, SphereState, State

if TYPE_CHECKING:
    from .free_box import Stressed

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
        facet = float(packing.radii.min()) ** (packing.dimension - 1)  # about that of a contact
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


# The shape is found at this phi - phi_J first, where hardly any contacts change, and then at ever
# lower ones, by this factor. Near the onset a shear changes contacts all the way.
_FAR, _FACTOR = 0.01, 0.1


def stabilized(
    packing: Packing,
    law: AnyLaw | None,
    pressure: float,
    tolerance: float,
    box: str,
    comm: MPI.Comm | None,
    report: Report,
) -> Stressed:
    """The packing relaxed at a pressure near the onset, with a free box.

    Args:
        packing: jammed, or nearly.
        law: of the particles; soft disks or spheres if None.
        pressure: in natural units.
        tolerance: of the relaxation at this pressure; at most that of `relax` is taken.
        box: what is free, see `Simulation.relax`.
        comm: ranks that share the relaxation of deformable particles.
        report: called after each relaxation, with the pressure in natural units.
    """
    target, unit = excess_phi(pressure, packing, law), natural_pressure(packing, law)
    sim = simulate(packing, law, comm or MPI.COMM_SELF)
    excess = max(target, _FAR)
    state: Stressed
    with sim, warnings.catch_warnings():
        warnings.simplefilter("ignore", UnjammedWarning)  # of the start, before it is compressed
        while excess > target:
            state = sim.relax(pressure=pressure_above_onset(excess, packing, law) * unit, box=box)
            report(1, state.phi, state.pressure / unit, state.residual)
            excess = max(_FACTOR * excess, target)
        state = sim.relax(min(tolerance, TOLERANCE), pressure=pressure * unit, box=box)
        report(1, state.phi, state.pressure / unit, state.residual)
        return state

"""Simulations that begin from a packing or a state, and a start without deep overlaps.

Packings whose box has found its shape: they are stable against shear too.
"""

from __future__ import annotations

import warnings

from mpi4py import MPI

from ._checks import expect
from .errors import StalledWarning, UnjammedWarning
from .laws import Jamming, SoftContact, excess_phi, natural_pressure, pressure_above_onset
from .packing import Packing
from .relax import TOLERANCE
from .simulation import Simulation
from .soft_disks import Report
from .state import State

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
    sim = Simulation(packing, SoftContact(), comm=MPI.COMM_SELF)
    with sim, warnings.catch_warnings():
        warnings.simplefilter("ignore", StalledWarning)  # with another text
        facet = float(packing.radii.min()) ** (packing.dimension - 1)  # about that of a contact
        pushed = sim._relax(1e-3, _PUSHED_OFF * natural_pressure(packing, SoftContact()) * facet)
    if not pushed.converged:
        warnings.warn(
            f"separating the particles stalled: the largest force is {pushed.residual:.2g} of the "
            "mean contact force",
            StalledWarning,
            stacklevel=2,
        )
    return pushed.packing


# The shape is found at this phi - phi_J first, where hardly any contacts change, and then at ever
# lower ones, by this factor. Near the onset a shear changes contacts all the way.
_FAR, _FACTOR = 0.01, 0.1


def stabilized(
    packing: Packing,
    law: Jamming,
    pressure: float,
    tolerance: float,
    free: str,
    comm: MPI.Comm | None,
    report: Report,
) -> State:
    """The packing relaxed at a pressure near the onset, with a free box.

    Args:
        packing: jammed, or nearly.
        law: of the particles.
        pressure: in natural units.
        tolerance: of the relaxation at this pressure; at most that of `relax` is taken.
        free: what is free, see `Simulation.relax`.
        comm: ranks that share the relaxation of deformable particles.
        report: called after each relaxation, with the pressure in natural units.
    """
    target, unit = excess_phi(pressure, packing, law), natural_pressure(packing, law)
    sim = Simulation(packing, law, comm=comm or MPI.COMM_SELF)
    excess = max(target, _FAR)
    with sim, warnings.catch_warnings():
        warnings.simplefilter("ignore", UnjammedWarning)  # of the start, before it is compressed
        while excess > target:
            state = sim.relax(pressure=pressure_above_onset(excess, packing, law) * unit, free=free)
            report(1, state.phi, state.pressure / unit, state.residual)
            excess = max(_FACTOR * excess, target)
        state = sim.relax(min(tolerance, TOLERANCE), pressure=pressure * unit, free=free)
        report(1, state.phi, state.pressure / unit, state.residual)
        return state

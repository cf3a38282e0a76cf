"""Packings whose box has found its shape: they are stable against shear too."""

from __future__ import annotations

import warnings

from mpi4py import MPI

from ..common.errors import UnjammedWarning
from ..engine.free_box import Stressed
from ..engine.relaxation import TOLERANCE
from ..engine.relaxed_disks import Report
from ..model.droplet import AnyLaw
from ..model.onset import excess_phi, natural_pressure, pressure_above_onset
from ..model.packing import Packing
from .starts import simulate

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

"""Simulations whose balanced contacts are right to rounding."""

from __future__ import annotations

from mpi4py import MPI

from ..io.lammps_commands import close_balance_command
from ..model.laws import Law
from ..model.packing import Packing
from .disks import Disks
from .followed import setup
from .lammps import run
from .simulation import Simulation


def closely_balanced(packing: Packing, law: Law | None) -> Disks | Simulation:
    """A simulation on this rank alone, whose contacts are balanced to rounding; None: disks."""
    if law is None:
        return Disks(packing)
    sim = Simulation(packing, law, MPI.COMM_SELF)
    run(sim.lmp, close_balance_command(packing, law))
    sim._setup = setup(sim.lmp)  # which knows the former command
    return sim

"""Simulations whose contacts are balanced more or less closely than to 1e-8."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from mpi4py import MPI

from ..io.lammps_commands import balance_command
from ..model.laws import Law
from ..model.packing import Packing
from .deforming import Deforming
from .disks import Disks
from .followed import setup
from .lammps import run
from .simulation import Simulation

# The default of the pair style, and what rounding leaves.
_USUAL, _CLOSE = 1e-8, 1e-13

# Imbalance over a strain at which contacts still follow it: forces change by about the strain.
_OF_STRAIN = 1e-4


def closely_balanced(packing: Packing, law: Law | None) -> Disks | Simulation:
    """A simulation on this rank alone, whose contacts are balanced to rounding; None: disks."""
    if law is None:
        return Disks(packing)
    sim = Simulation(packing, law, MPI.COMM_SELF)
    _balance(sim, packing, _CLOSE)
    return sim


def imbalance_under(strain: float) -> float:
    """Imbalance with which contacts follow a strain from a state to the next one."""
    return min(_USUAL, max(_CLOSE, _OF_STRAIN * strain))


@contextmanager
def balanced_to(sim: Deforming[Any], packing: Packing, tolerance: float | None) -> Iterator[None]:
    """Leave this imbalance to the contacts of a simulation meanwhile; None: the usual one."""
    lmp, other = sim.lmp, tolerance not in (None, _USUAL)
    if tolerance is not None and other:
        _balance(sim, packing, tolerance)
    try:
        yield
    finally:
        if other and not sim.closed and sim.lmp is lmp:
            _balance(sim, packing, _USUAL)


def _balance(sim: Deforming[Any], packing: Packing, tolerance: float) -> None:
    run(sim.lmp, balance_command(packing, sim.law, tolerance))
    # which knows the former command
    sim._setup = replace(sim._setup, definition=setup(sim.lmp).definition)

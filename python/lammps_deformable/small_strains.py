"""Simulations whose contacts are balanced more or less closely than to 1e-8.

Small strains: contacts and forces balanced relative to them, and errors of what is left.
"""

from __future__ import annotations

from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI

from .commands import balance_command
from .lammps import run, setup
from .simulation import Deforming, Simulation
from .soft_disks import Disks

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .laws import Law
    from .packing import Packing
    from .state import DiskState, DropletState, SphereState, State

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
    begun, other = sim._begun, tolerance not in (None, _USUAL)
    if tolerance is not None and other:
        _balance(sim, packing, tolerance)
    try:
        yield
    finally:
        if other and not sim.closed and sim._begun == begun:
            _balance(sim, packing, _USUAL)


def _balance(sim: Deforming[Any], packing: Packing, tolerance: float) -> None:
    run(sim.lmp, balance_command(packing, sim.law, tolerance))
    # which knows the former command
    sim._setup = replace(sim._setup, definition=setup(sim.lmp).definition)


# Tolerance of relaxations over the strain, and the closest one.
_TOLERANCE_OF_STRAIN, _CLOSEST = 1e-4, 1e-11


def tolerance_under(strain: float, most: float) -> float:
    """Of relaxations after a strain, at most this one: forces that remain are an error of stress.

    The same tolerance for a strain that is not small.
    """
    return min(most, max(_CLOSEST, _TOLERANCE_OF_STRAIN * strain))


def following(sim: Any, packing: Packing, strain: float) -> AbstractContextManager[None]:
    """Let contacts of a simulation of a packing follow strains as small as this one meanwhile."""
    if not isinstance(sim, Deforming):
        return nullcontext()
    return balanced_to(sim, packing, imbalance_under(strain))


def unbalanced_modulus(
    state: State | DropletState | DiskState | SphereState, part: float, strain: float
) -> float:
    """Error of a modulus about, part sum |F_c| d_c / (d V strain) [energy/length^d].

    Args:
        state: with forces F_c and distances d_c of contacts, in the room V.
        part: of the contact forces that is not balanced.
        strain: of which the stress is measured.
    """
    contacts, box = state._contact_forces, state.packing.box
    pressure = np.sum(np.abs(contacts.push) * contacts.distance) / (len(box) * np.linalg.det(box))
    return part * float(pressure) / strain

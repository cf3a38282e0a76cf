"""Small strains: contacts and forces balanced relative to them, and errors of what is left."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from typing import Any

import numpy as np

from ..engine.close_balance import balanced_to, imbalance_under
from ..engine.deforming import Deforming
from ..model.packing import Packing
from ..state.disk_state import DiskState
from ..state.droplet_state import DropletState
from ..state.sphere_state import SphereState
from ..state.state import State

# Tolerance of relaxations over the strain, and the closest one.
_OF_STRAIN, _CLOSEST = 1e-4, 1e-11


def tolerance_under(strain: float, most: float) -> float:
    """Of relaxations after a strain, at most this one: forces that remain are an error of stress.

    The same tolerance for a strain that is not small.
    """
    return min(most, max(_CLOSEST, _OF_STRAIN * strain))


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

"""Small strains: contacts and forces balanced relative to them, and errors of what is left."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .polishing import CLOSE, USUAL, balanced_to

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from .packing import Packing
    from .simulation import Simulation
    from .state import State

# Imbalance over a strain at which contacts still follow it: forces change by about the strain.
_OF_STRAIN = 1e-4


def imbalance_under(strain: float) -> float:
    """Imbalance with which contacts follow a strain from a state to the next one."""
    return min(USUAL, max(CLOSE, _OF_STRAIN * strain))


# Tolerance of relaxations over the strain, and the closest one.
_TOLERANCE_OF_STRAIN, _CLOSEST = 1e-4, 1e-11


def tolerance_under(strain: float, most: float) -> float:
    """Of relaxations after a strain, at most this one: forces that remain are an error of stress.

    The same tolerance for a strain that is not small.
    """
    return min(most, max(_CLOSEST, _TOLERANCE_OF_STRAIN * strain))


def following(sim: Simulation, packing: Packing, strain: float) -> AbstractContextManager[None]:
    """Let contacts of a simulation of a packing follow strains as small as this one meanwhile."""
    return balanced_to(sim, packing, imbalance_under(strain))


def unbalanced_modulus(state: State, part: float, strain: float) -> float:
    """Error of a modulus about, part sum |F_c| d_c / (d V strain) [energy/length^d].

    Args:
        state: with forces F_c and distances d_c of contacts, in the room V.
        part: of the contact forces that is not balanced.
        strain: of which the stress is measured.
    """
    contacts, box = state._contact_forces, state.packing.box
    pressure = np.sum(np.abs(contacts.push) * contacts.distance) / (len(box) * np.linalg.det(box))
    return part * float(pressure) / strain

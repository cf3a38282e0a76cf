"""Warnings of a relaxed state of deformable particles."""

from __future__ import annotations

import warnings

from ..common.errors import BeyondModelWarning, StalledWarning, UnjammedWarning
from ..model.droplet import LARGEST_FACET, LARGEST_LOAD
from ..model.laws import Ring
from ..model.sticking import sticks
from ..state.droplet_state import DeformedState, DropletState
from .relaxation import largest_force_told

# Below this part of the mean contact force what stalls may be the balance of contacts, to 1e-8 of
# the largest force: dense packings amplify that in the forces on particles.
_FINE = 1e-6


def warn_of(state: DeformedState, tolerance: float, unjammed: bool) -> None:
    """Warn the caller of `relax` if its state is loose, has stalled, or is beyond the model.

    Args:
        state: relaxed.
        tolerance: of the relaxation.
        unjammed: whether the packing was rigid before, and no longer is.
    """
    if not state.root:
        return
    if unjammed:
        warnings.warn(
            f"the packing lost its rigidity at phi = {state.packing.phi:.5f}: it rearranged into a "
            "loose one",
            UnjammedWarning,
            stacklevel=4,
        )
    if state.stalled:
        why = "the contacts do not balance, so that forces are not known"
        if state.residual > tolerance:
            why = largest_force_told(state.residual, "the mean contact force", tolerance)
            slides = isinstance(state.law, Ring) and not sticks(state.law, state.packing.walls)
            if state.residual < _FINE and slides:
                why += ": contacts are balanced to 1e-8, `polish` goes further"
        warnings.warn(
            f"relaxation stalled at phi = {state.phi:.5f}: {why}",
            StalledWarning,
            stacklevel=4,
        )
    if state.beyond:
        warnings.warn(
            f"{state.beyond} of {len(state.packing)} {_beyond(state)}",
            BeyondModelWarning,
            stacklevel=4,
        )


def _beyond(state: DeformedState) -> str:
    """What is beyond the model, and what that means."""
    if isinstance(state, DropletState):
        return (
            f"droplets are beyond the model at phi = {state.phi:.5f}: their load is above "
            f"{LARGEST_LOAD:g}, or that of few strong contacts above {LARGEST_FACET:g} each, the "
            f"largest {state.load.max():.2g}, so that pressures are off by more than ten per cent"
        )
    return (
        f"particles are beyond the model at phi = {state.phi:.5f}: their outlines have a negative "
        "radius of curvature, as past confluence; their energy and forces continue the law without "
        "a known error"
    )

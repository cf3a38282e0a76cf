"""Particles that vanish: the state of those that are left, who keep their labels."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .commands import Films
    from .state import State


def labels_of(state: State) -> NDArray[np.int64]:
    """The labels of particles, their numbers as long as none vanished, shape (N,)."""
    return np.arange(len(state.packing)) if state.labels is None else state.labels


def remaining(state: State, left: NDArray[np.bool_]) -> State:
    """The state without some particles, from which a simulation may start.

    Args:
        state: of all particles, without friction.
        left: which stay, shape (N,).
    """
    if left.all():
        return state
    packing = state.packing
    part = packing.replace(
        positions=packing.positions[left],
        radii=packing.radii[left],
        species=packing.species[left],
    )
    part._set_species_radii(len(packing._species_radii))  # of which some may have none left
    images, directions = state.images, state.directions
    return replace(
        state,
        packing=part,
        velocities=state.velocities[left],
        images=None if images is None else images[left],
        directions=None if directions is None else directions[left],
        labels=labels_of(state)[left],
        films=_films_of(state.films, left),
    )


def _films_of(films: Films | None, left: NDArray[np.bool_]) -> Films | None:
    """The films between particles that are left, with their new IDs; codes of walls stay."""
    if films is None:
        return None
    number = np.append(0, np.cumsum(left) * left)  # by the ID, 0 of particles that are gone
    found = np.where(films > 0, number[np.maximum(films, 0)], films)
    return found[(found != 0).all(axis=1)]

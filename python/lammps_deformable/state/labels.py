"""Particles that vanish or divide: the state of those that are there then, by their labels.

A particle keeps its label as long as it is there. Where it divides, one of the two keeps it, and
the other has one that no particle had before. Both are of the same clone, the label of the first
ancestor.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..particles.packing import with_species

if TYPE_CHECKING:
    from ..particles.commands import Films
    from .state import State


def labels_of(state: State) -> NDArray[np.int64]:
    """The labels of particles, their numbers as long as none vanished, shape (N,)."""
    return np.arange(len(state.packing)) if state.labels is None else state.labels


def clones_of(state: State) -> NDArray[np.int64]:
    """The label of the first ancestor of each particle, shape (N,)."""
    return labels_of(state) if state.clones is None else state.clones


def remaining(state: State, left: NDArray[np.bool_]) -> State:
    """The state without some particles, from which a simulation may start.

    Args:
        state: of all particles, without friction.
        left: which stay, shape (N,).
    """
    if left.all():
        return state
    packing = state.packing
    part = with_species(
        packing,
        len(packing.species_radii),
        positions=packing.positions[left],
        radii=packing.radii[left],
        species=packing.species[left],
    )
    images, directions = state.images, state.directions
    return replace(
        state,
        packing=part,
        velocities=state.velocities[left],
        images=None if images is None else images[left],
        directions=None if directions is None else directions[left],
        labels=labels_of(state)[left],
        clones=None if state.clones is None else state.clones[left],
        films=_films_of(state.films, left),
    )


def divided(
    state: State,
    mothers: NDArray[np.int64],
    axes: NDArray[np.float64],
    share: NDArray[np.float64],
    label: int,
) -> State:
    """The state in which particles are two each, side by side, of the same center of mass.

    Args:
        state: of all particles, without friction.
        mothers: those that divide, shape (M,).
        axes: unit vectors from the second to the first of the two, shape (M, d).
        share: of the volume that the first one has, shape (M,).
        label: of the first new particle; further ones follow.
    """
    packing = state.packing
    radius, center = packing.radii[mothers], packing.positions[mothers]
    first, second, apart = core.daughters(radius, share, packing.dimension)
    positions, radii = packing.positions.copy(), packing.radii.copy()
    positions[mothers] = center + ((1.0 - share) * apart)[:, None] * axes
    radii[mothers] = first
    new = label + np.arange(len(mothers))
    images, directions = state.images, state.directions
    # each particle, and for each that divides a second one at the end
    from_mothers = np.append(np.arange(len(packing)), mothers)
    both = with_species(
        packing,
        len(packing.species_radii),
        positions=np.concatenate([positions, center - (share * apart)[:, None] * axes]),
        radii=np.append(radii, second),
        species=packing.species[from_mothers],
    )
    return replace(
        state,
        packing=both,
        velocities=state.velocities[from_mothers],
        images=None if images is None else images[from_mothers],
        directions=None if directions is None else directions[from_mothers],
        labels=np.append(labels_of(state), new),
        clones=clones_of(state)[from_mothers],
    )


def _films_of(films: Films | None, left: NDArray[np.bool_]) -> Films | None:
    """The films between particles that are left, with their new IDs; codes of walls stay."""
    if films is None:
        return None
    number = np.append(0, np.cumsum(left) * left)  # by the ID, 0 of particles that are gone
    found = np.where(films > 0, number[np.maximum(films, 0)], films)
    return found[(found != 0).all(axis=1)]

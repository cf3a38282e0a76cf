"""Motions of all particles together that no wall resists: translations and rotations."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from .room import closed
from .wall_base import Round
from .walls import Cone, Cylinder, Plane, Post, Wall

Floats = NDArray[np.float64]

# Parts of a motion that are rounding.
_ROUNDING = 1e-9


def free_motions(walls: Sequence[Wall], dimension: int = 2) -> int:
    """Number of motions of all particles together that no wall resists."""
    return len(_free(walls, dimension))


def motions(walls: Sequence[Wall], positions: Floats) -> Floats:
    """These motions, of particles at N positions, shape (`free_motions`, N, d)."""
    dimension = positions.shape[1]
    found = _free(walls, dimension)
    turns = _turned(positions)
    return found[:, None, :dimension] + np.einsum("mk,nak->mna", found[:, dimension:], turns)


def _free(walls: Sequence[Wall], dimension: int) -> Floats:
    """Motions as rows: a translation, and a turn in each plane of two axes.

    A motion moves all particles from x to x + t + W x, with an antisymmetric matrix W. What walls
    and periodic images forbid is linear in t and W.
    """
    parts = np.eye(dimension + dimension * (dimension - 1) // 2)
    if not walls:
        return parts[:dimension]
    periodic = np.eye(dimension)[~np.array(closed(walls, dimension))]
    forbidden = [_turns(axis) for axis in periodic]
    for wall in walls:
        forbidden += _forbidden(wall)
    rows = np.concatenate(forbidden)
    _, sizes, directions = np.linalg.svd(rows)
    found: Floats = directions[int(np.sum(sizes > _ROUNDING * sizes.max())) :]
    return found


def _forbidden(wall: Wall) -> list[Floats]:
    """Rows that vanish for a motion that moves a wall within itself."""
    if isinstance(wall, Plane):
        normal = np.array(wall.normal) / np.linalg.norm(wall.normal)
        return [_turns(normal), normal[None] @ _moves(np.array(wall.point))]
    if isinstance(wall, (Cylinder, Post)):
        return [_turns(np.array(wall.direction)), _moves(wall.middle)[list(wall.round_axes)]]
    if isinstance(wall, Cone):
        return [_turns(np.array(wall.direction)), _moves(wall.middle)]
    if isinstance(wall, Round):
        return [_moves(wall.middle)]
    return [np.eye(3)]  # of one with corners, in the plane


def _turned(x: Floats) -> Floats:
    """W x for a turn in each plane, shape (..., d, turns)."""
    dimension = x.shape[-1]
    found = [np.zeros_like(x) for _ in combinations(range(dimension), 2)]
    for each, (a, b) in zip(found, combinations(range(dimension), 2), strict=True):
        each[..., a], each[..., b] = -x[..., b], x[..., a]
    return np.stack(found, axis=-1)


def _turns(direction: Floats) -> Floats:
    """Change of a direction by each part of a motion, shape (d, parts)."""
    return np.hstack([np.zeros((len(direction),) * 2), _turned(direction)])


def _moves(place: Floats) -> Floats:
    """Change of a place by each part of a motion, shape (d, parts)."""
    return np.hstack([np.eye(len(place)), _turned(place)])

"""Lines that show the ends of a room in space: edges of planes, rims of tubes, round outlines."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, combinations

import numpy as np
from numpy.typing import NDArray

from .lattice import lengths
from .room import bounds, closed, corners_between, half_spaces_between
from .walls import Cylinder, Sphere, Wall

Floats = NDArray[np.float64]

# Points of a circle.
_POINTS = 120

# Corners are on a plane up to this part of the size of the room.
_ON = 1e-9


def lines_around(walls: Sequence[Wall], box: Floats, viewer: Floats) -> list[Floats]:
    """Edges of the room and of the periodic box, as lines of shape (n, 3) [length].

    Args:
        walls: in space; obstacles have no lines.
        box: lattice vectors as rows, shape (3, 3) [length].
        viewer: unit vector to the viewer, who sees outlines of spheres and tubes.
    """
    if not any(closed(walls, 3)):
        corners = np.array(np.meshgrid(*[(0.0, 1.0)] * 3)).T.reshape(-1, 3)
        pairs = combinations(corners, 2)
        return [np.stack(ends) @ box for ends in pairs if np.abs(np.subtract(*ends)).sum() == 1.0]
    outlines = [_outline(wall, walls, box, viewer) for wall in walls]
    return [*_edges(walls, box), *chain.from_iterable(outlines)]


def _edges(walls: Sequence[Wall], box: Floats) -> list[Floats]:
    """Where two flat ends meet."""
    corners = corners_between(walls, box)
    flat = [wall for wall in walls if not wall.round_axes]
    normals, offsets = half_spaces_between(flat, box, closed(walls, 3))
    if not len(normals):
        return []
    on = np.abs(corners @ normals.T - offsets) <= _ON * np.ptp(corners, axis=0).max()
    found = []
    for i, j in combinations(range(len(normals)), 2):
        both = corners[on[:, i] & on[:, j]]
        along = both @ np.cross(normals[i], normals[j])
        if len(both) > 1 and np.ptp(along) > _ON * np.abs(along).max():
            found.append(both[[along.argmin(), along.argmax()]])
    return found


def _outline(wall: Wall, walls: Sequence[Wall], box: Floats, viewer: Floats) -> list[Floats]:
    """Of a round container, as the viewer sees it."""
    if isinstance(wall, Sphere):
        return [wall.middle + wall.radius * _circle(viewer)]
    if not isinstance(wall, Cylinder):
        return []
    axis, middle = np.array(wall.direction), wall.middle
    ends = [middle + axis * (end - middle) for end in bounds(walls, box)]
    lines = [end + wall.radius * _circle(axis) for end in ends]
    side = np.cross(axis, viewer)
    if (size := float(lengths(side))) > _ON:
        shift = wall.radius / size * side
        lines += [np.stack(ends) + shift, np.stack(ends) - shift]
    return lines


def _circle(axis: Floats) -> Floats:
    """A circle around an axis, of radius 1."""
    first = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    first /= lengths(first)
    angle = np.linspace(0.0, 2.0 * np.pi, _POINTS)[:, None]
    return np.cos(angle) * first + np.sin(angle) * np.cross(axis, first)

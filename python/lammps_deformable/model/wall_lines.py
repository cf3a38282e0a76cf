"""Lines that show walls in space: edges of planes, rims of cones and tubes, round outlines."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, combinations

import numpy as np
from numpy.typing import NDArray

from .distances import Distances
from .lattice import fractional, lengths
from .room import bounds, closed, corners_between, half_spaces_between
from .walls import Cone, Cylinder, Post, Sphere, Wall

Floats = NDArray[np.float64]

# Points of a circle, and of a side, which may end where another wall begins.
_POINTS, _OF_A_SIDE = 120, 1000

# Corners are on a plane up to this part of the size of the room.
_ON = 1e-9


def lines_around(walls: Sequence[Wall], box: Floats, viewer: Floats) -> list[Floats]:
    """Edges of the room and of the periodic box, as lines of shape (n, 3) [length].

    Args:
        walls: in space; balls have no lines.
        box: lattice vectors as rows, shape (3, 3) [length].
        viewer: unit vector to the viewer, who sees outlines of round walls.
    """
    outlines = [_outline(wall, walls, box, viewer) for wall in walls]
    return [*_edges(walls, box), *chain.from_iterable(outlines)]


def _edges(walls: Sequence[Wall], box: Floats) -> list[Floats]:
    """Of the box, or where two flat ends meet."""
    if not any(closed(walls, 3)):
        ends = np.array(np.meshgrid(*[(0.0, 1.0)] * 3)).T.reshape(-1, 3)
        pairs = combinations(ends, 2)
        return [np.stack(both) @ box for both in pairs if np.abs(np.subtract(*both)).sum() == 1.0]
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
    """Of a round wall, as the viewer sees it, as far as it is in the room."""
    if isinstance(wall, Sphere):
        lines = [wall.middle + wall.radius * _circle(viewer)]
    elif isinstance(wall, (Cylinder, Post, Cone)):
        lines = _around_axis(wall, walls, box, viewer)
    else:
        return []
    others = [each for each in walls if each is not wall and not each.is_obstacle]
    return list(chain.from_iterable(_within(others, box, line) for line in lines))


def _around_axis(
    wall: Cylinder | Post | Cone, walls: Sequence[Wall], box: Floats, viewer: Floats
) -> list[Floats]:
    """Rims at the ends of the room, and both sides where the viewer sees it end."""
    axis, middle = np.array(wall.direction), wall.middle
    if isinstance(wall, Post):  # the image in the box
        cell = np.where(closed(walls, 3), 0.0, np.floor(fractional(middle, box)))
        middle = middle - cell @ box
    ends = [middle + axis * (end - middle) for end in bounds(walls, box)]
    slope, radii = 0.0, [wall.radius] * 2
    if isinstance(wall, Cone):
        slope, radii = wall.slope, [wall.radius_at(float(end[2])) for end in ends]
    lines = [end + radius * _circle(axis) for end, radius in zip(ends, radii, strict=True)]
    # The normal of a side, its direction u minus slope times the axis, is across the view.
    beside = viewer - (viewer @ axis) * axis
    steep, size = slope * float(viewer @ axis), float(lengths(beside))
    if size > max(_ON, abs(steep)):
        toward, part = beside / size, steep / size
        for sign in (-1.0, 1.0):
            u = part * toward + sign * np.sqrt(1.0 - part**2) * np.cross(axis, toward)
            low, high = (end + radius * u for end, radius in zip(ends, radii, strict=True))
            lines.append(low + np.linspace(0.0, 1.0, _OF_A_SIDE)[:, None] * (high - low))
    return lines


def _within(walls: Sequence[Wall], box: Floats, line: Floats) -> list[Floats]:
    """The parts of a line in the room between walls."""
    _, distances = Distances(walls, box)(line)
    inside = (distances >= -_ON * np.abs(box).max()).all(axis=0)
    cuts = np.flatnonzero(np.diff(inside)) + 1
    return [part for part in np.split(line, cuts)[int(not inside[0]) :: 2] if len(part) > 1]


def _circle(axis: Floats) -> Floats:
    """A circle around an axis, of radius 1."""
    first = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    first /= lengths(first)
    angle = np.linspace(0.0, 2.0 * np.pi, _POINTS)[:, None]
    return np.cos(angle) * first + np.sin(angle) * np.cross(axis, first)

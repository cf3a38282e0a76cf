"""The room that walls leave to particles: where it ends, and boxes that go with it.

A direction in which a container ends is *closed*: the box is not periodic along it, and is as long
as the container. Obstacles repeat with the box along the other directions.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from .corners import ROUNDING, are_open, corners_of
from .walls import Plane, Post, Wall

# Round walls stay round: factors along the axes agree up to this.
_SAME = 1e-9

Floats = NDArray[np.float64]


def closed(walls: Sequence[Wall], dimension: int = 2) -> tuple[bool, ...]:
    """Whether walls close each direction."""
    shares = [np.abs(n) for wall in walls for n, _ in wall.half_spaces()]
    if not shares:
        return (False,) * dimension
    return tuple((np.max(shares, axis=0) > ROUNDING).tolist())


def bounds(walls: Sequence[Wall], box: Floats) -> Floats:
    """Lowest and highest corner of the room, as rows, shape (2, d) [length].

    In a direction that is not closed, the room goes from 0 to the length of the box.

    Raises:
        ParameterError: the container is open, or leaves no room, or the box is tilted.
    """
    ends = np.array([np.zeros(len(box)), box.diagonal()])
    shut = closed(walls, len(box))
    if not any(shut):
        return ends
    tilts = box[np.tril_indices(len(box), -1)]
    if tilts.any():
        raise ParameterError(
            f"a box with a container must be rectangular, not tilted by {tilts[tilts != 0.0][0]:g}"
        )
    corners = corners_between(walls, box)
    return np.where(shut, [corners.min(axis=0), corners.max(axis=0)], ends)


def box_between(walls: Sequence[Wall], box: Floats) -> Floats:
    """The box with the length of the container along closed directions, shape (d, d) [length]."""
    if not any(closed(walls, len(box))):
        return box
    low, high = bounds(walls, box)
    return np.diag(high - low)


def corners_between(walls: Sequence[Wall], box: Floats, around: float = 1.0) -> Floats:
    """Corners of the container within the periodic box, shape (n, d) [length].

    Args:
        walls: round ones count as squares or cubes around them.
        box: lattice vectors as rows.
        around: factor by which these are larger.

    Raises:
        ParameterError: the container is open, or leaves no room.
    """
    dimension = len(box)
    normals, offsets = half_spaces_between(walls, box, closed(walls, dimension), around)
    if are_open(normals):
        four = "`rectangle` has four" if dimension == 2 else "`cuboid` has six"
        raise ParameterError(f"the planes leave the room open: add planes that enclose it ({four})")
    corners = corners_of(normals, offsets)
    if len(corners) <= dimension or np.ptp(corners, axis=0).min() <= 0.0:
        others = "circles" if dimension == 2 else "round walls"
        raise ParameterError(
            f"planes and {others} leave no room: a plane's normal must point to the particles"
        )
    return corners


def half_spaces_between(
    walls: Sequence[Wall], box: Floats, shut: Sequence[bool], around: float = 1.0
) -> tuple[Floats, Floats]:
    """Unit normals, shape (n, d), and offsets, shape (n,), of walls and of periodic sides."""
    rows = [row for wall in walls for row in wall.half_spaces(around)]
    for n, length, end in zip(np.eye(len(box)), box.diagonal(), shut, strict=True):
        if not end:
            rows += [(n, length), (-n, 0.0)]
    normals = np.array([n for n, _ in rows]).reshape(-1, len(box))
    return normals, np.array([offset for _, offset in rows])


def check_fit(walls: Sequence[Wall], box: Floats, cutoff: float) -> None:
    """Refuse obstacles that LAMMPS would not repeat with the periodic box.

    Args:
        walls: the shapes.
        box: lattice vectors as rows, shape (d, d) [length].
        cutoff: distance from the center of a particle at which walls begin to count [length].
    """
    shuts, around = closed(walls, len(box)), "circle" if len(box) == 2 else "sphere"
    for n, wall in enumerate(walls, start=1):
        if isinstance(wall, Plane) or not wall.is_obstacle:
            continue
        for axis, length, shut in zip("xyz", box.diagonal(), shuts, strict=False):
            if isinstance(wall, Post) and axis == wall.axis:
                if (tilt := box["xyz".index(axis)]).astype(bool).sum() > 1:
                    raise ParameterError(
                        f"post {n} is not along an edge of the box, {tilt.tolist()}: its axis must "
                        "be x, or the box not tilted"
                    )
                continue
            if not shut and wall.extent + cutoff > 0.5 * length:
                raise ParameterError(
                    f"{wall.kind} {n} does not fit into the periodic box: a {around} around it and "
                    f"the reach of particles, {wall.extent:.4g} + {cutoff:.4g}, exceed half of the "
                    f"box along {axis}, {0.5 * length:.4g}; take a larger box, smaller obstacles, "
                    "or a container"
                )


def stretched(walls: Sequence[Wall], box: Floats, new: Floats) -> tuple[Wall, ...]:
    """Walls after a stretch of the box along its axes, about the origin.

    Raises:
        ParameterError: the box is sheared, or a round wall stretched in one direction.
    """
    if not walls:
        return ()
    factors = new.diagonal() / box.diagonal()
    sheared = np.abs(new - box * factors) > _SAME * new[0, 0]
    if sheared.any():
        at = tuple(np.argwhere(sheared)[0])
        raise ParameterError(
            f"a box with walls cannot be sheared: its tilt must be {(box * factors)[at]:g}, not "
            f"{new[at]:g}"
        )
    for n, wall in enumerate(walls, start=1):
        axes = list(wall.round_axes)
        if axes and np.ptp(factors[axes]) > _SAME * factors[axes[0]]:
            along = " and ".join(f"{factors[k]:g} along {'xyz'[k]}" for k in axes)
            raise ParameterError(
                f"{wall.kind} {n} must stay round: the box may be stretched by one factor only, "
                f"not by {along}"
            )
    return tuple(wall.stretched(*factors.tolist()) for wall in walls)

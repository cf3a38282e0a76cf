"""The part of a volume that is nearest to each particle: cells of a radical tessellation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..core import contact_line
from ..model.neighbors import pairs_within
from ..model.packing import Packing
from ..model.wall_base import HalfSpace
from ..model.walls import Plane
from .cells import FIRST, FURTHER, Cells

Floats = NDArray[np.float64]

# Faces below this part of the largest face of their cell are corners that rounding has cut.
_NO_FACE = 1e-9


def cells_of(packing: Packing) -> Cells:
    """The cells of all particles, polyhedra between the radical planes of neighbors and walls.

    Raises:
        ParameterError: there is a round wall, at which cells would not be polyhedra.
    """
    ends = [wall.half_spaces()[0] for wall in packing.walls if isinstance(wall, Plane)]
    if len(ends) < len(packing.walls):
        n, kind = next((n, w.kind) for n, w in enumerate(packing.walls, 1) if w.round_axes)
        raise ParameterError(
            f"Voronoi cells in space end at planes only, and wall {n} is a {kind}: take a room "
            "between planes for local_phi, cell_sides and steinhardt"
        )
    radius = packing.radius
    spacing = (packing.volume / len(packing)) ** (1.0 / 3.0)
    reach = FIRST * max(2.0 * float(radius.max()), spacing)
    while True:
        cells, far = _within(packing, reach, ends)
        # the nearest plane that a neighbor beyond the reach may have
        beyond = np.full(len(packing), reach), radius, np.full(len(packing), radius.max())
        if (far <= radius - contact_line(*beyond)).all():
            return cells
        reach *= FURTHER


def _within(packing: Packing, reach: float, ends: Sequence[HalfSpace]) -> tuple[Cells, Floats]:
    """Cells between neighbors up to a distance, and the farthest corner of each cell, (N,).

    Cells also end at walls, and at a cube, so that all have an end.
    """
    from scipy.spatial import ConvexHull

    radius = packing.radius
    i, j, shift = pairs_within(packing, reach)
    vector = packing.positions[j] + shift - packing.positions[i]
    i, j, vector = np.concatenate([i, j]), np.concatenate([j, i]), np.concatenate([vector, -vector])
    distance = np.linalg.norm(vector, axis=1)
    offset = radius[i] - contact_line(distance, radius[i], radius[j])
    order = np.argsort(i, kind="stable")
    size, far = np.zeros(len(packing)), np.zeros(len(packing))
    found = []
    more = np.array([*np.eye(3), *-np.eye(3), *(normal for normal, _ in ends)])
    levels = np.array([offset for _, offset in ends])
    for n, part in enumerate(np.split(order, np.searchsorted(i[order], np.arange(1, len(radius))))):
        normal = np.concatenate([vector[part] / distance[part, None], more])
        to_walls = levels - more[6:] @ packing.positions[n]
        height = np.concatenate([offset[part], np.full(6, 2.0 * reach), to_walls])
        corners = _corners(normal, height)
        if len(corners) == 0:  # no cell is left between larger particles
            continue
        hull = ConvexHull(corners)
        a, b, c = np.moveaxis(corners[hull.simplices], 1, 0)
        each = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
        face = np.argmax(hull.equations[:, :3] @ normal.T, axis=1)
        area = np.bincount(face, each, minlength=len(normal))[: len(part)]
        kept = area > _NO_FACE * area.max(initial=0.0)
        size[n], far[n] = hull.volume, np.linalg.norm(corners, axis=1).max()
        found.append((np.full(kept.sum(), n), normal[: len(part)][kept], area[kept]))
    return Cells(size, *map(np.concatenate, zip(*found, strict=True))), far


def _corners(normal: Floats, offset: Floats) -> Floats:
    """Corners of the polyhedron n x <= offset, shape (m, 3); none if it is empty."""
    from scipy.optimize import linprog
    from scipy.spatial import HalfspaceIntersection

    inside = np.zeros(3)
    if offset.min() <= 0.0:  # the center is not within: the middle of the largest ball that is
        rows = np.column_stack([normal, np.ones(len(normal))])
        ball = linprog([0.0, 0.0, 0.0, -1.0], rows, offset, bounds=[(None, None)] * 3 + [(0, None)])
        if not ball.success or ball.x[3] <= 0.0:
            return np.empty((0, 3))
        inside = ball.x[:3]
    planes = np.column_stack([normal, -offset])
    return np.asarray(HalfspaceIntersection(planes, inside).intersections)

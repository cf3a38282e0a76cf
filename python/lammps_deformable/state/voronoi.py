"""Voronoi cells between radical (Laguerre) axes, and the bond-orientational order that they give.

In the plane and in space; cells end at walls.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.box import cartesian, fractional
from ..common.errors import ParameterError
from ..core import contact_line, polygon_edges
from ..particles.containers import bounds, closed, container, obstacles
from ..particles.neighbors import pairs_within
from ..particles.walls import HalfSpace, Plane

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..particles.packing import Packing

Floats = NDArray[np.float64]

# Faces below this part of the largest face of their cell are corners that rounding has cut.
_NO_FACE = 1e-9


Integers = NDArray[np.int64]

# Neighbors are sought up to this many diameters, or mean spacings of particles, and then further.
FIRST, FURTHER = 2.0, 1.5


class Cells(NamedTuple):
    """Cells between the radical axes of all neighbors, or planes in space; they end at walls.

    Attributes:
        size: area or volume of each cell, shape (N,) [length^d]; they sum to that of the packing.
        i: particle of each side that is common with a neighbor, shape (M,).
        direction: from the particle to the neighbor, unit vectors, shape (M, d).
        side: length or area of the side, shape (M,) [length^(d - 1)].
    """

    size: Floats
    i: Integers
    direction: Floats
    side: Floats


def cells_of(packing: Packing) -> Cells:
    """The cells of all particles in a plane.

    Not by freud, whose cells know no radii and no walls, and whose Voro++ crashes beside that of
    LAMMPS in one process.
    """
    radius = packing.radii
    spacing = float(np.sqrt(np.prod(packing.box.diagonal()) / len(packing)))
    reach = FIRST * max(2.0 * float(radius.max()), spacing)
    while True:
        i, direction, ends = _sides_within(packing, reach)
        # the nearest line that a neighbor beyond the reach may have
        beyond = np.full(len(packing), reach), radius, np.full(len(packing), radius.max())
        line = radius - contact_line(*beyond)
        if (np.hypot(*np.moveaxis(ends, -1, 0)).max(axis=1) <= line[i]).all():  # nan is not
            break
        reach *= FURTHER
    corners = np.split(ends[:, 0], np.searchsorted(i, np.arange(1, len(packing))))
    if packing.walls:
        return _between_walls(packing, corners, i, direction, ends)
    area = np.array([_area(polygon) for polygon in corners])
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    return Cells(area, i, direction, length)


def _sides_within(packing: Packing, reach: float) -> tuple[Integers, Floats, Floats]:
    """Sides of the cells of neighbors up to a distance.

    Returns:
        Of each side, those of a cell counterclockwise: the particle, the direction to it, and both
        corners as vectors from the particle, shape (M, 2, 2) [length]. A cell without an end has
        sides of nan. At walls cells go on to a box around the room.
    """
    radius = packing.radii
    i, j, shift = pairs_within(packing, reach)
    vector = packing.positions[j] + shift - packing.positions[i]
    i, j, vector = np.concatenate([i, j]), np.concatenate([j, i]), np.concatenate([vector, -vector])
    distance = np.hypot(*vector.T)
    offset = radius[i] - contact_line(distance, radius[i], radius[j])
    found = []
    normals, levels = _ends_of_room(packing)
    order = np.argsort(i, kind="stable")
    first = np.searchsorted(i[order], np.arange(1, len(packing)))
    for n, part in enumerate(np.split(order, first)):
        normal = np.concatenate([vector[part] / distance[part, None], normals])
        height = np.append(offset[part], levels - normals @ packing.positions[n])
        turn = np.argsort(np.arctan2(normal[:, 1], normal[:, 0]))
        normal, height = normal[turn], height[turn]
        try:
            ends = polygon_edges(normal[:, 0], normal[:, 1], height).reshape(-1, 2, 2)
        except ValueError:  # no cell is left between larger particles
            continue
        kept = ~np.isnan(ends).any(axis=(1, 2))
        if np.sum(kept) < 3:
            kept, ends = np.ones_like(kept), np.full_like(ends, np.nan)
        particle = np.full(len(normal), n)
        found.append((particle[kept], normal[kept], ends[kept]))
    owner, direction, corners = map(np.concatenate, zip(*found, strict=True))
    return owner, direction, corners


def _ends_of_room(packing: Packing) -> tuple[Floats, Floats]:
    """Normals and offsets of a box around the room, along directions that walls close."""
    low, high = bounds(packing.walls, packing.box)
    normals, margin = np.concatenate([-np.eye(2), np.eye(2)]), np.tile(high - low, 2)
    shut = np.tile(closed(packing.walls), 2)
    return normals[shut], (np.append(-low, high) + margin)[shut]


def _area(corners: Floats) -> float:
    x, y = corners.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _between_walls(
    packing: Packing, corners: list[Floats], i: Integers, direction: Floats, ends: Floats
) -> Cells:
    """The parts of cells and sides that are free."""
    import shapely

    cell = np.where(
        closed(packing.walls), 0.0, np.floor(fractional(packing.positions, packing.box))
    )
    inside = packing.positions - cartesian(cell, packing.box)
    polygons = [
        shapely.Polygon(polygon + x) if len(polygon) else shapely.Polygon()
        for polygon, x in zip(corners, inside, strict=True)
    ]
    area = _free(packing, np.array(polygons), shapely.area)
    lines = shapely.linestrings(ends + inside[i][:, None])
    return Cells(area, i, direction, _free(packing, lines, shapely.length))


def _free(packing: Packing, shapes: Any, measure: Callable[[Any], Floats]) -> Floats:
    """How much of each shape of shapely is between the walls, in the periodic box."""
    import shapely

    walls, box = packing.walls, packing.box
    room = container(walls, box).difference(shapely.union_all(obstacles(walls, box)))
    along, across = ((0.0,) if shut else (-1.0, 0.0, 1.0) for shut in closed(walls))
    shifts = [cartesian(np.array([a, b]), box) for a in along for b in across]
    total = np.zeros(len(shapes))
    for shift in shifts:
        moved = shapely.transform(shapes, lambda points, shift=shift: points + shift)
        total += measure(shapely.intersection(moved, room))
    return total


def space_cells_of(packing: Packing) -> Cells:
    """The cells of all particles, polyhedra between the radical planes of neighbors and walls.

    Raises:
        ParameterError: there is a round wall, at which cells would not be polyhedra.
    """
    ends = [wall._half_spaces()[0] for wall in packing.walls if isinstance(wall, Plane)]
    if len(ends) < len(packing.walls):
        n, kind = next((n, w._kind) for n, w in enumerate(packing.walls, 1) if w._round_axes)
        raise ParameterError(
            f"Voronoi cells in space end at planes only, and wall {n} is a {kind}: take a room "
            "between planes for local_phi, cell_sides and steinhardt"
        )
    radius = packing.radii
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

    radius = packing.radii
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

"""The part of an area that is nearest to each particle: cells of a radical tessellation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core import contact_line, polygon_edges
from ..model.free_room import container, obstacles
from ..model.lattice import cartesian, fractional
from ..model.neighbors import pairs_within
from ..model.packing import Packing
from ..model.room import bounds, closed

Floats = NDArray[np.float64]
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
    radius = packing.radius
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
    radius = packing.radius
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

"""Order and correlations of the centers of a packing, and its Voronoi cells.

What the methods of a `State` compute. By freud: functions of the distance of two centers, between
walls too. By this module: density waves, the structure factor, bond-orientational order, and the
cells of a radical (Laguerre) tessellation, in the plane and in space.
"""

from __future__ import annotations

import math
from functools import reduce
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common._checks import count
from ..common.box import cartesian, fractional, lengths, widths
from ..common.errors import ParameterError
from ..common.versions import optional
from ..core import contact_line, polygon_edges, unit_vectors
from ..formats.files import in_space
from ..particles.neighbors import forward, pairs_within
from ..particles.room import Distances, bounds, closed, container, obstacles
from ..particles.walls import HalfSpace, Plane

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..particles.packing import Packing
    from .contacts import ContactForces


Floats = NDArray[np.float64]

# Random places between walls, each with a random direction: g is right to 1/sqrt of this number.
_PLACES = 40_000


def radial_distribution(
    packing: Packing, freud_system: tuple[Any, Floats], r_max: float, bins: int
) -> tuple[Floats, Floats]:
    """See `State.radial_distribution`.

    Args:
        packing: the centers and walls.
        freud_system: box and points of `State.to_freud`.
        r_max: largest distance [length].
        bins: number of intervals of the distance.
    """
    density = optional("freud", "freud").density
    box, _ = freud_system
    found = _by_distance(density.RDF(bins, r_max), r_max, freud_system)
    r, g = np.array(found.bin_centers), np.array(found.rdf, dtype=np.float64)
    if packing.walls:
        area, inside = _room_around(packing, r)
        g *= area / (box.volume * inside)  # freud's density counts the empty part of its box
    return r, g


def correlation(
    freud_system: tuple[Any, Floats], values: NDArray[np.complex128], r_max: float, bins: int
) -> tuple[Floats, Floats]:
    """Distances r and the mean of conj(a_i) a_j over all pairs at r; nan where there are none.

    Args:
        freud_system: box and points of `State.to_freud`.
        values: a of each particle, shape (N,); pairs with a nan are left out.
        r_max: largest distance [length].
        bins: number of intervals of the distance.
    """
    density = optional("freud", "freud").density
    box, points = freud_system
    known = ~np.isnan(values)
    function = density.CorrelationFunction(bins, r_max)
    found = _by_distance(function, r_max, (box, points[known]), values=values[known])
    mean = np.array(found.correlation).real  # each pair counts in both orders
    return np.array(found.bin_centers), np.where(np.array(found.bin_counts) > 0, mean, np.nan)


def _by_distance(function: Any, r_max: float, system: tuple[Any, Floats], **values: Any) -> Any:
    box, _ = system
    if box.is2D:
        most = min(box.Lx / np.hypot(1.0, box.xy), box.Ly) / 2.0
    else:
        most = float(widths(np.asarray(box.to_matrix()).T).min()) / 2.0
    if r_max >= most:
        raise ParameterError(
            f"r_max = {r_max:g} is too large for the box: it must be below {most:.4g}, half the "
            "distance of opposite sides"
        )
    return function.compute(system, **values)


def _room_around(packing: Packing, r: Floats) -> tuple[float, Floats]:
    """Where centers may be: its area, and the part of circles of radius r about it that is within.

    In space these are a volume and spheres. It begins as far from the walls as the nearest center.
    """
    distances = Distances(packing.walls, packing.box)
    nearest = float(distances(packing.positions)[1].min())
    low, high = bounds(packing.walls, packing.box)
    rng = np.random.default_rng(0)
    tried = low + rng.random((_PLACES, packing.dimension)) * (high - low)

    def free(places: Floats) -> NDArray[np.bool_]:
        return distances(places)[1].min(axis=0) >= nearest

    places = tried[free(tried)]
    if packing.dimension == 2:
        out = unit_vectors(2.0 * np.pi * rng.random(len(places)))
    else:
        out = rng.normal(size=places.shape)
        out /= lengths(out)[:, None]
    inside = np.array([np.mean(free(places + distance * out)) for distance in r])
    return float(np.prod(high - low)) * len(places) / _PLACES, inside


# Farthest from a whole number of periods in the box that a wave may be.
_WHOLE = 1e-6

# Wave vectors whose amplitudes fit into memory.
_WAVES = 10**8

# Phases that are in memory at a time.
_PHASES = 2_000_000


def structure_factor(packing: Packing, k_max: float, bins: int) -> tuple[Floats, Floats]:
    """See `State.structure_factor`."""
    _refuse_container(packing)
    fractions, box = fractional(packing.positions, packing.box), packing.box
    # k = 2 pi (h, m, ..) B^-T, and h = k.a / 2 pi is below k_max |a| / 2 pi
    most = (k_max * lengths(box) / (2.0 * np.pi)).astype(int).tolist()
    # of k and -k, which are one wave, that with h >= 0
    waves = (most[0] + 1) * math.prod(2 * each + 1 for each in most[1:])
    if waves > _WAVES:
        raise ParameterError(
            f"k_max = {k_max:.4g} asks for {waves:.1e} wave vectors of the box: take a smaller one"
        )
    orders = [np.arange(most[0] + 1), *(np.arange(-each, each + 1) for each in most[1:])]
    total = np.zeros((waves // len(orders[-1]), len(orders[-1])), dtype=complex)
    block = max(_PHASES // len(total), 1)
    for first in range(0, len(packing), block):
        places = fractions[first : first + block].T
        phases = [
            np.exp(2.0j * np.pi * np.outer(h, x)) for h, x in zip(orders, places, strict=True)
        ]
        *some, last = phases
        before = reduce(lambda a, b: (a[:, None] * b).reshape(-1, b.shape[1]), some)
        total += before @ last.T
    power = np.abs(total).ravel() ** 2 / len(packing)
    grid = np.stack(np.meshgrid(*orders, indexing="ij"), axis=-1).reshape(-1, len(box))
    k = lengths(2.0 * np.pi * grid @ np.linalg.inv(box).T)
    kept = (k <= k_max) & forward(grid)
    edges = np.linspace(0.0, k_max, bins + 1)
    count, summed = (np.histogram(k[kept], edges, weights=each)[0] for each in (None, power[kept]))
    middle = 0.5 * (edges[1:] + edges[:-1])
    return middle, np.where(count > 0, summed / np.maximum(count, 1), np.nan)


def density_waves(packing: Packing, k: Floats) -> NDArray[np.complex128]:
    """See `State.density_waves`."""
    _refuse_container(packing)
    if k.ndim != 2 or k.shape[1] != packing.dimension:
        raise ParameterError(f"k must have shape (M, {packing.dimension}), not {k.shape}")
    periods = k @ packing.box.T / (2.0 * np.pi)
    off = np.abs(periods - np.rint(periods)).max(axis=1, initial=0.0)
    if off.max(initial=0.0) > _WHOLE:
        n = int(off.argmax())
        nearest = 2.0 * np.pi * np.linalg.solve(packing.box, np.rint(periods[n]))
        raise ParameterError(
            f"k = {k[n].tolist()} is no wave vector of the box: it has {periods[n].tolist()} "
            f"periods along its sides, not whole numbers; the nearest one is {nearest.tolist()}"
        )
    return np.array([np.exp(1.0j * (packing.positions @ wave)).mean() for wave in k])


def _refuse_container(packing: Packing) -> None:
    if any(closed(packing.walls, packing.dimension)):
        raise ParameterError(
            "the structure factor needs a periodic box: a container has no wave vectors of its own"
        )


def system(freud: Any, packing: Packing) -> tuple[Any, NDArray[np.float64]]:
    """See `State.to_freud`."""
    shut = closed(packing.walls, packing.dimension)
    sides = packing.box.diagonal() * np.where(shut, 2.0, 1.0)
    tilts = packing.box / packing.box.diagonal()[:, None]
    if packing.dimension == 2:
        box = freud.box.Box(*sides, xy=tilts[1, 0], is2D=True)
    else:
        box = freud.box.Box(*sides, tilts[1, 0], tilts[2, 0], tilts[2, 1])
    center = packing.origin + packing.box.sum(axis=0) / 2.0
    return box, box.wrap(in_space(packing.positions - center))


def neighbors(freud: Any, number: int, contacts: ContactForces) -> Any:
    """The contacts of so many particles as a NeighborList, from both sides."""
    pair = contacts.j >= 0
    i, j, vector, push = (
        each[pair] for each in (contacts.i, contacts.j, contacts.vector, contacts.push)
    )
    begin, end = np.append(i, j), np.append(j, i)
    order = np.lexsort((end, begin))
    both = in_space(np.concatenate([vector, -vector]))[order]
    weights = np.append(push, push)[order]
    return freud.locality.NeighborList.from_arrays(
        number, number, begin[order], end[order], both, weights
    )


def hexatic(cells: Cells, number: int, k: int) -> NDArray[np.complex128]:
    """See `State.hexatic`, of so many particles."""
    x, y = cells.direction.T
    order = np.zeros(number, dtype=np.complex128)
    np.add.at(order, cells.i, cells.side * (x + 1j * y) ** count("k", k))
    total = np.bincount(cells.i, cells.side, minlength=number)
    return np.divide(order, total, out=np.full(number, np.nan + 0j), where=total > 0.0)


def steinhardt(cells: Cells, number: int, degree: int) -> Floats:
    """See `State.steinhardt`, of so many particles."""
    from scipy.special import eval_legendre

    count("l", degree)
    ends = np.searchsorted(cells.i, np.arange(1, number))
    order = np.full(number, np.nan)
    for n, (direction, side) in enumerate(
        zip(np.split(cells.direction, ends), np.split(cells.side, ends), strict=True)
    ):
        if len(side):
            cosine = np.clip(direction @ direction.T, -1.0, 1.0)
            order[n] = np.sqrt(max(side @ eval_legendre(degree, cosine) @ side, 0.0)) / side.sum()
    return order


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


# Faces below this part of the largest face of their cell are corners that rounding has cut.
_NO_FACE = 1e-9


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

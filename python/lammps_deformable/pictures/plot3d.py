"""Pictures of a state in space: balls that the planes of their contacts cut, seen from far away.

Rays along the view meet balls and planes: no library draws more than that here. A slice is what a
horizontal plane cuts, a picture in the plane. The surfaces of the balls are polygons for VTK.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize, to_rgb
from numpy.typing import NDArray

from ..common.box import lengths
from ..common.checks import finite, numbers, shown
from ..common.errors import ParameterError
from ..particles.containers import bounds, closed, in_box, lines_around, section_between
from ..particles.walls import Sphere, Wall
from ..state.contacts import forces_of
from .drawing import (
    PUSH,
    Look,
    Picture,
    Scale,
    check_axes,
    color_limits,
    color_map,
    draw_bar,
    draw_key,
    write_title,
)
from .plot import values_of

if TYPE_CHECKING:
    from ..particles.packing import Packing
    from ..state.state import State

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Points on a sphere, and on the rim of a facet.
_POINTS, _RIM = 120, 12

# Points of the sphere are so far from facets, over the radius: no triangles are long and thin.
_MARGIN = 0.02

# What is within a plane, over the radius.
_WITHIN = 1e-9


class Facets(NamedTuple):
    """Planes that cut bodies.

    Attributes:
        i: particle of each, shape (M,).
        normal: out of it, shape (M, 3).
        height: distance from its center, shape (M,) [length].
    """

    i: Integers
    normal: Floats
    height: Floats

    def of_each(self, number: int) -> list[Integers]:
        """Places of the facets of each of so many particles."""
        order = np.argsort(self.i, kind="stable")
        return np.split(order, np.searchsorted(self.i[order], np.arange(1, number)))


# Of bodies that nothing cuts.
WHOLE = Facets(np.empty(0, np.int64), np.empty((0, 3)), np.empty(0))


class Surfaces(NamedTuple):
    """Triangles of spheres and polygons of facets, counterclockwise seen from outside.

    Attributes:
        points: shape (P, 3) [length].
        normals: at the points, out of the sphere or of the facet, shape (P, 3).
        corners: points of all polygons, one polygon after the other, shape (K,).
        ends: where each polygon ends in them, shape (M,).
        body: particle of each polygon, shape (M,).
        facet: place of its facet, -1 on the sphere, shape (M,).
    """

    points: Floats
    normals: Floats
    corners: Integers
    ends: Integers
    body: Integers
    facet: Integers


def surfaces_of(centers: Floats, radius: Floats, facets: Facets) -> Surfaces:
    """The surfaces of bodies, with corners and edges where facets meet.

    Args:
        centers: shape (N, 3) [length].
        radius: shape (N,) [length].
        facets: of all bodies.
    """
    found, count, end = [], 0, 0
    for n, own in enumerate(facets.of_each(len(radius))):
        cut = own[facets.height[own] < radius[n]]
        unit = _unit_surface(facets.normal[cut], facets.height[cut] / radius[n])
        corners, ends, on = count + unit.corners, end + unit.ends, np.append(cut, -1)[unit.facet]
        points = centers[n] + radius[n] * unit.points
        found.append((points, unit.normals, corners, ends, np.full(len(ends), n), on))
        count, end = count + len(points), end + len(corners)
    return Surfaces(*map(np.concatenate, zip(*found, strict=True)))


def _unit_surface(normal: Floats, height: Floats) -> Surfaces:
    """The surface of a cut unit sphere; facets are numbered as the planes.

    It is the convex hull of points on the sphere, on the rims of facets, and where facets meet.
    """
    from scipy.spatial import ConvexHull

    away = _sphere()
    away = away[(away @ normal.T < height - _MARGIN).all(axis=1)]
    edge = np.concatenate([_rims(normal, height), _meetings(normal, height)])
    edge = edge[(edge @ normal.T <= height + _WITHIN).all(axis=1)]
    points = np.concatenate([away, edge])
    triangles = ConvexHull(points).simplices.astype(np.int64)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    inward = np.sum(np.cross(b - a, c - a) * (a - points.mean(axis=0)), axis=1) < 0.0
    triangles[inward] = triangles[inward, ::-1]
    within = (np.abs(points @ normal.T - height) < _WITHIN)[triangles].all(axis=1)
    free = triangles[~within.any(axis=1)]
    plane = [np.full(3 * len(free), -1)]
    faces, polygons = [-1] * len(free), [free.ravel()]
    for k in np.flatnonzero(within.any(axis=0)).tolist():
        own = np.unique(triangles[within[:, k]])
        arm = points[own] - points[own].mean(axis=0)
        turn = np.arctan2(arm @ np.cross(normal[k], arm[0]), arm @ arm[0])
        polygons.append(own[np.argsort(turn)])
        plane.append(np.full(len(own), k))
        faces.append(k)
    corners, on = np.concatenate(polygons), np.concatenate(plane)
    sizes = [3] * len(free) + [len(each) for each in polygons[1:]]
    # a point of several faces is there once for each, with the normal of each
    key, place = np.unique((on + 1) * len(points) + corners, return_inverse=True)
    face, point = np.divmod(key, len(points))
    kept = points[point]
    of_sphere = kept / np.linalg.norm(kept, axis=1)[:, None]
    of_face = np.concatenate([np.zeros((1, 3)), normal])[face]
    normals = np.where(face[:, None] > 0, of_face, of_sphere)
    body = np.zeros(len(faces), np.int64)
    return Surfaces(kept, normals, place.ravel(), np.cumsum(sizes), body, np.array(faces))


def _sphere() -> Floats:
    """Points all over the unit sphere, on a spiral."""
    k = np.arange(_POINTS) + 0.5
    z, turn = 1.0 - 2.0 * k / _POINTS, np.pi * (3.0 - np.sqrt(5.0)) * k
    return np.column_stack([*(np.sqrt(1.0 - z**2) * (np.cos(turn), np.sin(turn))), z])


def _rims(normal: Floats, height: Floats) -> Floats:
    """Points on the circles in which planes cut the unit sphere."""
    least = np.eye(3)[np.abs(normal).argmin(axis=1)]
    u = np.cross(normal, least)
    u /= np.linalg.norm(u, axis=1)[:, None]
    v = np.cross(normal, u)
    turn = np.linspace(0.0, 2.0 * np.pi, _RIM, endpoint=False)[:, None, None]
    radius = np.sqrt(1.0 - height**2)[:, None]
    circles = height[:, None] * normal + radius * (np.cos(turn) * u + np.sin(turn) * v)
    return circles.reshape(-1, 3)


def _meetings(normal: Floats, height: Floats) -> Floats:
    """Where two planes meet on the unit sphere, and where they meet a third one within it."""
    k, j = np.triu_indices(len(height), 1)
    cosine = np.sum(normal[k] * normal[j], axis=1)
    k, j, cosine = (each[np.abs(cosine) < 1.0 - _WITHIN] for each in (k, j, cosine))
    sine2 = 1.0 - cosine**2
    along = np.cross(normal[k], normal[j]) / np.sqrt(sine2)[:, None]
    middle = ((height[k] - cosine * height[j]) / sine2)[:, None] * normal[k]
    middle += ((height[j] - cosine * height[k]) / sine2)[:, None] * normal[j]
    half = np.sqrt(np.maximum(1.0 - np.sum(middle**2, axis=1), 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        third = (height - middle @ normal.T) / (along @ normal.T)
    place = np.column_stack([half, -half, third])
    place[~(np.abs(place) <= half[:, None])] = np.nan
    points = middle[:, None] + place[..., None] * along[:, None]
    return points[(half > 0.0)[:, None] & np.isfinite(place)]


# Corners of a circle.
_OF_CIRCLE = 90

# Corners nearer to the line of a facet than this part of the radius are on it.
_ON = 1e-9


class Section(NamedTuple):
    """Particles that a plane cuts, each image of its own; a packing for pictures.

    Attributes:
        particle: number of each, shape (M,).
        positions: of the middles of their circles, shape (M, 2) [length].
        outlines: of each, shape (m, 2) [length].
        contacts: lines of facets of each, shape (2, 2) [length].
        box: lattice vectors in the plane, shape (2, 2) [length].
        walls: those that the plane cuts, as walls in the plane.
    """

    particle: NDArray[np.int64]
    positions: Floats
    outlines: list[Floats]
    contacts: list[list[Floats]]
    box: Floats
    walls: tuple[Wall, ...] = ()


def section_of(packing: Packing, facets: Facets, height: float) -> Section:
    """The section of all particles and their images with the plane z = height [length].

    Raises:
        ParameterError: the plane is outside of the walls.
    """
    x, radius, up = packing.positions, packing.radii, packing.box[2]
    walls = section_between(packing.walls, packing.box, height)
    if walls is None:
        low, high = bounds(packing.walls, packing.box)[:, 2]
        raise ParameterError(
            f"the slice at {height:g} is outside of the walls: take one from {low:g} to {high:g}"
        )
    shut = closed(packing.walls, 3)[2]
    first = np.ceil((height - radius - x[:, 2]) / up[2]).astype(int)
    last = np.floor((height + radius - x[:, 2]) / up[2]).astype(int)
    turn = np.linspace(0.0, 2.0 * np.pi, _OF_CIRCLE, endpoint=False)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    particle, middles, outlines, contacts = [], [], [], []
    for n, own in enumerate(facets.of_each(len(radius))):
        for image in (0,) if shut else range(first[n], last[n] + 1):
            center = x[n] + image * up
            above, middle = height - center[2], center[:2]
            if abs(above) >= radius[n]:
                continue
            outline = np.sqrt(radius[n] ** 2 - above**2) * circle
            lines = list(facets.normal[own, :2])
            levels = (facets.height[own] - facets.normal[own, 2] * above).tolist()
            for normal, level in zip(lines, levels, strict=True):
                outline = _clipped(outline, normal, level)
            if len(outline) < 3:
                continue
            on = [
                np.abs(outline @ normal - level) < _ON * radius[n]
                for normal, level in zip(lines, levels, strict=True)
            ]
            particle.append(n)
            middles.append(middle)
            outlines.append(middle + outline)
            contacts.append([middle + outline[each] for each in on if each.sum() == 2])
    return Section(
        np.array(particle, np.int64),
        np.reshape(middles, (-1, 2)),
        outlines,
        contacts,
        packing.box[:2, :2],
        tuple(walls),
    )


def _clipped(polygon: Floats, normal: Floats, level: float) -> Floats:
    """The part of a convex polygon in n x <= level."""
    beyond = polygon @ normal - level
    if (beyond <= 0.0).all():
        return polygon
    after, then = np.roll(polygon, -1, axis=0), np.roll(beyond, -1)
    cut = (beyond > 0.0) != (then > 0.0)
    part = (beyond / np.where(cut, beyond - then, 1.0))[:, None]
    both = np.stack([polygon, polygon + part * (after - polygon)], axis=1)
    return both[np.column_stack([beyond <= 0.0, cut])]


# Pixels along the longer side of a picture, and how many of them each way become one.
_PIXELS, _SMOOTHED = 560, 2

# Size of a picture [inch], with the bar of the colors, and without.
_SIZE, _SIZE_ALONE = (6.2, 5.2), (5.2, 5.2)

# Color of arrows.
_ARROWS = "tab:red"

# Gray of obstacles.
_WALL = 0.75

# Where light comes from, to the right, up, and to the viewer; light that is everywhere; light on
# facets over that on the rest.
_LIGHT, _EVERYWHERE, _FACETS = np.array([-0.35, 0.5, 0.8]), 0.35, 0.8


class Chains(NamedTuple):
    """Lines between centers.

    Attributes:
        i: where they begin, shape (M,).
        vector: to the other center, shape (M, 3) [length].
        force: shape (M,).
    """

    i: NDArray[np.int64]
    vector: Floats
    force: Floats


def new_axes(colorbar: bool = True) -> Axes:
    """Axes of a new figure."""
    return Picture(figsize=_SIZE if colorbar else _SIZE_ALONE, layout="constrained").subplots()


def draw(
    packing: Packing,
    values: Floats,
    look: Look,
    ax: Axes | None = None,
    facets: Facets = WHOLE,
    chains: Chains | None = None,
    view: tuple[float, float] = (20.0, 30.0),
) -> Axes:
    """Draw all particles with their centers in the box, from far away.

    Args:
        packing: centers, radii and box.
        values: shown as colors, shape (N,); a particle whose value is nan is gray.
        look: of the picture.
        ax: axes to draw into; those of a new figure without.
        facets: where bodies are cut; nowhere if not given.
        chains: drawn in place of bodies, if given.
        view: elevation above the plane of x and y, and azimuth of the viewer in it [degree].

    Raises:
        ParameterError: there is no such color map, or the view is no two numbers.
    """
    on = look.on([values], [] if chains is None else [chains.force])
    colors_of = color_map(look.cmap, on)
    turn = _turn(view)
    norm = Normalize(*color_limits(on))
    ax = new_axes(look.colorbar) if ax is None else ax
    check_axes(ax)
    balls = [w for w in packing.walls if isinstance(w, Sphere) and not w.inside]
    middles = np.array([ball._middle for ball in balls]).reshape(-1, 3)
    bodies = in_box(packing.walls, packing.box, np.concatenate([packing.positions, middles])) @ turn
    radius = np.append(packing.radii, [ball.radius for ball in balls])
    centers = bodies[: len(packing.positions)]
    edges = [line @ turn for line in lines_around(packing.walls, packing.box, turn[:, 2])]
    ends, margin = np.concatenate([*edges, bodies]), float(radius.max())
    low = np.minimum(ends.min(axis=0), (bodies - margin).min(axis=0))[:2]
    high = np.maximum(ends.max(axis=0), (bodies + margin).max(axis=0))[:2]
    lines = [edge[:, :2] for edge in edges]
    ax.add_collection(LineCollection(lines, colors="0.6", linewidths=0.8, zorder=0))
    colors = colors_of(norm(np.ma.masked_invalid(values)))[:, :3]
    if chains is None:
        cut = facets._replace(normal=facets.normal @ turn)
        all_colors = np.concatenate([colors, np.full((len(balls), 3), _WALL)])
        picture = _cast(bodies, radius, all_colors, cut, low, high)
        extent = (low[0], high[0], low[1], high[1])
        ax.imshow(picture, extent=extent, origin="lower", interpolation="antialiased", zorder=1)
    else:
        _draw_chains(ax, centers, colors, chains._replace(vector=chains.vector @ turn), on)
    if look.colorbar:
        draw_bar(ax, ScalarMappable(norm, colors_of), on, look.bar_label)
    if chains is not None and len(chains.i):
        draw_key(ax, on, PUSH)
    write_title(ax, look.title or "")
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    ax.set_axis_off()
    return ax


def draw_arrows(
    packing: Packing,
    vectors: Floats,
    values: Floats,
    look: Look,
    ax: Axes | None = None,
    view: tuple[float, float] = (20.0, 30.0),
) -> Axes:
    """Draw centers as dots with arrows, those behind paler; see `draw`.

    Args:
        packing: centers and box.
        vectors: of the arrows, shape (N, 3) [length].
        values: shown as colors of the dots, shape (N,).
        look: of the picture.
        ax: axes to draw into; those of a new figure without.
        view: elevation and azimuth of the viewer [degree].
    """
    none = Chains(np.empty(0, np.int64), np.empty((0, 3)), np.empty(0))
    ax = draw(packing, values, look, ax, chains=none, view=view)
    turn = _turn(view)
    centers = in_box(packing.walls, packing.box, packing.positions) @ turn
    heads = (centers + vectors @ turn)[:, :2]
    for axis, (low, high), ends in zip("xy", (ax.get_xlim(), ax.get_ylim()), heads.T, strict=True):
        ax.set(**{f"{axis}lim": (min(low, ends.min()), max(high, ends.max()))})
    order = np.argsort(centers[:, 2])
    (x, y, _), (u, v, _) = centers[order].T, (vectors @ turn)[order].T
    color = np.column_stack([np.tile(to_rgb(_ARROWS), (len(order), 1)), _paler(len(order))])
    ax.quiver(x, y, u, v, angles="xy", scale_units="xy", scale=1.0, color=color, zorder=3)
    return ax


def _paler(number: int) -> Floats:
    """Opacity of so many lines from behind to the front."""
    return np.linspace(0.25, 1.0, number) if number else np.empty(0)


def _turn(view: Any) -> Floats:
    """Columns: to the right, up, and to the viewer."""
    angles = numbers("view", view)
    if angles.shape != (2,):
        raise ParameterError(f"view must be elevation and azimuth, not {shown(view)}")
    elevation, azimuth = np.radians(angles)
    viewer = np.array([np.cos(azimuth), np.sin(azimuth), np.tan(elevation)]) * np.cos(elevation)
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return np.column_stack([right, np.cross(viewer, right), viewer])


def _cast(
    centers: Floats,
    radius: Floats,
    colors: Floats,
    facets: Facets,
    low: Floats,
    high: Floats,
) -> Floats:
    """The colors of what rays along the third axis meet first, shape (height, width, 4)."""
    pixel = float((high - low).max()) / (_PIXELS * _SMOOTHED)
    columns, rows = (np.ceil((high - low) / pixel / _SMOOTHED).astype(int) * _SMOOTHED).tolist()
    depth, image = np.full((rows, columns), -np.inf), np.zeros((rows, columns, 4))
    light = _LIGHT / np.linalg.norm(_LIGHT)
    own = facets.of_each(len(radius))
    for n in np.argsort(-centers[:, 2]):  # those in front first: what they hide is left out
        center, r = centers[n], float(radius[n])
        first = np.maximum(np.floor((center[:2] - r - low) / pixel).astype(int), 0)
        last = np.minimum(np.ceil((center[:2] + r - low) / pixel).astype(int), [columns, rows])
        x = low[0] + (np.arange(first[0], last[0]) + 0.5) * pixel - center[0]
        y = low[1] + (np.arange(first[1], last[1]) + 0.5) * pixel - center[1]
        x, y = np.meshgrid(x, y)
        place = np.s_[first[1] : last[1], first[0] : last[0]]
        height = np.sqrt(np.maximum(r**2 - x**2 - y**2, 0.0))
        seen = (height > 0.0) & (height + center[2] > depth[place])
        x, y, height = x[seen], y[seen], height[seen]
        front, back = height, -height  # where rays enter the body and leave it
        shade = _shade(np.stack([x, y, height], axis=-1) / r @ light)
        for k in own[n] if len(x) else ():
            (nx, ny, nz), h = facets.normal[k].tolist(), float(facets.height[k])
            if h >= r:
                continue
            room = h - nx * x - ny * y  # above nz z within the body
            if abs(nz) < 1e-9:
                front = np.where(room < 0.0, -np.inf, front)
            elif nz < 0.0:
                back = np.maximum(back, room / nz)
            else:
                cut = room / nz < front
                front = np.where(cut, room / nz, front)
                shade = np.where(cut, _FACETS * _shade(facets.normal[k] @ light), shade)
        kept = (front > back) & (front + center[2] > depth[place][seen])
        seen[seen] = kept
        depth[place][seen] = front[kept] + center[2]
        image[place][seen, :3] = shade[kept, None] * colors[n]
        image[place][seen, 3] = 1.0
    blocks = image.reshape(rows // _SMOOTHED, _SMOOTHED, columns // _SMOOTHED, _SMOOTHED, 4)
    opaque = blocks[..., 3:].sum(axis=(1, 3))
    smooth = blocks.sum(axis=(1, 3))
    smooth[..., :3] /= np.maximum(opaque, 1.0)
    smooth[..., 3] /= _SMOOTHED**2
    return np.clip(smooth, 0.0, 1.0)


def _shade(cosine: Any) -> Any:
    return _EVERYWHERE + (1.0 - _EVERYWHERE) * np.maximum(cosine, 0.0)


def _draw_chains(ax: Axes, centers: Floats, colors: Floats, chains: Chains, on: Scale) -> None:
    """Lines as wide as their forces, those behind first and paler; centers as dots."""
    begin = centers[chains.i]
    order = np.argsort(begin[:, 2] + chains.vector[:, 2])
    begin, vector, force = begin[order], chains.vector[order], chains.force[order]
    lines = np.stack([begin, begin + vector], axis=1)[..., :2]
    color = np.column_stack([np.tile([1.0, 0.27, 0.0], (len(order), 1)), _paler(len(order))])
    widths = on.widest * np.abs(force) / on.force
    ax.add_collection(LineCollection(list(lines), colors=color, linewidths=widths, zorder=1))
    near = np.argsort(centers[:, 2])
    x, y, _ = centers[near].T
    ax.scatter(x, y, 14.0, colors[near], edgecolors="0.3", linewidths=0.4, zorder=2)


def facets_of(state: State) -> Facets:
    """Where particles are cut by their contacts."""
    table = state.contacts
    height = state.packing.radii[table["i"]] - table["indentation"]
    return Facets(table["i"], table["normal"], height)


def plot(
    state: State,
    ax: Axes | None,
    look: Look,
    contacts: bool,
    forces: bool,
    view: tuple[float, float],
    slice: float | None,
) -> Axes:
    """See `State.plot`, of a state in space."""
    from . import drawing

    if contacts and slice is None:
        raise ParameterError("contacts are drawn in a slice: give a slice, or leave it out")
    if forces and slice is not None:
        raise ParameterError("forces are those of the whole network: leave it out of a slice")
    values = values_of(state, look.color)
    if slice is not None:
        cut = section_of(state.packing, facets_of(state), finite("slice", slice))
        look = replace(look, scale=look.on([values], []))  # as of the whole state
        return drawing.draw(
            cut,
            cut.outlines,
            values[cut.particle],
            look,
            ax,
            cut.contacts if contacts else None,
        )
    network = forces_of(state)
    chains = Chains(network.i, network.vector, lengths(network.force))
    facets = facets_of(state)
    return draw(state.packing, values, look, ax, facets, chains if forces else None, view)

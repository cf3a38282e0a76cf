"""The picture of a packing in three dimensions: bodies that facets cut, box, and forces.

Rays along the view meet balls and planes: no library draws more than that here.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.validate import expect, numbers, shown
from .facets import WHOLE, Facets
from .lattice import cartesian, fractional, lengths
from .picture import Picture
from .room import closed
from .scale import Scale, color_map
from .wall_lines import lines_around
from .walls import Ball, Wall

Floats = NDArray[np.float64]

# Pixels along the longer side of a picture, and how many of them each way become one.
_PIXELS, _SMOOTHED = 560, 2

# Size of a picture [inch], with the bar of the colors, and without.
_SIZE, _SIZE_ALONE = (6.2, 5.2), (5.2, 5.2)

# Gray of obstacles.
_WALL = 0.75

# Where light comes from, to the right, up, and to the viewer; light that is everywhere; light on
# facets over that on the rest.
_LIGHT, _EVERYWHERE, _FACETS = np.array([-0.35, 0.5, 0.8]), 0.35, 0.8


class Packing(Protocol):
    """What a picture shows of a packing."""

    @property
    def positions(self) -> Floats: ...
    @property
    def radius(self) -> Floats: ...
    @property
    def box(self) -> Floats: ...
    @property
    def walls(self) -> tuple[Wall, ...]: ...


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


def chains_of(i: NDArray[np.int64], vector: Floats, force: Floats) -> Chains:
    """The chains of contacts with these vectors and forces, shape (M, 3)."""
    return Chains(i, vector, lengths(force))


def new_axes(colorbar: bool = True) -> Axes:
    """Axes of a new figure."""
    return Picture(figsize=_SIZE if colorbar else _SIZE_ALONE, layout="constrained").subplots()


def draw(
    packing: Packing,
    values: Floats,
    label: str,
    title: str,
    on: Scale,
    ax: Axes | None = None,
    facets: Facets = WHOLE,
    chains: Chains | None = None,
    cmap: str | None = None,
    colorbar: bool = True,
    view: tuple[float, float] = (20.0, 30.0),
) -> Axes:
    """Draw all particles with their centers in the box, from far away.

    Args:
        packing: centers, radii and box.
        values: shown as colors, shape (N,); a particle whose value is nan is gray.
        label: of the values.
        title: of the picture.
        on: scale of colors and forces.
        ax: axes to draw into; those of a new figure without.
        facets: where bodies are cut; nowhere if not given.
        chains: drawn in place of bodies, if given.
        cmap: name of one of matplotlib's color maps.
        colorbar: draw a bar of the colors.
        view: elevation above the plane of x and y, and azimuth of the viewer in it [degree].

    Raises:
        ParameterError: there is no such color map, or the view is no two numbers.
    """
    expect("scale", on, Scale)
    colors_of = color_map(cmap, on)
    turn = _turn(view)
    one_value = on.high == on.low
    norm = Normalize(on.low, on.low + 1.0 if one_value else on.high)
    ax = new_axes(colorbar) if ax is None else ax
    expect("ax", ax, Axes)
    balls = [wall for wall in packing.walls if isinstance(wall, Ball)]
    middles = np.array([ball.center for ball in balls]).reshape(-1, 3)
    bodies = _in_box(packing, np.concatenate([packing.positions, middles])) @ turn
    radius = np.append(packing.radius, [ball.radius for ball in balls])
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
    if colorbar:
        bar = ax.figure.colorbar(ScalarMappable(norm, colors_of), ax=ax, label=label, shrink=0.85)
        if one_value:  # the first color is all there is: no numbers that no particle has
            bar.set_ticks([on.low])
    ax.set_title(title, fontsize=11)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    ax.set_axis_off()
    return ax


def _turn(view: Any) -> Floats:
    """Columns: to the right, up, and to the viewer."""
    angles = numbers("view", view)
    if angles.shape != (2,):
        raise ParameterError(f"view must be elevation and azimuth, not {shown(view)}")
    elevation, azimuth = np.radians(angles)
    viewer = np.array([np.cos(azimuth), np.sin(azimuth), np.tan(elevation)]) * np.cos(elevation)
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return np.column_stack([right, np.cross(viewer, right), viewer])


def _in_box(packing: Packing, places: Floats) -> Floats:
    """The images of places in the box; walls leave no others."""
    fractions = fractional(places, packing.box)
    cell = np.where(closed(packing.walls, 3), 0.0, np.floor(fractions))
    return cartesian(fractions - cell, packing.box)


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
    rank = np.linspace(0.25, 1.0, len(order)) if len(order) else np.empty(0)
    color = np.column_stack([np.tile([1.0, 0.27, 0.0], (len(order), 1)), rank])
    widths = on.widest * np.abs(force) / on.force
    ax.add_collection(LineCollection(list(lines), colors=color, linewidths=widths, zorder=1))
    near = np.argsort(centers[:, 2])
    x, y, _ = centers[near].T
    ax.scatter(x, y, 14.0, colors[near], edgecolors="0.3", linewidths=0.4, zorder=2)

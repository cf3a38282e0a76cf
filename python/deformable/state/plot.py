"""The picture of a state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib import colormaps
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.validate import expect, finite, shown
from ..model.packing import Packing
from ..model.room import closed, container, obstacles
from .contact_table import ContactTable

_LABELS = {
    "particle_pressure": "pressure in the particle",
    "pressure": "pressure in the particle",
    "area_deficit": "area deficit $A_0 - A$",
    "arc_radius": "smallest radius of curvature",
    "shape_parameter": r"shape parameter $P^2 / 4 \pi A$",
}

# Values of circles, at which scales of color begin; 0 for all others.
_ROUND = {"shape_parameter": 1.0}

# Width of the line of the largest force [points]: at most so wide, and in packings of many
# particles so wide times sqrt(N), about a tenth of a particle.
_WIDEST, _WIDEST_OF_MANY = 3.0, 36.0

# Colors of contacts that push, and of those that pull.
_PUSH, _PULL = "orangered", "magenta"

# Values that differ by less than this part of them are equal up to rounding.
_EQUAL = 1e-12

# Points of an outline closer to the chord of a contact than this, over R, are its ends: forces are
# balanced to 1e-8, and an arc has left the line within 1e-4 R.
_ON_LINE = 1e-7


@dataclass(frozen=True)
class Scale:
    """Meaning of colors and widths.

    Attributes:
        low: value of the first color.
        high: value of the last color; `low` if all values are equal.
        force: force of the widest line.
        widest: its width [points].
    """

    low: float
    high: float
    force: float
    widest: float


def scale(
    values: Sequence[NDArray[np.float64]], forces: Sequence[NDArray[np.float64]], color_by: str
) -> Scale:
    """One scale for several pictures, from the values of the particles and the forces of each."""
    begin = _ROUND.get(color_by, 0.0)
    low = min(begin, *(each.min() for each in values))
    high = max(begin, *(each.max() for each in values))
    force = max(np.abs(each).max(initial=0.0) for each in forces)
    if high - low <= _EQUAL * max(abs(low), abs(high)):
        high = low
    widest = min(_WIDEST, _WIDEST_OF_MANY / np.sqrt(len(values[0])))
    return Scale(low, high, force or 1.0, widest)


def limited(on: Scale, vmin: float | None, vmax: float | None) -> Scale:
    """A scale with other values of the first and last color, where these are given.

    Raises:
        ParameterError: they are no numbers, or the first is not below the second.
    """
    if vmin is None and vmax is None:
        return on
    low = on.low if vmin is None else finite("vmin", vmin)
    high = on.high if vmax is None else finite("vmax", vmax)
    if not low < high:
        raise ParameterError(f"vmin must be below vmax, not {low:g} and {high:g}")
    return replace(on, low=low, high=high)


def known_color_map(cmap: str) -> None:
    """Raise a ParameterError unless matplotlib has a color map of this name."""
    if not (isinstance(cmap, str) and cmap in colormaps):
        raise ParameterError(f"cmap must be one of matplotlib's color maps, not {shown(cmap)}")


def draw(
    packing: Packing,
    outlines: Sequence[NDArray[np.float64]],
    contacts: Sequence[ContactTable],
    values: NDArray[np.float64],
    color_by: str,
    title: str,
    on: Scale,
    ax: Axes | None = None,
    flat: bool = False,
    forces: bool = False,
    cmap: str = "YlGnBu",
    colorbar: bool = True,
) -> Axes:
    """Draw outlines and walls with all periodic images that reach into the box.

    Args:
        packing: centers, box and walls.
        outlines: of the particles.
        contacts: of each particle.
        values: shown as colors, shape (N,).
        color_by: name of the values.
        title: of the picture.
        on: scale of colors and forces.
        ax: axes to draw into; a new figure without.
        flat: draw the contacts, the common parts of two outlines, on top.
        forces: draw the force chains on top, those that pull in magenta.
        cmap: name of one of matplotlib's color maps.
        colorbar: draw a bar of the colors beside the axes.

    Raises:
        ParameterError: there is no such color map.
    """
    known_color_map(cmap)
    if ax is None:
        _, ax = plt.subplots(figsize=(6.4, 5.6), layout="constrained")
    expect("ax", ax, Axes)
    expect("scale", on, Scale)

    box, shut = packing.box, closed(packing.walls)
    corners = _frame(packing)
    frame = Polygon(corners, closed=True, fill=False, edgecolor="0.25", linewidth=1.0, zorder=3)
    ax.add_patch(frame)

    images, colors, flats, halves, pushes = [], [], [], [], []
    to_fraction = np.linalg.inv(box)
    pressed = _flats(outlines, packing.radius, contacts) if flat else [[]] * len(values)
    for outline, value, pressed_here, center, table in zip(
        outlines,
        values,
        pressed,
        packing.positions,
        contacts,
        strict=True,
    ):
        fraction = outline @ to_fraction
        low = np.where(shut, 0, np.floor(fraction.min(axis=0))).astype(int)
        high = np.where(shut, 0, np.floor(fraction.max(axis=0))).astype(int)
        for a in range(low[0], high[0] + 1):  # as many images as reach into the box
            for b in range(low[1], high[1] + 1):
                shift = np.array([a, b]) @ box
                images.append(outline - shift)
                colors.append(value)
                flats += [flat - shift for flat in pressed_here]
                if forces:  # each particle draws the half within its outline
                    halves += [np.array([center, end]) - shift for end in table["position"]]
                    pushes += (on.widest * table["force"] / on.force).tolist()
    particles = PolyCollection(
        images, array=np.array(colors), cmap=cmap, edgecolors="0.2", linewidths=0.6
    )
    one_value = on.high == on.low
    particles.set_clim(on.low, on.low + 1.0 if one_value else on.high)
    ax.add_collection(particles)  # the first of the collections, of which users make color bars
    particles.set_clip_path(frame)
    if packing.walls:
        walls = PolyCollection(
            _obstacles(packing), facecolors="0.75", edgecolors="0.25", linewidths=1.0, zorder=0.9
        )
        ax.add_collection(walls)
        walls.set_clip_path(frame)
    for lines in (
        *([LineCollection(flats, colors="tab:red", linewidths=1.8, capstyle="butt")] * flat),
        *(
            [
                LineCollection(
                    halves,
                    colors=[_PUSH if push >= 0.0 else _PULL for push in pushes],
                    linewidths=np.abs(pushes),
                    capstyle="round",
                    alpha=0.6,
                )
            ]
            * forces
        ),
    ):
        ax.add_collection(lines)
        lines.set_clip_path(frame)

    if colorbar:
        label = _LABELS.get(color_by, color_by)
        bar = ax.figure.colorbar(particles, ax=ax, label=label, shrink=0.85)
        if one_value:  # the first color is all there is: no numbers that no particle has
            bar.set_ticks([on.low])
    ax.set_title(title, fontsize=11)
    margin = 0.01 * np.ptp(corners, axis=0)
    ax.set(
        xlim=(corners[:, 0].min() - margin[0], corners[:, 0].max() + margin[0]),
        ylim=(corners[:, 1].min() - margin[1], corners[:, 1].max() + margin[1]),
        aspect="equal",
    )
    ax.set_axis_off()
    return ax


def _frame(packing: Packing) -> NDArray[np.float64]:
    """Corners of the box, or of the container, shape (n, 2) [length]."""
    if not packing.walls:
        return np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) @ packing.box
    return np.array(container(packing.walls, packing.box).exterior.coords)


def _obstacles(packing: Packing) -> list[NDArray[np.float64]]:
    """Corners of the obstacles that are drawn; of a segment both ends."""
    return [
        np.array(shape.coords if shape.geom_type == "LineString" else shape.exterior.coords)
        for shape in obstacles(packing.walls, packing.box)
    ]


def _flats(
    outlines: Sequence[NDArray[np.float64]],
    radii: NDArray[np.float64],
    contacts: Sequence[ContactTable],
) -> list[list[NDArray[np.float64]]]:
    """The part of each outline at its contacts, a straight line or an arc, arrays (m, 2)."""
    flats: list[list[NDArray[np.float64]]] = []
    for outline, radius, table in zip(outlines, radii, contacts, strict=True):
        table = table[table["length"] > 0.0]
        out = np.column_stack([np.cos(table["angle"]), np.sin(table["angle"])])
        half = 0.5 * table["length"] * np.sinc(table["half_angle"] / np.pi)  # of the chord
        height = np.sum(table["position"] * out, axis=1) - half * np.tan(0.5 * table["half_angle"])
        inward = height - outline @ out.T
        along = outline @ (out[:, ::-1] * [-1.0, 1.0]).T
        flats.append([])
        for off, place in zip(np.abs(inward).T, along.T, strict=True):
            if (on := np.flatnonzero(off <= _ON_LINE * radius)).size:
                begin, end = on[place[on].argmin()], on[place[on].argmax()]
                flats[-1].append(np.roll(outline, -begin, 0)[: (end - begin) % len(outline) + 1])
    return flats

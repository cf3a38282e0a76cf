"""Pictures by matplotlib: a packing with outlines, walls, contacts and forces, and its scale.

`plot` asks for it, so that only a run that draws loads matplotlib.
"""

from __future__ import annotations

import io
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection, LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.textpath import TextPath
from numpy.typing import ArrayLike, NDArray

from ..common.box import fractional
from ..common.checks import as_array, expect, finite, shown
from ..common.errors import ParameterError
from ..particles.containers import closed, container, obstacles

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.colors import Colormap

    from ..particles.walls import Wall


Floats = NDArray[np.float64]

# Color maps of values of one sign, and of both: no red, which is that of forces and contacts.
_SEQUENTIAL, _DIVERGING = "YlGnBu", "BrBG"
_CYCLIC = "twilight"
_NO_VALUE = "0.8"

# Angles, whose scale is a whole turn.
_ANGLES = ("direction",)

# Colors of whole numbers at most; more are continuous.
_COLORS = 16

# Width of the line of the largest force [points]: at most so wide, and in packings of many
# particles so wide times sqrt(N), about a tenth of a particle.
_WIDEST, _WIDEST_OF_MANY = 3.0, 36.0

# Values that differ by less than this part of them are equal up to rounding; values are signed if
# some are below 0 by more than the other part of the largest, as solvers leave tiny ones.
_EQUAL, _SIGNED = 1e-12, 1e-6


@dataclass(frozen=True)
class Scale:
    """Meaning of colors and widths.

    Attributes:
        low: value of the first color.
        high: value of the last color; `low` if all values are equal.
        force: force of the widest line.
        widest: its width [points].
        cyclic: whether the first and last color are the same.
        whole: whether each whole number has a color of its own.
    """

    low: float
    high: float
    force: float
    widest: float
    cyclic: bool = False
    whole: bool = False

    @property
    def signed(self) -> bool:
        """Whether 0 is in the middle of the colors."""
        return self.low < 0.0 and self.low == -self.high


def scale(
    values: Sequence[NDArray[np.float64]], forces: Sequence[NDArray[np.float64]], color_by: object
) -> Scale:
    """One scale for several pictures, from the values of the particles and the forces of each.

    It goes from the smallest to the largest value. If some values are negative, 0 is in the middle.
    For directions it is a whole turn. A few numbers that are all whole have a color each.
    """
    low = min(float(np.nanmin(each)) for each in values)
    high = max(float(np.nanmax(each)) for each in values)
    force = max((np.abs(each).max(initial=0.0) for each in forces), default=0.0)
    cyclic = isinstance(color_by, str) and color_by in _ANGLES
    if cyclic:
        low, high = -np.pi, np.pi
    elif low < -_SIGNED * high:
        high = max(-low, high)
        low = -high
    elif high - low <= _EQUAL * max(abs(low), abs(high)):
        high = low
    numbers = np.concatenate(values)
    whole = not cyclic and 0.0 < high - low < _COLORS
    whole &= bool(np.all(numbers[~np.isnan(numbers)] % 1.0 == 0.0))
    widest = min(_WIDEST, _WIDEST_OF_MANY / np.sqrt(len(values[0])))
    return Scale(low, high, float(force) or 1.0, float(widest), cyclic, whole)


# Names at the bar of the colors.
_LABELS = {
    "pressures": "pressure in the particle",
    "pressure": "pressure in the particle",
    "area_deficit": "area deficit $A_0 - A$",
    "arc_radii": "smallest radius of curvature",
    "arc_radius": "smallest radius of curvature",
    "spin": "spin [1/time]",
    "direction": "direction of propulsion [rad]",
    "shape_parameter": r"shape parameter $P^2 / 4 \pi A$",
}


@dataclass(frozen=True, kw_only=True)
class Look:
    """How a picture looks: what a user may ask for, in the plane and in space.

    Attributes:
        color: name of the values that are shown as colors, or the values.
        scale: of colors and forces; that of the values and forces that are drawn, if None.
        cmap: name of one of matplotlib's color maps; if None one for angles, or for the signs.
        vmin: value of the first color; that of the scale if None.
        vmax: value of the last color.
        title: of the picture, if any.
        label: of the bar of the colors; that of the name if None.
        colorbar: whether there is a bar.

    Raises:
        ParameterError: one is of another kind.
    """

    color: str | ArrayLike
    scale: Scale | None = None
    cmap: str | None = None
    vmin: float | None = None
    vmax: float | None = None
    title: str | None = None
    label: str | None = None
    colorbar: bool = True

    def __post_init__(self) -> None:
        expect("scale", self.scale, Scale, type(None))
        expect("title", self.title, str, type(None))
        expect("label", self.label, str, type(None))
        expect("colorbar", self.colorbar, bool)

    def on(self, values: Sequence[Floats], forces: Sequence[Floats]) -> Scale:
        """The scale of these values of particles and forces of contacts, of one or more pictures.

        Raises:
            ParameterError: the limits are no numbers, or the first is not below the second.
        """
        found = scale(values, forces, self.color) if self.scale is None else self.scale
        return limited(found, self.vmin, self.vmax)

    @property
    def bar_label(self) -> str:
        """The label of the bar."""
        if self.label is not None:
            return self.label
        return _LABELS.get(self.color, self.color) if isinstance(self.color, str) else ""


def check_axes(ax: object) -> None:
    """Refuse what is not of Matplotlib, such as the name of a file."""
    if isinstance(ax, (str, Path)):
        raise ParameterError(
            f"ax must be axes of Matplotlib, not {shown(str(ax))}: write a file by "
            f"plot(...).figure.savefig({str(ax)!r})"
        )
    expect("ax", ax, Axes)
    if getattr(ax, "name", "") == "3d":
        raise ParameterError(
            "ax must be axes of the plane, not 3D ones: droplets are drawn as they are seen from "
            "`view`"
        )


def per_particle(
    color_by: object, found: object, number: int, names: Iterable[str]
) -> NDArray[np.float64]:
    """What is found for the colors, as one number for each particle, shape (N,).

    Args:
        color_by: what the user has asked for.
        found: the numbers, of which some may be nan, or anything else.
        number: of particles.
        names: that the user may ask for.

    Raises:
        ParameterError: they are no such numbers.
    """
    values = as_array(found)
    fits = values.shape == (number,) and values.dtype.kind in "biuf"
    if not fits or np.isinf(values).any() or np.isnan(values).all():
        kind = "real " if np.iscomplexobj(values) else ""
        raise ParameterError(
            f"color must name a value of each particle, such as {', '.join(sorted(names))}, or "
            f"be {number} {kind}numbers, not {shown(color_by)}"
        )
    return values.astype(np.float64)


def limited(on: Scale, vmin: float | None, vmax: float | None) -> Scale:
    """A scale with other values of the first and last color, where these are given.

    Where 0 is in the middle it stays there, unless both are given.

    Raises:
        ParameterError: they are no numbers, or the first is not below the second.
    """
    if vmin is None and vmax is None:
        return on
    low = on.low if vmin is None else finite("vmin", vmin)
    high = on.high if vmax is None else finite("vmax", vmax)
    if on.signed and vmin is None and high > 0.0:
        low = -high
    if on.signed and vmax is None and low < 0.0:
        high = -low
    if not low < high:
        raise ParameterError(f"vmin must be below vmax, not {low:g} and {high:g}")
    return replace(on, low=low, high=high, whole=on.whole and low % 1.0 == high % 1.0 == 0.0)


def color_map(cmap: str | None, on: Scale) -> Colormap:
    """The color map of this name; if none is given, one for angles or for the signs of values.

    Raises:
        ParameterError: matplotlib has no color map of this name.
    """
    from matplotlib import colormaps

    if cmap is None:
        cmap = _CYCLIC if on.cyclic else _DIVERGING if on.signed else _SEQUENTIAL
    if not (isinstance(cmap, str) and cmap in colormaps):
        raise ParameterError(f"cmap must be one of matplotlib's color maps, not {shown(cmap)}")
    colors = colormaps[cmap]
    if on.whole:
        colors = colors.resampled(round(on.high - on.low) + 1)
    return colors.with_extremes(bad=_NO_VALUE)


def color_limits(on: Scale) -> tuple[float, float]:
    """The ends of the bar of the colors."""
    if on.whole:  # each number in the middle of its color
        return on.low - 0.5, on.high + 0.5
    return on.low, on.low + 1.0 if on.high == on.low else on.high


def draw_bar(ax: Axes, colors: Any, on: Scale, label: str, **place: Any) -> None:
    """The bar of the colors beside the axes."""
    figure: Any = ax.figure
    bar = figure.colorbar(colors, ax=ax, label=label, shrink=0.85, **place)
    if on.high == on.low:  # the first color is all there is: no numbers that no particle has
        bar.set_ticks([on.low])
    elif on.whole:
        bar.set_ticks(np.arange(on.low, on.high + 1.0))


def write_title(ax: Axes, title: str) -> None:
    """The title above the axes: a long one goes on in further lines, a long word is smaller."""
    figure: Any = ax.figure
    there = _PART * _POINTS_PER_INCH * float(figure.bbox.width / figure.dpi)
    lines: list[str] = []
    for line in title.splitlines():
        words = re.findall(r"(?:\$[^$]*\$|\S)+\s*", line)  # formulas stay whole
        lines.append("")
        for word in words:
            if lines[-1] and _width(lines[-1] + word) > there:
                lines.append("")
            lines[-1] += word
    widest = max(map(_width, lines), default=0.0)
    size = _TITLE_SIZE * min(1.0, there / max(widest, 1.0))
    ax.set_title("\n".join(line.rstrip() for line in lines), fontsize=size)


def _width(line: str) -> float:
    """Of a line of a title [points]."""
    width: float = TextPath((0, 0), line.rstrip(), size=_TITLE_SIZE).get_extents().width
    return width


def draw_key(ax: Axes, on: Scale, color: str) -> None:
    """What the width of a force chain means, below the axes."""
    line = Line2D([], [], color=color, linewidth=on.widest, alpha=0.6)
    place: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (0.0, 0.0), "frameon": False}
    ax.legend([line], [f"force {on.force:.2g}"], fontsize=9, borderaxespad=0.2, **place)


class Mark(NamedTuple):
    """Lines of one color.

    Attributes:
        lines: of each particle, arrays of shape (m, 2) [length].
        widths: of each particle, of its lines [points].
        color: a name of matplotlib.
    """

    lines: Sequence[Sequence[NDArray[np.float64]]]
    widths: Sequence[Sequence[float]]
    color: str


# Where the contacts of a particle are, shape (m, 2), and their forces, shape (m,).
Halves = tuple[Floats, Floats]

# Size of letters of a title [points], and the part of the width of a figure for the longest word,
# as axes are not in the middle.
_TITLE_SIZE, _POINTS_PER_INCH, _PART = 11.0, 72.0, 0.7

# Dots per inch in a notebook.
_DOTS = 72

# Area of a picture, and its longest side and least width, if the box is long [inch].
_AREA, _LONGEST, _NARROWEST = 25.0, 10.0, 1.6

# What the title takes above, the bar of the colors at the side of a picture, or below one that is
# wider than so many heights, and the margin [inch].
_TITLE, _BESIDE, _BELOW, _WIDE, _MARGIN = 0.6, 1.4, 0.9, 1.5, 0.2

# Colors of contacts that push, and of those that pull.
PUSH, _PULL = "orangered", "magenta"


class Packing(Protocol):
    """What a picture shows of a packing."""

    @property
    def positions(self) -> Floats: ...
    @property
    def box(self) -> Floats: ...
    @property
    def walls(self) -> tuple[Wall, ...]: ...


class Picture(Figure):
    """A figure that pyplot does not know, so that none stays open; a notebook shows it."""

    def _repr_png_(self) -> bytes:
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=_DOTS)
        return picture.getvalue()


def new_figure(packing: Packing, colorbar: bool = True) -> Picture:
    """An empty figure that is as long as the box."""
    sides = np.ptp(_frame(packing), axis=0)
    longest = min(float(np.sqrt(_AREA * sides.max() / sides.min())), _LONGEST)
    width, height = (sides / sides.max() * longest).tolist()
    beside, below = (_MARGIN, _BELOW) if _is_wide(packing) else (_BESIDE, 0.0)
    wide = max(width, _NARROWEST) + (beside if colorbar else _MARGIN)
    size = (wide, height + _TITLE + below * colorbar)
    return Picture(figsize=size, layout="constrained")


def _is_wide(packing: Packing) -> bool:
    width, height = np.ptp(_frame(packing), axis=0)
    return bool(width > _WIDE * height)


def draw(
    packing: Packing,
    outlines: Sequence[Floats],
    values: Floats,
    look: Look,
    ax: Axes | None = None,
    flats: Sequence[Sequence[Floats]] | None = None,
    halves: Sequence[Halves] | None = None,
    marks: Sequence[Mark] = (),
) -> Axes:
    """Draw outlines and walls with all periodic images that reach into the box.

    The bar of the colors is beside the axes, or below if the box is wide.

    Args:
        packing: centers, box and walls.
        outlines: of the particles.
        values: shown as colors, shape (N,); a particle whose value is nan is gray.
        look: of the picture.
        ax: axes to draw into; those of a new figure without.
        flats: contacts of each particle, lines of shape (m, 2), drawn on top [length].
        halves: contacts of each particle and their forces, for force chains on top; those that pull
            are magenta.
        marks: further lines of the particles, drawn on top of all.

    Raises:
        ParameterError: there is no such color map, or see `Look`.
    """
    on = look.on([values], [force for _, force in halves or ()])
    colors_of = color_map(look.cmap, on)
    if ax is None:
        ax = new_figure(packing, look.colorbar).subplots()
    check_axes(ax)

    box, shut = packing.box, closed(packing.walls)
    corners = _frame(packing)
    frame = Polygon(corners, closed=True, fill=False, edgecolor="0.25", linewidth=1.0, zorder=3)
    ax.add_patch(frame)

    images: list[Floats] = []
    colors: list[float] = []
    lines: list[Floats] = []
    chains: list[Floats] = []
    pushes: list[float] = []
    marked: list[list[Floats]] = [[] for _ in marks]
    widths_of_marks: list[list[float]] = [[] for _ in marks]
    for n, (outline, center) in enumerate(zip(outlines, packing.positions, strict=True)):
        fraction = fractional(outline, box)
        low = np.where(shut, 0, np.floor(fraction.min(axis=0))).astype(int)
        high = np.where(shut, 0, np.floor(fraction.max(axis=0))).astype(int)
        for a in range(low[0], high[0] + 1):  # as many images as reach into the box
            for b in range(low[1], high[1] + 1):
                shift = np.array([a, b]) @ box
                images.append(outline - shift)
                colors.append(values[n])
                lines += [flat - shift for flat in flats[n]] if flats else []
                if halves:  # each particle draws the half within its outline
                    ends, forces = halves[n]
                    chains += [np.array([center, end]) - shift for end in ends]
                    pushes += (on.widest * forces / on.force).tolist()
                for k, mark in enumerate(marks):
                    marked[k] += [line - shift for line in mark.lines[n]]
                    widths_of_marks[k] += mark.widths[n]
    particles = PolyCollection(
        images, array=np.array(colors), cmap=colors_of, edgecolors="0.2", linewidths=0.6
    )
    particles.set_clim(*color_limits(on))
    drawn: list[Collection] = [particles]  # the first one, of which users make color bars
    if packing.walls:
        walls = _obstacles(packing)
        drawn.append(PolyCollection(walls, facecolors="0.75", edgecolors="0.25", zorder=0.9))
    if flats:
        drawn.append(LineCollection(lines, colors="tab:red", linewidths=1.8, capstyle="butt"))
    if halves:
        signs = [PUSH if push >= 0.0 else _PULL for push in pushes]
        widths = np.abs(pushes).tolist()
        drawn.append(
            LineCollection(chains, colors=signs, linewidths=widths, capstyle="round", alpha=0.6)
        )
    for mark, found, widths in zip(marks, marked, widths_of_marks, strict=True):
        drawn.append(LineCollection(found, colors=mark.color, linewidths=widths, capstyle="round"))
    for collection in drawn:
        ax.add_collection(collection)
        collection.set_clip_path(frame)

    if look.colorbar:
        place: dict[str, Any] = {"location": "bottom", "aspect": 40.0} if _is_wide(packing) else {}
        draw_bar(ax, particles, on, look.bar_label, **place)
    if halves:
        draw_key(ax, on, PUSH)
    write_title(ax, look.title or "")
    margin = 0.01 * np.ptp(corners, axis=0)
    ax.set(
        xlim=(corners[:, 0].min() - margin[0], corners[:, 0].max() + margin[0]),
        ylim=(corners[:, 1].min() - margin[1], corners[:, 1].max() + margin[1]),
        aspect="equal",
    )
    ax.set_axis_off()
    return ax


def _frame(packing: Packing) -> Floats:
    """Corners of the box, or of the container, shape (n, 2) [length]."""
    if not packing.walls:
        return np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) @ packing.box
    return np.array(container(packing.walls, packing.box).exterior.coords)


def _obstacles(packing: Packing) -> list[Floats]:
    """Corners of the obstacles that are drawn; of a chain there and back."""
    return [
        np.array(
            [*shape.coords, *shape.coords[-2:0:-1]]
            if shape.geom_type == "LineString"
            else shape.exterior.coords
        )
        for shape in obstacles(packing.walls, packing.box)
    ]

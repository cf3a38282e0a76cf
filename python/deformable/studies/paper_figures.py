"""The paper's figures from the data of `paper`: each function returns a Matplotlib figure."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from matplotlib.ticker import FuncFormatter, NullFormatter, NullLocator
from numpy.typing import NDArray

from . import paper
from .comparison import Comparison, ring_outlines
from .single import Squeezed

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BEADS: dict[str, Any] = {"color": "tab:red", "linestyle": "none", "marker": "."}
_LAWS: dict[str, dict[str, Any]] = {
    "sector": {"color": "black", "linestyle": "-"},
    "ring": {"color": "tab:blue", "linestyle": "--"},
}
_SOFTER = {
    "soft ring": {"color": "tab:green", "linestyle": ":"},
    "balanced": {"color": "tab:orange", "linestyle": "-."},
}
_I = r"shape error $I$"
_A = r"indentation $a/R_0$"


def _new(
    height: float, rows: int = 1, columns: int = 1, sharey: bool = False
) -> tuple[Figure, NDArray[Any]]:
    """A figure 1200 pixels wide, and its axes."""
    figure = Figure(figsize=(8.0, height), dpi=150, layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, sharey=sharey)


def _shades(count: int) -> list[tuple[float, float, float, float]]:
    return [tuple(colormaps["viridis"](x)) for x in np.linspace(0.0, 0.88, count)]


def _decade(value: float) -> str:
    """1, 10, or 10^n as a formula without dollars."""
    power = np.log10(value)
    return f"10^{{{power:.0f}}}" if power > 1.5 and power % 1.0 == 0.0 else f"{value:g}"


def shapes(results: Sequence[Squeezed], stick: bool) -> Figure:
    """Beads and the outlines of both laws in the polygons, at the largest indentation."""
    largest = max(result.indentation for result in results)
    chosen = [r for r in results if r.walls.stick == stick and r.indentation == largest]
    figure, axes = _new(5.9, 2, 3)
    for ax, result in zip(axes.flat, chosen, strict=True):
        _shape(ax, result)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    figure.suptitle(
        f"{chosen[0].beads.rings.number[0]} beads, "
        rf"$k_L = {_decade(chosen[0].kL)}$, $a/R_0 = {largest:g}$, "
        f"walls {'stick' if stick else 'slip'}"
    )
    return figure


def _shape(ax: Axes, result: Squeezed) -> None:
    corners = _corners(result.walls.angle, 1.0 - result.indentation)
    ax.plot(*np.vstack([corners, corners[:1]]).T, color="0.7", linewidth=1.0, label="walls")
    ax.plot(*result.beads.outlines[0].T, **_BEADS, markersize=2.5, label="beads")
    for law, style in _LAWS.items():
        outline = result.outlines[law] + result.center
        ax.plot(*np.vstack([outline, outline[:1]]).T, **style, linewidth=0.9, label=law)
    text = "\n".join(f"$I$ {law} = {_short(result.shape_error(law))}" for law in _LAWS)
    ax.text(0.0, 0.0, text, ha="center", va="center", fontsize=9)
    ax.set(xlim=(-1.12, 1.12), ylim=(-1.12, 1.12), aspect="equal")  # far corners are cut off
    ax.set_axis_off()


def _short(value: float) -> str:
    mantissa, power = f"{value:.1e}".split("e")
    return rf"${mantissa}\times 10^{{{int(power)}}}$"


def _corners(angle: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Corners of the polygon whose sides have these directions and this distance."""
    half = np.diff(angle, append=angle[0] + 2.0 * np.pi) / 2.0
    middle = angle + half
    return (height / np.cos(half))[:, None] * np.column_stack([np.cos(middle), np.sin(middle)])


def deviation(results: Sequence[Squeezed], indentation: float = 0.02) -> Figure:
    """|v| - g(theta) along the outline, a line for each stiffness; below, the stiffest larger."""
    chosen = [r for r in results if np.isclose(r.indentation, indentation)]
    figure, axes = _new(6.0, 2, 1)
    for result, shade in zip(chosen, _shades(len(chosen)), strict=True):
        turn = np.degrees(result.angle) % 360.0
        order = np.argsort(turn)
        label = rf"$k_L = {_decade(result.kL)}$"
        for ax, unit in zip(axes[:, 0], (1e-3, 1e-5), strict=True):
            difference = result.deviation["sector"][order] / unit
            ax.plot(turn[order], difference, color=shade, linewidth=1.1, label=label)
    stiffest = 1.1e5 * max(np.abs(r.deviation["sector"]).max() for r in chosen[-3:])
    axes[1, 0].set(xlabel=r"direction $\theta$ [degrees]", ylim=(-stiffest, stiffest))
    for ax, power in zip(axes[:, 0], (-3, -5), strict=True):
        ax.set(
            ylabel=rf"$(|\mathbf{{v}}| - g(\theta))/R_0$  [$10^{{{power}}}$]",
            xlim=(0.0, 360.0),
            xticks=range(0, 361, 60),
        )
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside right center", fontsize=8)
    figure.suptitle(
        rf"hexagon, $a/R_0 = {indentation:g}$, {chosen[0].beads.rings.number[0]} beads, walls stick"
    )
    return figure


def error_by_indentation(results: Sequence[Squeezed]) -> Figure:
    """I against a for each stiffness, and against the stiffness for several a."""
    figure, axes = _new(4.8, 1, 2)
    left, right = axes[0]
    stiffnesses = sorted({r.kL for r in results})
    for kL, shade in zip(stiffnesses, _shades(len(stiffnesses)), strict=True):
        line = [r for r in results if r.kL == kL]
        label = rf"$k_L = {_decade(kL)}$"
        _errors(left, [r.indentation for r in line], line, color=shade, label=label)
    left.set(xlabel=_A, ylabel=_I, yscale="log")
    depths = sorted({r.indentation for r in results})[1::2]
    for a, shade in zip(depths, _shades(len(depths)), strict=True):
        line = [r for r in results if r.indentation == a]
        label = rf"$a/R_0 = {a:g}$"
        _errors(right, [r.kL for r in line], line, color=shade, label=label)
    right.set(xlabel=r"stiffness of the springs $k_L/k_A R_0^2$", ylabel=_I)
    right.set(xscale="log", yscale="log")
    spacing = float(results[0].beads.rings.spacing[0])
    for ax in (left, right):
        ax.axhline(spacing**2 / 24.0, color="0.6", linestyle=":", linewidth=1.0)
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=8, ncols=3)
    right.text(1.0, spacing**2 / 22.0, "$L_0^2/24R_0$: spacing of the beads", fontsize=7.5)
    figure.suptitle(f"hexagon, {results[0].beads.rings.number[0]} beads, walls stick")
    return figure


def _errors(ax: Axes, x: Iterable[float], line: Iterable[Squeezed], **style: Any) -> None:
    errors = [result.shape_error("sector") for result in line]
    ax.plot(list(x), errors, marker="o", markersize=3.5, linewidth=1.1, **style)


def error_by_number(results: Sequence[Squeezed]) -> Figure:
    """I against the number of beads at fixed kP = kL/N_v, for three indentations."""
    depths = sorted({r.indentation for r in results})
    depths = sorted({depths[len(depths) * part // 10] for part in (1, 3, 9)})
    figure, axes = _new(3.7, 1, len(depths), sharey=True)
    stiffness = sorted({_kP(r) for r in results})
    for ax, a in zip(axes[0], depths, strict=True):
        for kP, shade in zip(stiffness, _shades(len(stiffness)), strict=True):
            line = [r for r in results if r.indentation == a and _kP(r) == kP]
            numbers = [int(r.beads.rings.number[0]) for r in line]
            _errors(ax, numbers, line, color=shade, label=f"$k_P = {_decade(kP)}$")
        ax.set(xscale="log", yscale="log", xlabel="number of beads $N_v$")
        ax.set_title(rf"$a/R_0 = {a:g}$", fontsize=10)
        _plain_ticks(ax, [20, 50, 100, 200, 400])
    axes[0, 0].set_ylabel(_I)
    axes[0, -1].legend(fontsize=8)
    return figure


def _kP(result: Squeezed) -> float:
    return round(float(result.beads.rings.kP[0]), 9)


def limits(found: Sequence[paper.Limit]) -> Figure:
    """The error of S against the number of beads, and against the stiffness of the perimeter."""
    figure, axes = _new(4.3, 1, 2)
    left, right = axes[0]
    for each, shade in zip(found, _shades(len(found)), strict=True):
        number = f"n = {each.sides}, slope {each.number_rate:.2f}"
        left.plot(each.numbers, -each.number_error, "o", color=shade, label=number)
        left.plot(each.numbers, -each.number_prediction, color=shade, linewidth=1.0)
        stiffness = f"n = {each.sides}, slope {each.stiffness_rate:.2f}"
        right.plot(each.stiffness, -each.stiffness_error, "o", color=shade, label=stiffness)
        right.plot(each.stiffness, -each.stiffness_prediction, color=shade, linewidth=1.0)
    left.set(xlabel="number of beads $N_v$", ylabel=r"$1 - S/Ka^2$ at infinite $k_P$")
    right.set(xlabel=r"$k_P/k_A R_0^2$", ylabel=r"share of $k_P$ in $1 - S/Ka^2$")
    _plain_ticks(left, found[0].numbers)
    _plain_ticks(right, found[0].stiffness)
    left.set_title(r"line: $\pi^2/3N_v^2 a$", fontsize=10)
    right.set_title(r"lines: $k_A q^2/k_P$", fontsize=10)
    left.legend(fontsize=8)
    right.legend(fontsize=8)
    figure.suptitle(rf"regular polygons, $a/R_0 = {found[0].indentation:g}$, walls slip")
    return figure


def _plain_ticks(ax: Axes, values: Iterable[float]) -> None:
    """Logarithmic axes with ticks at these x, as plain numbers."""
    ax.set(xscale="log", yscale="log")
    ax.set_xticks(list(values))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_minor_formatter(NullFormatter())


def packing(comparisons: Mapping[str, Comparison]) -> Figure:
    """The outlines of models over the beads: the whole box, and a few particles of it.

    Args:
        comparisons: of one packing with models, by name: sector, ring, soft ring, balanced.
    """
    beads = next(iter(comparisons.values())).beads
    box = beads.packing.box
    figure, axes = _new(4.8, 1, 2)
    middle = 0.5 * box.sum(axis=0)
    half = 1.3 * beads.packing.radii.max() + 0.12 * np.sqrt(np.linalg.det(box))
    half = min(half, 0.5 * float(box.diagonal().min()))
    whole, zoom = axes[0]
    for ax in (whole, zoom):
        _packing(ax, comparisons, fine=ax is zoom)
        ax.set(aspect="equal", xticks=[], yticks=[])
    frame = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) @ box
    whole.add_patch(Polygon(frame, fill=False, edgecolor="0.5", linewidth=0.8))
    margin = 1.05 * beads.packing.radii.max()
    low, high = frame.min(axis=0) - margin, frame.max(axis=0) + margin
    whole.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    whole.add_patch(
        Rectangle(
            tuple(middle - half), 2 * half, 2 * half, fill=False, edgecolor="tab:green", zorder=5
        )
    )
    zoom.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
    for spine in zoom.spines.values():
        spine.set_edgecolor("tab:green")
    whole.set_axis_off()
    means = ", ".join(
        f"{name} {_short(float(each.shape_error.mean()))}" for name, each in comparisons.items()
    )
    figure.suptitle(f"{len(beads.packing)} rings, mean $I$: {means}", fontsize=9)
    figure.legend(*zoom.get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


def _packing(ax: Axes, comparisons: Mapping[str, Comparison], fine: bool) -> None:
    """Beads and outlines, with all periodic images that reach into the box."""
    beads = next(iter(comparisons.values())).beads
    points = _images(beads.outlines, beads.packing.box)
    dots = np.vstack(points)
    if fine:
        width = np.full(len(dots), 2.0 * beads.beads.radius)
        discs = EllipseCollection(
            width,
            width,
            np.zeros(len(dots)),
            units="xy",
            offsets=dots,
            offset_transform=ax.transData,
            facecolor="tab:red",
            alpha=0.15,
        )
        ax.add_collection(discs)
    ax.plot(*dots.T, **_BEADS, markersize=4.0 if fine else 0.6, label="beads", zorder=3)
    styles = _LAWS | _SOFTER
    for name, each in comparisons.items():
        outlines = [
            outline + center
            for outline, center in zip(
                ring_outlines(beads, each.state), beads.packing.positions, strict=True
            )
        ]
        closed = [np.vstack([line, line[:1]]) for line in _images(outlines, beads.packing.box)]
        lines = LineCollection(closed, linewidths=1.0 if fine else 0.4, label=name, **styles[name])
        lines.set_zorder(4)
        ax.add_collection(lines)


def _images(
    outlines: Iterable[NDArray[np.float64]], box: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """All periodic images of closed lines that reach into the box."""
    to_fraction = np.linalg.inv(box)
    images = []
    for outline in outlines:
        fraction = outline @ to_fraction
        low = np.floor(fraction.min(axis=0)).astype(int)
        high = np.floor(fraction.max(axis=0)).astype(int)
        for a in range(low[0], high[0] + 1):
            for b in range(low[1], high[1] + 1):
                images.append(outline - np.array([a, b]) @ box)
    return images

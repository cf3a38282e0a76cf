"""The paper's figures of one particle, from the data of `paper`, as Matplotlib figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter, NullLocator
from numpy.typing import NDArray

from validation.report.law_styles import BEAD, STYLES

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.axes import Axes

    from validation.report.paper import results as paper
    from validation.report.paper.single import Squeezed

# Deviations are magnified by a round factor so that the largest is this part of R.
_VISIBLE = 0.1

_I = r"shape error $I$"
_A = r"indentation $a/R_0$"

_MARKERS = "osD^vPX"

# Springs at least this stiff set the scale of the lower panel of `deviation`.
_STIFF = 1e4

# The laws of the paper's setting: both keep the perimeter.
_DRAWN = ("sector", "ring, kP inf")


def _new(height: float, rows: int = 1, columns: int = 1) -> tuple[Figure, NDArray[Any]]:
    """A figure 1200 pixels wide, and its axes."""
    figure = Figure(figsize=(8.0, height), dpi=150, layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False)


def _series(count: int) -> list[dict[str, Any]]:
    """Styles of a series of lines: a color of a scale, and a marker of its own."""
    shades = colormaps["viridis"](np.linspace(0.0, 0.88, count))
    return [
        {"color": tuple(shade), "marker": _MARKERS[n % len(_MARKERS)]}
        for n, shade in enumerate(shades)
    ]


def _decade(value: float) -> str:
    """1, 10, or 10^n as a formula without dollars."""
    power = np.log10(value)
    return f"10^{{{power:.0f}}}" if power > 1.5 and power % 1.0 == 0.0 else f"{value:g}"


def shapes(results: Sequence[Squeezed], stick: bool) -> Figure:
    """Beads in the polygons at the largest indentation, and magnified deviations of two laws.

    Each law is drawn at |v| + m (g - |v|) in the direction of each bead v: m times as far from the
    beads as it is. The factor m stands in each panel.
    """
    largest = max(result.indentation for result in results)
    chosen = [r for r in results if r.walls.stick == stick and r.indentation == largest]
    figure, axes = _new(5.9, 2, 3)
    for ax, result in zip(axes.flat, chosen, strict=True):
        _shape(ax, result)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    figure.suptitle(
        f"{chosen[0].reference.polygons.number[0]} beads, "
        rf"$k_L = {_decade(chosen[0].kL)}$, $a/R_0 = {largest:g}$, "
        f"walls {'stick' if stick else 'slip'}"
    )
    return figure


def _shape(ax: Axes, result: Squeezed) -> None:
    corners = _corners(result.walls.angle, 1.0 - result.indentation)
    ax.plot(*_closed(corners), color="0.7", linewidth=1.0, label="walls")
    beads = result.reference.outlines[0]
    ax.plot(*beads.T, ".", color=BEAD.color, markersize=2.5, label="beads")
    order = np.argsort(result.angle)
    out = np.column_stack([np.cos(result.angle), np.sin(result.angle)])
    factor = magnification(max(np.abs(result.deviation[law]).max() for law in _DRAWN))
    for law in _DRAWN:
        line = (beads - factor * result.deviation[law][:, None] * out)[order]
        style = STYLES[law]
        ax.plot(*_closed(line), color=style.color, linestyle=style.line, linewidth=1.0, label=law)
    text = [rf"deviations $\times$ {factor:g}"]
    text += [f"$I$ {law} = {short(result.shape_error(law))}" for law in _DRAWN]
    ax.text(0.0, 0.0, "\n".join(text), ha="center", va="center", fontsize=8.5)
    ax.set(xlim=(-1.15, 1.15), ylim=(-1.15, 1.15), aspect="equal")  # far corners are cut off
    ax.set_axis_off()


def magnification(largest: float, radius: float = 1.0) -> float:
    """The factor 1, 2 or 5 times a power of ten that makes the largest deviation visible."""
    if largest <= 0.0:
        return 1.0
    wanted = max(_VISIBLE * radius / largest, 1.0)
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= wanted))


def _closed(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """x and y of a closed line."""
    return np.vstack([points, points[:1]]).T


def short(value: float) -> str:
    """Two digits as a formula."""
    mantissa, power = f"{value:.1e}".split("e")
    return rf"${mantissa}\times 10^{{{int(power)}}}$"


def _corners(angle: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Corners of the polygon whose sides have these directions and this distance."""
    half = np.diff(angle, append=angle[0] + 2.0 * np.pi) / 2.0
    middle = angle + half
    return (height / np.cos(half))[:, None] * np.column_stack([np.cos(middle), np.sin(middle)])


def deviation(results: Sequence[Squeezed], indentation: float = 0.02) -> Figure:
    """|v| - g(theta) of the sector law along the outline, a line for each stiffness.

    The lower panel shows the stiffest rings with a larger scale.
    """
    chosen = [r for r in results if np.isclose(r.indentation, indentation)]
    figure, axes = _new(6.0, 2, 1)
    for result, style in zip(chosen, _series(len(chosen)), strict=True):
        turn = np.degrees(result.angle) % 360.0
        order = np.argsort(turn)
        label = rf"$k_L = {_decade(result.kL)}$"
        for ax, unit in zip(axes[:, 0], (1e-3, 1e-5), strict=True):
            difference = result.deviation["sector"][order] / unit
            spread = slice(0, None, max(len(order) // 18, 1))
            ax.plot(turn[order], difference, linewidth=0.9, color=style["color"])
            ax.plot(turn[order][spread], difference[spread], linestyle="none", **style, ms=3.5)
            ax.plot([], [], **style, linewidth=0.9, markersize=3.5, label=label)
    stiff = [r for r in chosen if r.kL >= _STIFF]
    stiffest = 1e5 * np.concatenate([r.deviation["sector"] for r in stiff or chosen[-1:]])
    margin = 0.1 * float(np.ptp(stiffest))
    axes[1, 0].set(
        xlabel=r"direction $\theta$ [degrees]",
        ylim=(min(stiffest.min(), 0.0) - margin, stiffest.max() + margin),
    )
    for ax, power in zip(axes[:, 0], (-3, -5), strict=True):
        ax.set(
            ylabel=rf"$(|\mathbf{{v}}| - g(\theta))/R_0$  [$10^{{{power}}}$]",
            xlim=(0.0, 360.0),
            xticks=range(0, 361, 60),
        )
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside right center", fontsize=8)
    figure.suptitle(
        rf"hexagon, $a/R_0 = {indentation:g}$, {chosen[0].reference.polygons.number[0]} beads, "
        "walls stick"
    )
    return figure


def error_by_indentation(results: Sequence[Squeezed]) -> Figure:
    """I of the sector law against a for each stiffness, and against the stiffness for several a.

    Dashed: the ring law, which has the stiffness of the springs.
    """
    figure, axes = _new(4.8, 1, 2)
    left, right = axes[0]
    stiffnesses = sorted({r.kL for r in results})
    for kL, style in zip(stiffnesses, _series(len(stiffnesses)), strict=True):
        line = [r for r in results if r.kL == kL]
        label = rf"$k_L = {_decade(kL)}$"
        _errors(left, [r.indentation for r in line], line, "sector", label=label, **style)
    left.set(xlabel=_A, ylabel=_I, yscale="log")
    depths = sorted({r.indentation for r in results})[1::2]
    for a, style in zip(depths, _series(len(depths)), strict=True):
        line = [r for r in results if r.indentation == a]
        label = rf"$a/R_0 = {a:g}$"
        stiffness = [r.kL for r in line]
        _errors(right, stiffness, line, "sector", label=label, **style)
        if a in depths[::-3]:
            dashed = style | {"linestyle": "--", "fillstyle": "none"}
            _errors(right, stiffness, line, "ring", label=label + ", ring", **dashed)
    right.set(xlabel=r"stiffness of the springs $k_L/k_A R_0^2$", ylabel=_I)
    right.set(xscale="log", yscale="log")
    spacing = float(results[0].reference.polygons.spacing[0])
    for ax in (left, right):
        ax.axhline(spacing**2 / 24.0, color="0.6", linestyle=":", linewidth=1.0)
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=8, ncols=3)
        ax.grid(alpha=0.3)
    right.text(1.0, spacing**2 / 22.0, "$L_0^2/24R_0$: spacing of the beads", fontsize=7.5)
    figure.suptitle(f"hexagon, {results[0].reference.polygons.number[0]} beads, walls stick")
    return figure


def _errors(ax: Axes, x: Iterable[float], line: Iterable[Squeezed], law: str, **style: Any) -> None:
    ax.plot(list(x), [r.shape_error(law) for r in line], markersize=3.5, linewidth=1.1, **style)


def limits(found: Sequence[paper.Limit]) -> Figure:
    """The error of S against the number of beads, and against the stiffness of the perimeter."""
    figure, axes = _new(4.3, 1, 2)
    left, right = axes[0]
    for each, style in zip(found, _series(len(found)), strict=True):
        shade = style["color"]
        number = f"n = {each.sides}, slope {each.number_rate:.2f}"
        points = style | {"linestyle": "none"}
        left.plot(each.numbers, -each.number_error, **points, label=number)
        left.plot(each.numbers, -each.number_prediction, color=shade, linewidth=1.0)
        stiffness = f"n = {each.sides}, slope {each.stiffness_rate:.2f}"
        right.plot(each.stiffness, -each.stiffness_error, **points, label=stiffness)
        right.plot(each.stiffness, -each.stiffness_prediction, color=shade, linewidth=1.0)
    left.set(xlabel="number of beads $N_v$", ylabel=r"$1 - S/Ka^2$ at infinite $k_P$")
    right.set(xlabel=r"$k_P/k_A R_0^2$", ylabel=r"share of $k_P$ in $1 - S/Ka^2$")
    _plain_ticks(left, found[0].numbers)
    _plain_ticks(right, found[0].stiffness)
    left.set_title(r"line: expected, $\pi^2/3N_v^2 a$", fontsize=10)
    right.set_title(r"lines: expected, $k_A q^2/k_P$", fontsize=10)
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

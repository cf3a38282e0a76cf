"""Friction of two polygons, hysteresis of a packing, and the error of a crystal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from validation.report.law_styles import POLYGON_NAMES, POLYGONS, SMOOTH, legend_below

if TYPE_CHECKING:
    from collections.abc import Sequence

Row = dict[str, Any]


def roughness(friction: Sequence[Row], hysteresis: Sequence[Row], crystal: Sequence[Row]) -> Figure:
    """Friction of two polygons, hysteresis of a packing, and the error of a crystal."""
    figure = Figure(figsize=(10.0, 3.8), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    for kind, style in POLYGONS.items():
        look = {"marker": style.marker, "color": style.color, "label": POLYGON_NAMES[kind]}
        same = sorted(
            (r for r in friction if r["smooth"] == (kind == "smooth")), key=lambda r: r["n_v"]
        )
        left.loglog([r["n_v"] for r in same], [r["friction"] for r in same], **look)
        path = [r for r in hysteresis if r["smooth"] == (kind == "smooth")]
        middle.plot([100 * r["strain"] for r in path], [r["ratio"] for r in path], **look)
    left.set(xlabel="vertices of a polygon", ylabel="friction over normal force")
    middle.set(xlabel="strain beyond jamming [%]", ylabel="energy back over energy forth")
    middle.axhline(1.0, color="0.6", linewidth=0.8)
    for indentation, line in zip(sorted({r["indentation"] for r in crystal}), "-:", strict=False):
        same = [r for r in crystal if r["indentation"] == indentation]
        right.loglog(
            [r["n_v"] for r in same],
            [abs(r["energy_ratio"] - 1.0) for r in same],
            SMOOTH.marker + line,
            color=SMOOTH.color,
            label=f"a/R = {100 * indentation:g} %",
        )
    right.set(xlabel="vertices of a polygon", ylabel="error of the energy of a crystal")
    right.legend(fontsize=8)
    numbers = sorted({r["n_v"] for r in (*friction, *crystal)})
    for ax in (left, right):
        ax.set_xticks(numbers, [str(n) for n in numbers])
        ax.set_xticks([], minor=True)
    for ax in (left, middle, right):
        ax.grid(which="major", alpha=0.3)
    legend_below(figure, left)
    return figure

"""Error and run time of each method, and the balanced law along compressions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from validation.report.accuracy.errors import BARS, CONVERGED, energy_errors, label, whole
from validation.report.law_styles import (
    POLYGON_NAMES,
    POLYGONS,
    SMOOTH,
    STYLES,
    Style,
    legend_below,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

Row = dict[str, Any]


def accuracy(rows: Sequence[Row], pareto: Sequence[Row]) -> Figure:
    """How wrong the energy of each law is at each strain, and how long each method takes.

    Left: a point for each packing, a line through their medians. Right: bars.
    """
    figure = Figure(figsize=(10.0, 4.4), layout="constrained")
    error, time = figure.subplots(1, 2, width_ratios=(3, 2))
    for law, style in STYLES.items():
        wrong = energy_errors(rows, law)
        if not wrong:
            continue
        x = [100.0 * strain for strain in wrong]
        middle = [np.median(each) for each in wrong.values()]
        error.plot(x, middle, linestyle=style.line, color=style.color, linewidth=1.2)
        for strain, each in zip(x, wrong.values(), strict=True):
            error.plot([strain] * len(each), each, style.marker, color=style.color, markersize=4.5)
        name = law if law != "sector" else "sector, at the polygons' centers"
        error.plot([], [], style.marker, color=style.color, linestyle=style.line, label=name)
    error.set(
        xlabel="strain beyond jamming [%]",
        ylabel="error of the energy",
        yscale="log",
    )
    for part in sorted(set(BARS.values())):
        error.axhline(part, color="0.6", linewidth=0.8, linestyle=":")
        error.text(0.02, part, f" {100 * part:g} %", fontsize=8, color="0.4", va="bottom")
    error.set_xlim(left=0.0)
    error.grid(alpha=0.3)

    timed = [row for row in pareto if row["seconds"] is not None]
    timed.sort(key=lambda row: row["seconds"])
    y = np.arange(len(timed))[::-1]
    seconds = [row["seconds"] for row in timed]
    bars = time.barh(y, seconds, color=[_style(row["method"]).color for row in timed])
    time.bar_label(bars, [f"{s:.2g} s" for s in seconds], padding=3, fontsize=8)
    time.set_yticks(y, [label(row) for row in timed], fontsize=8)
    time.set(
        xscale="log",
        xlabel=f"processor time, compressed by {100 * timed[0]['strain']:g} % [s]",
    )
    time.set_xlim(0.5 * min(seconds), 8.0 * max(seconds))
    legend_below(figure, error)
    return figure


def _style(method: str) -> Style:
    return SMOOTH if method == "reference" else (POLYGONS | STYLES)[method]


def _kind(row: Row) -> str:
    """The reference is the finest of the smooth polygons."""
    return "smooth" if row["method"] == "reference" else str(row["method"])


def pareto(rows: Sequence[Row]) -> Figure:
    """Errors of energies and of areas against seconds, one point per law, polygons joined."""
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    panels = figure.subplots(1, 2, sharex=True)
    labels = {"energy_error": "error of the energy", "error": "error of the area deficits (rms)"}
    for ax, (key, name) in zip(panels, labels.items(), strict=True):
        known = [row for row in rows if row[key] and row["seconds"] is not None]
        for kind, style in POLYGONS.items():
            line = [row for row in known if _kind(row) == kind]
            x, y = [row["seconds"] for row in line], [row[key] for row in line]
            ax.loglog(
                x, y, style.marker, color=style.color, linestyle="-", label=POLYGON_NAMES[kind]
            )
            for row in line:
                ax.annotate(
                    f"{row['vertices']}",
                    (row["seconds"], row[key]),
                    textcoords="offset points",
                    xytext=(-5, -4) if kind == "smooth" else (5, 3),
                    ha="right" if kind == "smooth" else "left",
                    va="top" if kind == "smooth" else "bottom",
                    color=style.color,
                    fontsize=8,
                )
        for row in known:
            if _kind(row) not in POLYGONS:
                style = STYLES[row["method"]]
                ax.loglog(
                    row["seconds"],
                    row[key],
                    style.marker,
                    color=style.color,
                    markersize=11 if style.marker == "*" else 7,
                    linestyle="none",
                    label=row["method"],
                )
        balanced = next(row for row in rows if row["method"] == "balanced")
        ax.axhline(balanced[key], color=STYLES["balanced"].color, linewidth=0.8, linestyle=":")
        ax.set(xlabel="processor time [s]", ylabel=name)
        ax.margins(0.12)
        ax.grid(which="major", alpha=0.3)
    legend_below(figure, panels[1])
    return figure


def compressions(rows: Sequence[Row]) -> Figure:
    """The balanced law along compressions, a column for each packing, and all laws' centers.

    Steps at which the reference has not converged are left out.
    """
    rows = whole(rows)
    seeds = sorted({row["seed"] for row in rows})
    numbers = sorted({row["n_v"] for row in rows})
    figure = Figure(figsize=(max(3.4 * len(seeds), 6.0), 6.4), layout="constrained")
    panels = figure.subplots(3, len(seeds), sharex=True, sharey="row", squeeze=False)
    own = [row for row in rows if row["own"]]
    balanced = STYLES["balanced"]
    fills = dict(zip(numbers[::-1], (balanced.color, "white"), strict=False))
    for column, seed in zip(panels.T, seeds, strict=True):
        for ax, key in zip(column[:2], ("energy_ratio", "pressure_ratio"), strict=True):
            ax.axhline(1.0, color=SMOOTH.color, linewidth=1.0)
            for count in numbers:
                path = [
                    row
                    for row in own
                    if (row["law"], row["seed"], row["n_v"]) == ("balanced", seed, count)
                ]
                known = [row[key] is not None and row["residual"] <= CONVERGED for row in path]
                ax.plot(
                    [100.0 * row["strain"] for row in path],
                    [row[key] if there else np.nan for row, there in zip(path, known, strict=True)],
                    balanced.marker,
                    color=balanced.color,
                    markerfacecolor=fills.get(count, "0.7"),
                    linestyle="-",
                    linewidth=0.8,
                    markersize=8,
                )
            ax.set_ylim(0.985, 1.04)
            ax.grid(alpha=0.3)
        _allowed(column[0])
        these = [row for row in own if row["seed"] == seed]
        most = max(row["n_v"] for row in these)
        _distances(column[2], [row for row in these if row["n_v"] == most])
        column[0].set_title(f"packing {seed}", fontsize=10)
        column[2].set_xlabel("strain beyond jamming [%]")
    names = ("energy", "pressure")
    for ax, name in zip(panels[:2, 0], names, strict=True):
        ax.set_ylabel(f"{name}, balanced\nover smooth polygons")
    panels[2, 0].set_ylabel("distance of the centers\n(rms) over R")
    handles = [
        Line2D(
            *([], []),
            color=balanced.color,
            marker=balanced.marker,
            markerfacecolor=fills.get(count, "0.7"),
            markersize=8,
            label=f"balanced, against {count} vertices",
        )
        for count in numbers
    ]
    handles += [
        Line2D([], [], color=STYLES[law].color, marker=STYLES[law].marker, ls="-", label=law)
        for law in STYLES
        if law != "balanced" and any(row["law"] == law for row in own)
    ]
    handles.append(Line2D([], [], color="0.3", linestyle=":", label="mean overlap"))
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def _allowed(ax: Any) -> None:
    """The errors that are allowed, as a band."""
    low = 0.0
    for strain, part in BARS.items():
        ax.fill_between([100 * low, 100 * strain], 1 - part, 1 + part, color="0.9", linewidth=0)
        low = strain


def _distances(ax: Any, rows: Sequence[Row]) -> None:
    strains = np.array(sorted({row["strain"] for row in rows}))
    for law in dict.fromkeys(row["law"] for row in rows):
        style, path = STYLES[law], [row for row in rows if row["law"] == law]
        y = [np.nan if row["distance"] is None else row["distance"] for row in path]
        x = [100.0 * row["strain"] for row in path]
        ax.semilogy(x, y, style.marker, color=style.color, linestyle="-", lw=0.8, markersize=5)
    ax.plot(100.0 * strains, 2.0 * strains, ":", color="0.3")
    ax.grid(alpha=0.3)

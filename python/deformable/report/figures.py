"""Figures of the report beside the paper's: one color, marker and order for each law."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..engine.relaxation import TOLERANCE
from ..studies.law_styles import BEADS, STYLES


def pareto(rows: Sequence[dict[str, Any]]) -> Figure:
    """Errors of areas and of outlines against seconds, one point per method, beads joined.

    Hollow: laws that did not converge, and the rings of which the reference is made.
    """
    figure = Figure(figsize=(10.0, 4.8), layout="constrained")
    panels = figure.subplots(1, 2, sharex=True)
    labels = {"error": "area error (rms, relative)", "shape_error": "shape error (mean, over R)"}
    beads = [row for row in rows if row["method"] == "beads"]
    free = [row for row in beads if not row["reference"]]
    for ax, (key, label) in zip(panels, labels.items(), strict=True):
        x, y = [row["seconds"] for row in free], [row[key] for row in free]
        ax.loglog(x, y, "o-", color=BEADS.color, label="rings of beads")
        for n, row in enumerate(beads):
            if row["reference"]:
                ax.loglog(row["seconds"], row[key], "o", color=BEADS.color, fillstyle="none")
            below = n % 2 == 0  # neighbors may be close: below and above the falling line in turn
            ax.annotate(
                f"{row['beads']}",
                (row["seconds"], row[key]),
                textcoords="offset points",
                xytext=(1, -5) if below else (0, 4),
                ha="right" if below else "left",
                va="top" if below else "bottom",
                color=BEADS.color,
                fontsize=8,
            )
        for row in rows:
            if row["method"] == "beads":
                continue
            style = STYLES[row["method"]]
            converged = row.get("residual", 0.0) <= TOLERANCE
            ax.loglog(
                row["seconds"],
                row[key],
                style.marker,
                color=style.color,
                fillstyle="full" if converged else "none",
                markersize=9,
                linestyle="none",
                label=row["method"] + ("" if converged else ", not converged"),
            )
        ax.set(xlabel="processor time of a strain step [s]", ylabel=label)
        ax.margins(0.12)
        ax.grid(which="major", alpha=0.3)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=6)
    return figure


def packings(rows: Sequence[dict[str, Any]]) -> Figure:
    """Shape and area errors of each law, a point for each packing."""
    figure = Figure(figsize=(10.0, 4.4), layout="constrained")
    panels = figure.subplots(1, 2)
    cases = list(dict.fromkeys(_case(row) for row in rows))
    laws = [law for law in STYLES if any(row["law"] == law for row in rows)]
    labels = {"I": "shape error I", "S_rms": "area error (rms, relative)"}
    for ax, (key, label) in zip(panels, labels.items(), strict=True):
        for n, law in enumerate(laws):
            chosen = [row for row in rows if row["law"] == law and row[key] is not None]
            x = [cases.index(_case(row)) + 0.12 * (n - (len(laws) - 1) / 2) for row in chosen]
            style = STYLES[law]
            y = [row[key] for row in chosen]
            ax.plot(x, y, style.marker, color=style.color, markersize=6, label=law)
        ax.set_xticks(range(len(cases)), cases, fontsize=8)
        ax.set(ylabel=label, yscale="log")
        ax.margins(x=0.1)
        ax.grid(axis="y", which="major", alpha=0.3)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=6)
    return figure


def _case(row: dict[str, Any]) -> str:
    return f"{row['n']} rings\n{row['beads']} beads\n{100 * row['strain']:g} % strain"


def compressions(rows: Sequence[dict[str, Any]]) -> Figure:
    """Energy and centers of each law along compressions, a column for each packing.

    Hollow: law and beads are on different branches.
    """
    seeds = list(dict.fromkeys(row["seed"] for row in rows))
    figure = Figure(figsize=(max(3.4 * len(seeds), 6.0), 5.6), layout="constrained")
    panels = figure.subplots(2, len(seeds), sharex=True, sharey="row", squeeze=False)
    labels = {
        "energy_ratio": "energy of the law\nover that of the beads",
        "centers_rms": "distance of the centers\n(rms) over R",
    }
    laws = [law for law in STYLES if any(row["law"] == law for row in rows)]
    for column, seed in zip(panels.T, seeds, strict=True):
        for ax, (key, label) in zip(column, labels.items(), strict=True):
            for law in laws:
                _path(ax, [r for r in rows if (r["law"], r["seed"]) == (law, seed)], key)
            ax.grid(alpha=0.3)
            if seed == seeds[0]:
                ax.set_ylabel(label)
        column[0].axhline(1.0, color=BEADS.color, linewidth=1.0)
        column[0].set_title(f"packing {seed}", fontsize=10)
        strain = np.array(sorted({row["strain"] for row in rows}))
        column[1].plot(100.0 * strain, 2.0 * strain, ":", color="0.3")
        column[1].set_xlabel("strain beyond jamming [%]")
    for ax in panels[:, 0]:  # once all columns that share it are drawn
        ax.set_ylim(bottom=0.0)
    handles = [
        Line2D([], [], color=STYLES[law].color, marker=STYLES[law].marker, label=law)
        for law in laws
    ]
    handles += [
        Line2D([], [], color=BEADS.color, label="rings of beads"),
        Line2D([], [], color="0.3", linestyle=":", label="mean overlap"),
    ]
    columns = len(handles) if len(seeds) > 2 else 3
    figure.legend(handles=handles, loc="outside upper center", ncols=columns)
    return figure


def _path(ax: Any, path: Sequence[dict[str, Any]], key: str) -> None:
    """A line of one law in one packing, with hollow points where the branches differ."""
    style = STYLES[path[0]["law"]]
    x = np.array([100.0 * row["strain"] for row in path])
    y = np.array([np.nan if row[key] is None else row[key] for row in path])
    ax.plot(x, y, style.marker, color=style.color, linestyle="-", linewidth=0.8, markersize=6)
    other = ~np.array([row["same_branch"] for row in path])
    ax.plot(x[other], y[other], style.marker, color="white", markersize=2.5, linestyle="none")


def cost(rows: Sequence[dict[str, Any]]) -> Figure:
    """Run time per particle and step of each law, and the extra time of each option."""
    figure = Figure(figsize=(10.0, 3.6), layout="constrained")
    bare, extra = figure.subplots(1, 2)
    laws = [law for law in STYLES if any(row["law"] == law for row in rows)]
    plain = {row["law"]: row["on"] for row in rows if row["option"] == "none"}
    y = np.arange(len(laws))[::-1]
    bars = bare.barh(y, [plain[law] for law in laws], color=_colors(laws))
    bare.bar_label(bars, fmt="%.0f", padding=3, fontsize=9)
    bare.set_yticks(y, laws)
    bare.margins(x=0.12)
    bare.set(xlabel="processor time [ns per particle and step]", title="bare scene")
    options = list(dict.fromkeys(row["option"] for row in rows if row["option"] != "none"))
    for n, law in enumerate(laws):
        chosen = [row for row in rows if row["law"] == law and row["option"] != "none"]
        if not chosen:
            continue
        place = [-options.index(row["option"]) - 0.15 * (n - len(laws) / 2) for row in chosen]
        style = STYLES[law]
        x = [row["extra"] for row in chosen]
        extra.plot(x, place, style.marker, color=style.color, markersize=7, label=law)
    extra.set_yticks([-n for n in range(len(options))], options)
    extra.axvline(0.0, color="0.5", linewidth=0.8)
    extra.grid(axis="x", alpha=0.3)
    extra.set(xlabel="extra processor time [ns per particle and step]", title="each option")
    extra.legend(fontsize=8, loc="center right")
    return figure


def _colors(laws: Iterable[str]) -> list[str]:
    return [STYLES[law].color for law in laws]

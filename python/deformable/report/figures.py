"""Pictures of the report that the paper does not have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

# Colour and marker of each method.
_STYLES = {
    "disk": ("tab:gray", "o"),
    "sector": ("black", "s"),
    "ring": ("tab:blue", "D"),
    "soft ring": ("tab:green", "^"),
    "balanced": ("tab:orange", "*"),
}

# A relaxation that ends above this residual has not converged.
CONVERGED = 1e-6


def pareto(rows: Sequence[dict[str, Any]]) -> Figure:
    """Errors of areas and of outlines against seconds, one point a method, beads joined.

    Hollow: laws that did not converge, and the rings that the reference is made of.
    """
    figure = Figure(figsize=(10.0, 4.8), layout="constrained")
    panels = figure.subplots(1, 2, sharex=True)
    labels = {
        "error": "error of the area deficits (rms, relative)",
        "shape_error": "error of the outline, over R",
    }
    beads = [row for row in rows if row["method"] == "beads"]
    free = [row for row in beads if not row["reference"]]
    for ax, (key, label) in zip(panels, labels.items(), strict=True):
        ax.loglog(
            [row["seconds"] for row in free],
            [row[key] for row in free],
            "o-",
            color="tab:red",
            label="rings of beads",
        )
        for row in beads:
            if row["reference"]:
                ax.loglog(row["seconds"], row[key], "o", color="tab:red", fillstyle="none")
            ax.annotate(
                f"{row['beads']}",
                (row["seconds"], row[key]),
                textcoords="offset points",
                xytext=(0, 8),
                ha="center",
                color="tab:red",
                fontsize=8,
            )
        for row in rows:
            if row["method"] == "beads":
                continue
            color, marker = _STYLES[row["method"]]
            converged = row.get("residual", 0.0) <= CONVERGED
            ax.loglog(
                row["seconds"],
                row[key],
                marker,
                color=color,
                fillstyle="full" if converged else "none",
                markersize=9,
                linestyle="none",
                label=row["method"] + ("" if converged else ", not converged"),
            )
        ax.set(xlabel="processor time of a strain step [s]", ylabel=label)
        ax.margins(0.1)
        ax.grid(which="major", alpha=0.3)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=6)
    return figure


def packings(rows: Sequence[dict[str, Any]]) -> Figure:
    """Shape and area errors of each law, a point for each packing."""
    figure = Figure(figsize=(10.0, 4.4), layout="constrained")
    panels = figure.subplots(1, 2)
    cases = list(dict.fromkeys(_case(row) for row in rows))
    for ax, key, label in zip(
        panels,
        ("I", "S_rms"),
        ("shape error I", "error of the area deficits (rms, relative)"),
        strict=True,
    ):
        for k, (model, (color, marker)) in enumerate(_STYLES.items()):
            chosen = [row for row in rows if row["model"] == model]
            x = [cases.index(_case(row)) + 0.12 * (k - 2) for row in chosen]
            y = [row[key] for row in chosen]
            ax.plot(x, y, marker, color=color, linestyle="none", markersize=6, label=model)
        ax.set_xticks(range(len(cases)), cases, fontsize=8)
        ax.set(ylabel=label, yscale="log")
        ax.grid(axis="y", which="both", alpha=0.3)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=5)
    return figure


def ablation(rows: Sequence[dict[str, Any]]) -> Figure:
    """Cost of a particle and a step, and what each option adds."""
    figure = Figure(figsize=(8.0, 4.2), layout="constrained")
    ax = figure.subplots()
    labels = [
        row["law"] if row["option"] == "none" else f"{row['law']}: + {row['option']}"
        for row in rows
    ]
    y = np.arange(len(rows))[::-1]
    base = [row["on"] if row["option"] == "none" else row["off"] for row in rows]
    extra = [0.0 if row["option"] == "none" else max(row["extra"], 0.0) for row in rows]
    ax.barh(y, base, color="0.75", label="without")
    ax.barh(y, extra, left=base, color="tab:red", label="added")
    ax.set_yticks(y, labels, fontsize=8)
    ax.set(xlabel="processor time [ns per particle and step]")
    ax.legend()
    return figure


def _case(row: dict[str, Any]) -> str:
    return f"N = {row['n']}\n{row['beads']} beads\n{100 * row['strain']:g} %"

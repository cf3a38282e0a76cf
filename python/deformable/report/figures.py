"""Pictures of the report that the paper does not have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

_MARKERS = {"disk": "o", "sector": "s", "ring": "D", "soft ring": "^"}


def pareto(rows: Sequence[dict[str, Any]]) -> Figure:
    """Errors of areas and of outlines against seconds, one point a method, beads joined."""
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    panels = figure.subplots(1, 2, sharex=True)
    labels = {
        "error": "error of the area deficits (rms, relative)",
        "shape_error": "error of the outline, over R",
    }
    beads = [row for row in rows if row["method"] == "beads"]
    for ax, (key, label) in zip(panels, labels.items(), strict=True):
        ax.loglog(
            [row["seconds"] for row in beads],
            [row[key] for row in beads],
            "o-",
            color="0.4",
            label="bead rings",
        )
        for row in beads:
            ax.annotate(
                f"{row['beads']}",
                (row["seconds"], row[key]),
                textcoords="offset points",
                xytext=(6, 6),
                color="0.4",
                fontsize=9,
            )
        for row in rows:
            if row["method"] != "beads":
                ax.loglog(
                    row["seconds"],
                    row[key],
                    _MARKERS[row["method"]],
                    markersize=9,
                    label=row["method"],
                )
        ax.set(xlabel="processor time of a converged strain step [s]", ylabel=label)
        ax.grid(which="major", alpha=0.3)
    panels[0].legend()
    return figure


def packings(rows: Sequence[dict[str, Any]]) -> Figure:
    """Shape and area errors of each law in every packing."""
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    panels = figure.subplots(1, 2)
    models = list(dict.fromkeys(row["model"] for row in rows))
    cases = list(dict.fromkeys(_case(row) for row in rows))
    width = 0.8 / len(models)
    for ax, key, label in zip(
        panels,
        ("I", "S_rms"),
        ("shape error I", "error of the area deficits (rms, relative)"),
        strict=True,
    ):
        for k, model in enumerate(models):
            values = {_case(row): row[key] for row in rows if row["model"] == model}
            x = np.arange(len(cases)) + width * (k - 0.5 * (len(models) - 1))
            ax.bar(x, [values.get(case, np.nan) for case in cases], width, label=model)
        ax.set_xticks(np.arange(len(cases)), cases, fontsize=8)
        ax.set(ylabel=label)
        ax.set_yscale("log")
        ax.grid(axis="y", alpha=0.3)
    panels[0].legend()
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
    return f"N={row['n']}, {row['beads']} beads\n{100 * row['strain']:g} %, seed {row['seed']}"

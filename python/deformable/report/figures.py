"""Pictures of the report that the paper does not have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..studies.single import Squeezed

# Color and marker of each method.
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
        for k, (law, (color, marker)) in enumerate(_STYLES.items()):
            chosen = [row for row in rows if row["law"] == law]
            x = [cases.index(_case(row)) + 0.12 * (k - 2) for row in chosen]
            y = [row[key] for row in chosen]
            ax.plot(x, y, marker, color=color, linestyle="none", markersize=6, label=law)
        ax.set_xticks(range(len(cases)), cases, fontsize=8)
        ax.set(ylabel=label, yscale="log")
        ax.grid(axis="y", which="both", alpha=0.3)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=5)
    return figure


def compressions(rows: Sequence[dict[str, Any]]) -> Figure:
    """Energy, pressure and centers of each law along whole compressions, a line a packing.

    Hollow: on another branch than the beads.
    """
    figure = Figure(figsize=(11.0, 4.2), layout="constrained")
    panels = figure.subplots(1, 3, sharex=True)
    labels = {
        "energy_ratio": "energy over the beads'",
        "pressure_ratio": "pressure over the beads'",
        "centers_rms": "distance of the centers (rms) over R",
    }
    for ax, (key, label) in zip(panels, labels.items(), strict=True):
        for law, seed in dict.fromkeys((row["law"], row["seed"]) for row in rows):
            path = [row for row in rows if (row["law"], row["seed"]) == (law, seed)]
            color, marker = _STYLES[law]
            x = np.array([100.0 * row["strain"] for row in path])
            y = np.array([np.nan if row[key] is None else row[key] for row in path])
            same = np.array([row["same_branch"] for row in path])
            name = law if seed == rows[0]["seed"] else None
            ax.plot(x, y, marker, color=color, linestyle="-", linewidth=0.8, label=name)
            ax.plot(x[~same], y[~same], marker, color="white", markersize=3, linestyle="none")
        ax.set(xlabel="strain beyond jamming [%]", ylabel=label)
        ax.set_ylim(bottom=0.0)
        ax.grid(alpha=0.3)
    for ax in panels[:2]:
        ax.axhline(1.0, color="tab:red", linewidth=1.0)
    panels[2].plot(x, 2.0 * x / 100.0, ":", color="0.3", label="mean overlap")
    panels[2].legend(handles=panels[2].lines[-1:])
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def catching(rows: Sequence[dict[str, Any]]) -> Figure:
    """The balanced law's energy over that of rings: by number of beads, and as they relax.

    Hollow: rings on another branch than the law.
    """
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    by_number, by_force = figure.subplots(1, 2, sharey=True)
    styles = {"strained": ("tab:red", "s", 0.97), "placed": ("tab:blue", "o", 1.03)}
    last = min(row["tolerance"] for row in rows)
    for row in (row for row in rows if row["energy_ratio"] is not None):
        color, marker, beside = styles[row["start"]]
        fill = "full" if row["same_branch"] else "none"
        style = {"color": color, "marker": marker, "fillstyle": fill, "linestyle": "none"}
        if row["tolerance"] == last:
            by_number.semilogx(beside * row["beads"], row["energy_ratio"], **style)
        by_force.semilogx(row["net_force"], row["energy_ratio"], markersize=4, **style)
    numbers = sorted({row["beads"] for row in rows})
    by_number.set_xticks(numbers, [f"{number}" for number in numbers])
    by_number.minorticks_off()
    by_number.set(xlabel="beads on a small ring", ylabel="energy of the balanced law over beads'")
    by_force.set(xlabel="largest force on a ring over the mean contact force")
    by_force.invert_xaxis()
    for ax in (by_number, by_force):
        ax.axhline(1.0, color="0.3", linewidth=1.0)
        ax.grid(alpha=0.3)
    for start, (color, marker, _) in styles.items():
        by_number.plot([], [], marker, color=color, label=start)
    by_number.legend(loc="lower right")
    return figure


def any_stiffness(results: Sequence[Squeezed]) -> Figure:
    """I of the ring laws against the stiffness of the springs, darker for larger indentations."""
    figure = Figure(figsize=(8.0, 4.4), layout="constrained")
    ax = figure.subplots()
    depths = sorted({result.indentation for result in results})
    labels = {"ring": "perimeter conserved", "soft ring": "finite stiffness, kP = kL/N_v"}
    for law, label in labels.items():
        color, marker = _STYLES[law]
        for k, a in enumerate(depths, start=1):
            line = [result for result in results if result.indentation == a]
            ax.loglog(
                [result.kL for result in line],
                [result.shape_error(law) for result in line],
                marker=marker,
                color=color,
                alpha=k / len(depths),
                label=label if a == depths[-1] else None,
            )
    rings = results[0].beads.rings
    ax.axhline(rings.spacing[0] ** 2 / 24.0, color="0.6", linestyle=":", label="L0²/24R0: spacing")
    ax.set(xlabel="stiffness of the springs kL/kA R0²", ylabel="shape error I")
    ax.set_title(
        f"hexagon, {rings.number[0]} beads, walls slip, a/R0 = "
        + ", ".join(f"{a:g}" for a in depths),
        fontsize=10,
    )
    ax.legend()
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

"""Pictures of ensembles at and above the onset of jamming."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from .packings import (
    QUANTITIES,
    Row,
    by_packing,
    excess_phi,
    exponents,
    groups,
    is_significant,
    standard_error,
    summarize,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LABELS = {
    "pressure": "pressure $p$",
    "shear_modulus": "shear modulus $G$",
    "coordination": r"$z - z_\mathrm{iso}$",
}


def onset(rows: Sequence[Row]) -> Figure:
    """phi_J and the contacts beyond isostaticity over the number of particles."""
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    panels = figure.subplots(1, 2)
    summary = summarize(rows)
    sizes = sorted({row["number"] for row in summary})
    for law, pressure in dict.fromkeys((row["law"], row["onset_pressure"]) for row in summary):
        chosen = [row for row in summary if (row["law"], row["onset_pressure"]) == (law, pressure)]
        for ax, name in zip(panels, ("phi", "excess_contacts"), strict=True):
            ax.errorbar(
                [row["number"] for row in chosen],
                [row[name] for row in chosen],
                [row[f"{name}_error"] for row in chosen],
                marker="o",
                capsize=3,
                label=f"{law}, $p$ from {pressure:g}",
            )
    panels[0].set(ylabel=r"$\phi_J$")
    panels[1].set(ylabel=r"$N_\mathrm{contacts} - (2N' - 1)$")
    for ax in panels:
        ax.set(xlabel="number of particles $N$", xscale="log")
        ax.set_xticks(sizes, [str(size) for size in sizes])
        ax.minorticks_off()
        ax.grid(which="major", alpha=0.3)
    panels[0].legend()
    return figure


def scaling(rows: Sequence[Row]) -> Figure:
    """Pressure, shear modulus and coordination over phi - phi_J, with the fitted exponents."""
    figure = Figure(figsize=(13.0, 4.4), layout="constrained")
    panels = dict(zip(_LABELS, figure.subplots(1, len(_LABELS)), strict=True))
    fitted = exponents(rows)
    for (key, group), fit in zip(groups(rows).items(), fitted, strict=True):
        law, _, number = key
        for name, ax in panels.items():
            slope = f"{fit[name]:.2f} ± {fit[f'{name}_error']:.2f}"
            _means(ax, group, QUANTITIES[name], f"{law}, $N$ = {number}: {slope}")
    for name, ax in panels.items():
        ax.set(xlabel=r"$\phi - \phi_J$", ylabel=_LABELS[name], xscale="log", yscale="log")
        ax.grid(which="major", alpha=0.3)
        ax.legend(title="exponent", fontsize=8)
    return figure


def _means(ax: Axes, rows: Sequence[Row], quantity: Callable[[Row], float], label: str) -> None:
    """Draw means over packings with their standard errors, and the fitted line."""
    y = by_packing(rows, quantity)
    x, mean = np.nanmean(by_packing(rows, excess_phi), axis=0), np.nanmean(y, axis=0)
    error = [standard_error(column[np.isfinite(column)]) for column in y.T]
    (points, *_) = ax.errorbar(x, mean, error, fmt="o", capsize=3, label=label)
    fitted = is_significant(y)
    x, mean = x[fitted], mean[fitted]
    if len(x) > 1:
        line = np.polyfit(np.log(x), np.log(mean), 1)
        ax.plot(x, np.exp(np.polyval(line, np.log(x))), color=points.get_color(), linewidth=1.0)

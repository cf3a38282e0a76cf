"""Pictures of the modes and moduli of packings above jamming."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from .ensemble import Row
from .vibrations import EDGES, density, summarize


def vibrations(rows: Sequence[Row]) -> Figure:
    """Density of states of each law, and frequencies and moduli over phi - phi_J."""
    laws = list(dict.fromkeys(row["law"] for row in rows))
    figure = Figure(figsize=(4.6 * (len(laws) + 2), 4.2), layout="constrained")
    *spectra, frequencies, moduli = figure.subplots(1, len(laws) + 2)
    middle = np.sqrt(EDGES[1:] * EDGES[:-1])
    for law, ax in zip(laws, spectra, strict=True):
        steps = sorted({row["wanted"] for row in rows if row["law"] == law})
        colors = colormaps["viridis"](np.linspace(0.0, 0.9, len(steps)))
        for step, color in zip(steps, colors, strict=True):
            these = [row for row in rows if (row["law"], row["wanted"]) == (law, step)]
            found, error = density(these)
            there = found > 0.0
            ax.errorbar(
                middle[there], found[there], error[there], color=color, label=f"{step:g}", lw=1.2
            )
        ax.set(
            title=law,
            xlabel=r"$\omega / \sqrt{k/m}$",
            ylabel=r"density of states $D(\omega)$",
            xscale="log",
            yscale="log",
        )
        ax.legend(title=r"$\phi - \phi_J$", fontsize=8)
    summary = summarize(rows)
    for law, number in dict.fromkeys((row["law"], row["number"]) for row in summary):
        chosen = [row for row in summary if (row["law"], row["number"]) == (law, number)]
        at = [row["excess_phi"] for row in chosen]
        label = f"{law}, $N$ = {number}"
        for name, marker in (("omega_star", "o"), ("boson_peak", "x")):
            y, bars = ([row[f"{name}{end}"] for row in chosen] for end in ("", "_error"))
            shown = {"omega_star": r"$\omega^*$", "boson_peak": "boson peak"}[name]
            frequencies.errorbar(at, y, bars, fmt=marker, label=f"{shown}, {label}")
        ratio, bars = (
            [row[f"shear_modulus{end}"] / row["bulk_modulus"] for row in chosen]
            for end in ("", "_error")
        )
        moduli.errorbar(at, ratio, bars, fmt="o", label=label)
    reached = [row["excess_phi"] for row in summary]
    ends = np.array([min(reached), max(reached)])
    frequencies.plot(ends, np.sqrt(ends), "k--", lw=0.8, label="slope 1/2")
    moduli.plot(ends, np.sqrt(ends), "k--", lw=0.8, label="slope 1/2")
    frequencies.set(ylabel=r"frequency / $\sqrt{k/m}$")
    moduli.set(ylabel="$G/K$")
    for ax in (frequencies, moduli):
        ax.set(xlabel=r"$\phi - \phi_J$", xscale="log", yscale="log")
        ax.legend(fontsize=7)
    return figure

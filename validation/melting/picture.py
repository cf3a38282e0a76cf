"""The picture of a result of melting.py."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection

from validation.melting.motion import crystal
from validation.melting.order import neighbors
from validation.melting.results import CRYSTAL, curve, late, mean, stages, value

STYLES = {"crystal": ("C0", "-", "heated"), "random": ("C3", ":", "cooled")}
MARKS = "os^D"


def draw(data, file):
    """Order, susceptibility, pressure, correlations, stiffness, and packings with their defects."""
    found = {key: legs for key, legs in stages(data).items() if key[1] == data["phi"]}
    places = data.get("places", [])
    figure, axes = plt.subplots(2 + bool(places), 3, figsize=(12, 10), layout="constrained")
    if not places:
        figure.set_figheight(7)
    numbers = sorted({number for number, *_ in found})
    for ax, name, label in (
        (axes[0, 0], "psi_6", r"$|\Psi_6|$; small marks: part with defects"),
        (axes[0, 1], "susceptibility", "susceptibility"),
        (axes[0, 2], "p", "p"),
    ):
        over_temperature(ax, found, numbers, name)
        ax.set(xlabel="T", ylabel=label)
    axes[0, 1].set_yscale("log")
    figure.suptitle(f"phi = {data['phi']:g}", fontsize=10)
    axes[0, 0].legend(frameon=False, fontsize=8)
    largest = {key: legs for key, legs in found.items() if key[0] == numbers[-1]}
    for ax, name, power, label in (
        (axes[1, 0], "g6", 4, r"$g_6(r)$"),
        (axes[1, 1], "positional", 3, r"$g_K(r)$"),
    ):
        over_distance(ax, largest, name, power)
        ax.set(xlabel="r/R", ylabel=label, ylim=(0.01, 1.2), xlim=(1.8, None))
        ax.set_xticks([2, 5, 10, 20], ["2", "5", "10", "20"])
        ax.minorticks_off()
    axes[1, 0].legend(frameon=False, fontsize=7, ncols=2)
    for number, mark in zip(numbers, MARKS, strict=False):
        some = {
            key[-1]: legs for key, legs in found.items() if key[0::2][:2] == (number, "crystal")
        }
        kept = [t for t, legs in some.items() if mean(late(legs), "bragg") > CRYSTAL]
        values = np.reshape([value(some[t], "Y a^2/T") for t in kept], (-1, 2))
        axes[1, 2].errorbar(kept, *values.T, fmt=f"{mark}-", color="C0", label=f"N = {number}")
    axes[1, 2].axhline(16.0 * np.pi, color="k", lw=1, label=r"$16\pi$")
    axes[1, 2].set(xlabel="T", ylabel=r"$Y a^2/T$", yscale="log")
    axes[1, 2].legend(frameon=False, fontsize=8)
    for ax, one in zip(axes[-1], places, strict=False):
        packing(ax, np.array(one["places"]), data["phi"])
        ax.set_title(f"T = {one['T']:g}, {STYLES[one['start']][2]}", fontsize=9)
    figure.savefig(file, dpi=75)


def over_temperature(ax, found, numbers, name):
    for number, mark in zip(numbers, MARKS, strict=False):
        for start, (color, dashes, told) in STYLES.items():
            some = {t: legs for (n, _, s, _, t), legs in found.items() if (n, s) == (number, start)}
            t = sorted(some)
            values = np.reshape([value(some[each], name) for each in t], (-1, 2))
            style = {"fmt": mark + dashes, "color": color}
            ax.errorbar(t, *values.T, **style, ms=4, label=f"N = {number}, {told}")
            if name == "psi_6":
                wrong = [value(some[each], "defects")[0] for each in t]
                ax.errorbar(t, wrong, **style, ms=2, lw=0.5)


def over_distance(ax, found, name, power):
    """A correlation at each temperature, and the power law -1/power."""
    temperatures = sorted({key[-1] for key in found})
    for (_, _, start, _, temperature), legs in found.items():
        color = plt.cm.viridis(temperatures.index(temperature) / max(len(temperatures) - 1, 1))
        r, g = curve(late(legs), name)
        told = f"T = {temperature:g}" if start == "crystal" else None
        ax.loglog(r, np.where(g > 0.005, g, np.nan), STYLES[start][1], color=color, label=told)
    far = np.array([3.5, r[-1]])
    ax.loglog(far, 0.9 * (far / far[0]) ** (-1.0 / power), "k-", lw=2, label=f"power -1/{power}")


def packing(ax, places, phi):
    """Particles with five neighbors red, with seven blue."""
    box = crystal(len(places), phi).box.diagonal()
    sides = np.bincount(np.concatenate(neighbors(places, box)), minlength=len(places))
    width = np.full(len(places), 2.0)
    colors = np.where(sides < 6, "C3", np.where(sides > 6, "C0", "0.85"))
    disks = EllipseCollection(
        width, width, 0.0 * width, units="xy", offsets=places % box, transOffset=ax.transData
    )
    disks.set_facecolor(colors)
    ax.add_collection(disks)
    ax.set(xlim=(0, box[0]), ylim=(0, box[1]), aspect="equal", xticks=[], yticks=[])

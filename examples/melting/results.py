"""Tables with errors and the picture of a result of melting.py.

python results.py small.json

The first half of the legs is left out. Errors come from leaving out one of the others after
another (jackknife), so they are right if order is forgotten within a leg.
"""

import argparse
import json
import math
from pathlib import Path

import deformable
import matplotlib.pyplot as plt
import numpy as np

COLORS = {"crystal": "C0", "random": "C3"}


def runs(data):
    """The legs of each number, temperature and start, in the order of time.

    Those in which a droplet found no shape are left out.
    """
    found = {}
    for leg in (leg for leg in data["legs"] if "ended" not in leg):
        found.setdefault((leg["number"], leg["temperature"], leg["start"]), []).append(leg)
    return found


def late(legs):
    return legs[len(legs) // 2 :]


def series(legs, name):
    return np.concatenate([leg["series"][name] for leg in legs]).astype(float)


def order(legs):
    """|Psi_6| of each sample, the modulus of the mean over all particles."""
    return np.hypot(series(legs, "psi_x"), series(legs, "psi_y"))


def susceptibility(legs):
    """N (<|Psi_6|^2> - <|Psi_6|>^2)."""
    return legs[0]["number"] * order(legs).var()


def decay(legs):
    """eta_6 of g_6 ~ r^-eta_6, from the second shell of neighbors to half of the box."""
    r, g6 = np.array(legs[0]["r"]), np.mean([np.array(leg["g6"], float) for leg in legs], axis=0)
    far = (r > 3.5) & (g6 > 0.0)
    return -np.polyfit(np.log(r[far]), np.log(g6[far]), 1)[0] if far.sum() > 2 else math.nan


def apart(legs):
    """<(u_i - u_j)^2> / 2 a^2 of first neighbors after a leg."""
    return np.mean([leg["lindemann"] for leg in legs])


QUANTITIES = {
    "psi_6": lambda legs: order(legs).mean(),
    "susceptibility": susceptibility,
    "eta_6": decay,
    "defects": lambda legs: series(legs, "defects").mean(),
    "neighbors apart": apart,
    "z": lambda legs: series(legs, "z").mean(),
    "p": lambda legs: series(legs, "pressure").mean(),
    "energy": lambda legs: series(legs, "energy").mean(),
    "T over bath": lambda legs: series(legs, "bath").mean(),
    "beyond": lambda legs: series(legs, "beyond").mean(),
}


def value(legs, name):
    """Of the later half of the legs, with its error."""
    some = late(legs)
    if len(some) < 2:
        return float(QUANTITIES[name](some)), math.nan
    found, error = deformable.jackknife(QUANTITIES[name], some)
    return float(found), float(error)


def shown(found, error):
    """Both with as many decimals as the error has with two digits."""
    if not math.isfinite(found):
        return "–"
    if not error > 1e-9:
        return f"{found:.3g}"
    decimals = max(0, 1 - math.floor(math.log10(error)))
    return f"{found:.{decimals}f} ± {error:.{decimals}f}"


def table(data):
    """Means over the later half of each run."""
    yield f"| N | T | start | {' | '.join(QUANTITIES)} |"
    yield "|---" * (3 + len(QUANTITIES)) + "|"
    for (number, temperature, start), legs in runs(data).items():
        cells = [shown(*value(legs, name)) for name in QUANTITIES]
        yield "| " + " | ".join([f"{number}", f"{temperature:g}", start, *cells]) + " |"


def difference(one, other, name):
    """Of two runs, with its error."""
    (a, da), (b, db) = value(one, name), value(other, name)
    return a - b, math.hypot(da, db)


def start_table(data):
    """By how much a run from the crystal differs from one from random positions."""
    names = ("psi_6", "defects", "p", "energy")
    yield f"| N | T | {' | '.join(names)} |"
    yield "|---" * (2 + len(names)) + "|"
    found = runs(data)
    for number, temperature, start in found:
        if start == "crystal":
            both = [found[number, temperature, each] for each in COLORS]
            cells = [shown(*difference(*both, name)) for name in names]
            yield "| " + " | ".join([f"{number}", f"{temperature:g}", *cells]) + " |"


def seconds(data):
    return sum(leg["seconds"] for leg in data["legs"])


def summary(data):
    at = data["crystal"]
    told = [
        f"Crystal at rest: p = {at['pressure']:.4f}, G = {at['G']:.4f}, K = {at['K']:.3f}, "
        f"with which dislocations would unbind at T = {at['unbinding']:.3f}."
    ]
    for thin in data["dilute"]:
        told.append(
            f"Gas of phi = {thin['phi']:g}: p A/N T = {thin['z']:.4f} ± {thin['error']:.4f}, "
            f"by virial coefficients {thin['virial']:.4f}."
        )
    ended = sum("ended" in leg for leg in data["legs"])
    told.append(f"In {ended} runs a droplet found no shape.")
    return " ".join([*told, f"{seconds(data):.0f} s of processor time."])


def show(data):
    print(summary(data))
    for lines in (table, start_table):
        print("", lines.__doc__, *lines(data), sep="\n")


def draw(data, file):
    """Order over time, order and defects over temperature, g_6, and pressure."""
    found = runs(data)
    figure, axes = plt.subplots(2, 2, figsize=(9, 7), layout="constrained")
    (times, orders), (curves, pressures) = axes
    numbers = sorted({number for number, *_ in found})
    temperatures = sorted({temperature for _, temperature, _ in found})
    for (number, temperature, start), legs in found.items():
        if number == numbers[-1]:
            shade = plt.cm.viridis(temperatures.index(temperature) / max(len(temperatures) - 1, 1))
            psi, dashes = order(legs), "-" if start == "crystal" else ":"
            time = np.arange(1, len(psi) + 1) * legs[0]["time"] * len(legs) / len(psi)
            label = f"T = {temperature:g}" if start == "crystal" else None
            times.plot(time, psi, dashes, color=shade, lw=1, label=label)
            g6 = np.mean([np.array(leg["g6"], float) for leg in late(legs)], axis=0)
            curves.loglog(legs[0]["r"], np.where(g6 > 0.01, g6, np.nan), dashes, color=shade)
    r = np.array([3.5, max(legs[0]["r"][-1] for legs in found.values())])
    curves.loglog(r, 0.8 * (r / r[0]) ** -0.25, "k-", lw=2, label=r"$r^{-1/4}$")
    for number, mark in zip(numbers, "os^D", strict=False):
        for start, color in COLORS.items():
            at = [t for t in temperatures if (number, t, start) in found]
            for ax, name in ((orders, "psi_6"), (pressures, "p")):
                values = np.array([value(found[number, t, start], name) for t in at])
                label = f"N = {number}, {start}"
                ax.errorbar(at, *values.T, fmt=f"{mark}-", color=color, ms=4, label=label)
            values = [value(found[number, t, start], "defects")[0] for t in at]
            orders.plot(at, values, f"{mark}:", color=color, ms=3)
    times.set(xlabel="time", ylabel=r"$|\Psi_6|$; dotted: from random positions", ylim=(0, 1))
    orders.set(xlabel="T", ylabel=r"$|\Psi_6|$; dotted: part of particles with defects")
    curves.set(xlabel="r/R", ylabel=r"$g_6(r)$")
    pressures.set(xlabel="T", ylabel="p")
    for ax in (times, orders, curves):
        ax.legend(frameon=False, fontsize=8)
    figure.savefig(file, dpi=75)


def report(file):
    data = json.loads(Path(file).read_text())
    show(data)
    draw(data, Path(file).with_suffix(".png"))


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("file", type=Path, help="what melting.py has written")
    given = options.parse_args()
    if given.file.suffix != ".json" or not given.file.exists():
        options.error(f"{given.file} is no result: small.json, for example")
    report(given.file)

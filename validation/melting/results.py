"""Quantities with errors, tables and the picture of a result of melting.

    python -m validation.melting.results validation/melting/full.json

The first third of the legs at each temperature is left out. Errors come from leaving out one of the
others after another (jackknife), so they are right if order is forgotten within a leg.
"""

import argparse
import json
import math
from pathlib import Path

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection

from validation.melting.measure import crystal, neighbors

LEG = 240.0  # time, of melting.py
NEAR, FAR = 3.5, math.inf  # window of the exponents: from the second neighbors to half of the box
SMALLEST = 10.0  # half of a box that has exponents
CRYSTAL = 0.3  # particles have sites as long as "Bragg" is above


def stages(data):
    """The legs of each number, packing fraction, start, seed and temperature, in order of time.

    A single leg is a beginning, and is left out.
    """
    found = {}
    for ramp in data["ramps"]:
        for leg in ramp["legs"]:
            key = ramp["number"], ramp["phi"], ramp["start"], ramp["seed"], leg["T"]
            found.setdefault(key, []).append(leg | {"number": ramp["number"], "phi": ramp["phi"]})
    return {key: found[key] for key in sorted(found) if len(found[key]) > 1}


def late(legs):
    return legs[len(legs) // 3 :]


def mean(legs, name):
    return np.mean([leg[name] for leg in legs])


def order(legs):
    """|Psi_6| of each sample, the modulus of the mean over all particles."""
    psi = [np.hypot(leg["psi_x"], leg["psi_y"]) for leg in legs]
    return np.concatenate(psi)


def susceptibility(legs):
    """N (<|Psi_6|^2> - <|Psi_6|>^2)."""
    return legs[0]["number"] * order(legs).var()


def memory(legs):
    """Time in which |Psi_6| is forgotten: the integral of its autocorrelation up to its first 0."""
    psi = order(legs) - order(legs).mean()
    lags = np.array([np.mean(psi[: len(psi) - n] * psi[n:]) for n in range(len(psi) // 2)])
    end = int(np.argmax(lags <= 0.0)) or len(lags)
    step = LEG / len(legs[0]["psi_x"])
    return step * (lags[:end].sum() / lags[0] - 0.5)


def curve(legs, name):
    """r, and a correlation as the mean of legs; nan where there are no pairs."""
    found = np.array([leg[name] for leg in legs], float)
    return np.array(legs[0]["r"]), found.mean(axis=0)


def decay(legs, name, near=NEAR, far=FAR):
    """Exponent of a correlation ~ r^-eta in a window of r; nan in boxes that are too small."""
    r, g = curve(legs, name)
    some = (r > near) & (r < far) & (g > 0.0)
    if some.sum() < 4 or r[-1] < SMALLEST:
        return math.nan
    return -np.polyfit(np.log(r[some]), np.log(g[some]), 1)[0]


def apart(legs):
    """<(u_i - u_j)^2> / 2 a^2 of first neighbors after a leg."""
    return np.mean([leg["apart"][-1] for leg in legs])


def elastic(legs):
    """G, K, Y a^2/T and eta_K of waves in a crystal whose particles have sites.

    eta_K = T k^2 (K + 2 G)/(4 pi G (K + G)) at the shortest wave vector k of the lattice.
    """
    if mean(legs, "bragg") < CRYSTAL:
        return [math.nan] * 4
    temperature = legs[0]["T"]
    shear, both = (temperature / mean(legs, name) for name in ("across", "along"))
    square = 2.0 * math.pi / (math.sqrt(3.0) * legs[0]["phi"])  # of the spacing
    young = 4.0 * shear * (both - shear) / both
    eta = 4.0 * math.pi * temperature / (3.0 * square) * (both + shear) / (shear * both)
    return [shear, both - shear, young * square / temperature, eta]


QUANTITIES = {
    "psi_6": lambda legs: order(legs).mean(),
    "susceptibility": susceptibility,
    "eta_6": lambda legs: decay(legs, "g6"),
    "Bragg": lambda legs: mean(legs, "bragg"),
    "eta_K": lambda legs: decay(legs, "positional"),
    "neighbors apart": apart,
    "p": lambda legs: mean(legs, "pressure"),
    "energy": lambda legs: mean(legs, "energy"),
    "T over bath": lambda legs: mean(legs, "bath"),
    "beyond": lambda legs: mean(legs, "beyond"),
    "defects": lambda legs: mean(legs, "defects"),
    "dislocations": lambda legs: mean(legs, "dislocations"),
    "bound": lambda legs: mean(legs, "bound"),
    "larger": lambda legs: mean(legs, "larger"),
    "disclinations": lambda legs: mean(legs, "disclinations"),
    "G": lambda legs: elastic(legs)[0],
    "K": lambda legs: elastic(legs)[1],
    "Y a^2/T": lambda legs: elastic(legs)[2],
    "eta_K by moduli": lambda legs: elastic(legs)[3],
}


def value(legs, name):
    """Of the later legs, with its error; name is of a quantity, or a function of legs."""
    some, quantity = late(legs), QUANTITIES.get(name, name)
    if len(some) < 2:
        return float(quantity(some)), math.nan
    found, error = ld.jackknife(some, quantity)
    return float(found), float(error)


def shown(found, error=0.0):
    """Both with as many decimals as the error has with two digits."""
    if not math.isfinite(found):
        return "–"
    if not error > 1e-9:
        return f"{found:.3g}"
    decimals = max(0, 1 - math.floor(math.log10(error)))
    return f"{found:.{decimals}f} ± {error:.{decimals}f}"


def lines(names, rows):
    yield f"| {' | '.join(names)} |"
    yield "|---" * len(names) + "|"
    for row in rows:
        yield f"| {' | '.join(str(cell) for cell in row)} |"


def of_stages(data, names, some=lambda *key: True):
    """A row for each stage: its key, and quantities with errors."""
    head = ["N", "phi", "start", "seed", "T"]
    keys = [key for key in stages(data) if some(*key)]
    differ = [n for n in range(5) if n in (0, 4) or len({key[n] for key in keys}) > 1]
    rows = [
        [*(f"{key[n]:g}" if n != 2 else key[n] for n in differ)]
        + [shown(*value(stages(data)[key], name)) for name in names]
        for key in keys
    ]
    return lines([*(head[n] for n in differ), *names], rows)


ORDER = ("psi_6", "susceptibility", "eta_6", "Bragg", "eta_K", "neighbors apart")
THERMAL = ("p", "energy", "T over bath", "beyond")
DEFECTS = ("defects", "dislocations", "bound", "larger", "disclinations")
ELASTIC = ("G", "K", "Y a^2/T", "eta_K by moduli")


def main(data):
    """Ramps at the packing fraction that all sizes have."""
    return lambda number, phi, start, seed, temperature: phi == data["phi"]


def order_table(data):
    """Order."""
    return of_stages(data, ORDER, main(data))


def thermal_table(data):
    """Pressure, energy, temperature, and droplets that the law does not describe."""
    return of_stages(data, THERMAL, main(data))


def defect_table(data):
    """Defects over N."""
    return of_stages(data, DEFECTS, main(data))


def difference(one, other, name):
    """Of two runs, with its error."""
    (a, da), (b, db) = value(one, name), value(other, name)
    return a - b, math.hypot(da, db)


def start_table(data):
    """By how much a run from the crystal differs from one from random positions."""
    found = stages(data)
    rows = []
    for number, phi, start, seed, temperature in found:
        other = number, phi, "random", seed, temperature
        if start == "crystal" and other in found:
            both = found[number, phi, start, seed, temperature], found[other]
            cells = [shown(*difference(*both, name)) for name in ("psi_6", "defects", *THERMAL[:2])]
            rows.append([number, f"{temperature:g}", *cells])
    return lines(["N", "T", "psi_6", "defects", "p", "energy"], rows)


def seconds(data):
    return sum(leg["seconds"] for ramp in data["ramps"] for leg in ramp["legs"])


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
    ended = sum(ramp["ended"] for ramp in data["ramps"])
    told.append(f"In {ended} legs a droplet found no shape.")
    return " ".join([*told, f"{seconds(data):.0f} s of processor time."])


FEW_TABLES = (order_table, thermal_table, defect_table, start_table)


def show(data, tables=FEW_TABLES):
    print(summary(data))
    for table in tables:
        print("", table.__doc__, *table(data), sep="\n")


WINDOWS = ((3.5, 8.0), (3.5, 16.0), (3.5, math.inf), (8.0, math.inf))


def window_table(data):
    """Exponents of N = 1024 in windows of r."""
    names = [f"{near:g} to {far:g}".replace("inf", "L/2") for near, far in WINDOWS]
    rows = []
    for (number, phi, start, _, temperature), legs in stages(data).items():
        if number == 1024 and phi == data["phi"] and start == "crystal" and temperature > 0.05:
            found = [
                shown(*value(legs, lambda some, name=name, w=w: decay(some, name, *w)))
                for name in ("g6", "positional")
                for w in WINDOWS
            ]
            rows.append([f"{temperature:g}", *found])
    heads = [f"{eta}, {name}" for eta in ("eta_6", "eta_K") for name in names]
    return lines(["T", *heads], rows)


def between_sizes(legs, larger, squared):
    """Exponent of the size L: squared order ~ L^-eta, with its error."""
    (a, da), (b, db) = (value(each, squared) for each in (legs, larger))
    width = 0.5 * math.log(larger[0]["number"] / legs[0]["number"])
    return math.log(a / b) / width, math.hypot(da / a, db / b) / width


def size_table(data):
    """Exponents by size: <|Psi_6|^2> ~ L^-eta_6, Bragg ~ L^-eta_K, heated from the crystal."""
    found, rows = stages(data), []
    for number, phi, start, seed, temperature in found:
        larger = 4 * number, phi, start, seed, temperature
        if larger in found and start == "crystal":
            pair = found[number, phi, start, seed, temperature], found[larger]
            six = between_sizes(*pair, lambda legs: np.mean(order(legs) ** 2))
            bragg = between_sizes(*pair, "Bragg")
            chi = [shown(*value(legs, "susceptibility")) for legs in pair]
            rows.append(
                [f"{number} to {4 * number}", f"{temperature:g}", shown(*six), shown(*bragg), *chi]
            )
    return lines(["N", "T", "eta_6", "eta_K", "susceptibility", "of the larger"], rows)


def time_table(data):
    """Time at each temperature after its first third, and time in which |Psi_6| is forgotten."""
    rows = []
    for (number, phi, start, _, temperature), legs in stages(data).items():
        if phi == data["phi"]:
            some = late(legs)
            forgotten, whole = memory(some), LEG * len(some)
            rows.append(
                [
                    *(number, start, f"{temperature:g}"),
                    *(f"{each:.0f}" for each in (whole, forgotten, whole / forgotten)),
                ]
            )
    return lines(["N", "start", "T", "time", "forgotten in", "ratio"], rows)


def isotherm_table(data):
    """Over phi, at one temperature."""
    found = {}
    for ramp in data["ramps"]:
        found.setdefault((ramp["number"], ramp["start"]), set()).add(ramp["phi"])
    several = {key for key, phis in found.items() if len(phis) > 1}
    names = ("p", "energy", "psi_6", "susceptibility", "eta_6", "Bragg", "defects")
    at = {leg["T"] for r in data["ramps"] if r["phi"] != data["phi"] for leg in r["legs"]}
    return of_stages(
        data, names, lambda number, phi, start, seed, t: (number, start) in several and t in at
    )


def check_table(data):
    """Energy and pressure with other time steps, tolerances and laws, N = 256."""
    rows = [
        [
            *(f"{row['T']:g}", row["settings"]),
            *(shown(*row["energy"]), shown(*row["pressure"]), f"{row['microseconds']:.2g}"),
        ]
        for row in sorted(data["checks"], key=lambda row: row["T"])
    ]
    return lines(["T", "law, step, tolerance", "energy", "p", "microseconds"], rows)


def quench_table(data):
    """Crystals at rest; energies above theirs of packings from the bath, and parts with defects."""
    rows = {(row["law"], row["phi"]): [] for row in data["solids"]}
    for row in data["quenches"]:
        rows[row["law"], row["phi"]].append(row)
    cells = [
        [
            *(law, f"{phi:g}", f"{solid['G']:.3g}", f"{solid['K']:.3g}"),
            *(f"{solid['unbinding']:.2g}", f"{some[0]['crystal']:.4g}"),
            *(f"{100.0 * row['excess']:.1f} % ({100.0 * row['defects']:.0f} %)" for row in some),
        ]
        for solid, ((law, phi), some) in zip(data["solids"], rows.items(), strict=True)
    ]
    ends = [f"{row['start']}, T = {row['T']:g}" for row in next(iter(rows.values()))]
    return lines(["law", "phi", "G", "K", "T of unbinding", "energy", *ends], cells)


def cost_table(data):
    """Processor time of the ramps."""
    rows = []
    for number in sorted({ramp["number"] for ramp in data["ramps"]}):
        legs = [leg for r in data["ramps"] if r["number"] == number for leg in r["legs"]]
        seconds, steps = sum(leg["seconds"] for leg in legs), 4000 * number * len(legs)
        rows.append([number, len(legs), f"{seconds:.0f}", f"{1e6 * seconds / steps:.2g}"])
        rows[-1].append(f"{steps / seconds:.2g}")
    heads = ["N", "legs", "seconds", "microseconds a particle-step", "particle-steps a second"]
    return lines(heads, rows)


def elastic_table(data):
    """Moduli of the crystal at temperature, and Y a^2/T, which is 16 pi = 50.3 at melting."""
    return of_stages(
        data,
        ELASTIC,
        lambda number, phi, start, seed, t: start == "crystal" and phi == data["phi"],
    )


TABLES = (
    *FEW_TABLES,
    *(window_table, size_table, time_table, elastic_table, isotherm_table),
    *(check_table, quench_table, cost_table),
)


def report(file):
    """Print the tables of a result, and draw it."""
    found = json.loads(file.read_text())
    show(found, TABLES if "checks" in found else FEW_TABLES)
    draw(found, file.with_suffix(".png"))


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


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("file", type=Path, help="a result, such as full.json")
    report(options.parse_args().file)

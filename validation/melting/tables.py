"""Further tables of the full result: windows, sizes, one temperature, energies at rest, cost.

python tables.py full.json    prints all tables of docs/melting.md, and draws full.png
"""

import argparse
import json
import math
from pathlib import Path

import numpy as np

from validation.melting import picture, results
from validation.melting.results import decay, lines, of_stages, order, shown, stages, value

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
            some = results.late(legs)
            forgotten, whole = results.memory(some), results.LEG * len(some)
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
        results.ELASTIC,
        lambda number, phi, start, seed, t: start == "crystal" and phi == data["phi"],
    )


TABLES = (
    *results.TABLES,
    *(window_table, size_table, time_table, elastic_table, isotherm_table),
    *(check_table, quench_table, cost_table),
)


def report(file):
    """Print the tables of a result, and draw it."""
    found = json.loads(file.read_text())
    results.show(found, TABLES if "checks" in found else results.TABLES)
    picture.draw(found, file.with_suffix(".png"))


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("file", type=Path, help="what melting.py has written")
    given = options.parse_args()
    if given.file.suffix != ".json" or not given.file.exists():
        options.error(f"{given.file} is no result: full.json, for example")
    report(given.file)

"""Tables with errors and the picture of a result of disordered_crystals.py.

python results.py full.json

Errors come from leaving out one packing after another (jackknife).
"""

import argparse
import json
import math
from pathlib import Path

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

HALF, LOST = 0.5, 5.97  # psi_6 where order counts as lost; z below which contacts are
COLORS = {"disks": "C7", "rings": "C0", "soft rings": "C2", "droplets": "C3"}
NEAR = 0.05  # largest spread of powers


def column(ramps, name, way="up"):
    """One quantity, shape (packings, spreads); nan where it is not known."""
    return np.array([ramp[way][name] for ramp in ramps], dtype=float)


def groups(ramps):
    """Ramps of each law, phi and number, in this order."""
    found = {}
    for ramp in sorted(ramps, key=lambda ramp: (list(COLORS).index(ramp["law"]), ramp["phi"])):
        found.setdefault((ramp["law"], ramp["phi"], ramp["number"]), []).append(ramp)
    return dict(sorted(found.items(), key=lambda item: (item[0][2] != 1024, item[0][2])))


def crossing(x, values, level):
    """Where values first fall to a level, between two points; nan if they do not."""
    below = np.flatnonzero(np.asarray(values) < level)
    if not len(below) or below[0] == 0:
        return math.nan
    n = below[0]
    part = (values[n - 1] - level) / (values[n - 1] - values[n])
    return x[n - 1] + part * (x[n] - x[n - 1])


def line(ramps, name, level):
    """Spread at which a quantity of each packing falls to a level."""
    return [crossing(ramp["up"]["eta"], ramp["up"][name], level) for ramp in ramps]


def cost(ramps, at):
    """Energy of each packing on the way down over that of the crystal with the same sizes."""
    crystal = [np.interp(at, ramp["up"]["eta"], ramp["up"]["energy"]) for ramp in ramps]
    down = column(ramps, "energy", "down")[:, ramps[0]["down"]["eta"].index(at)]
    return down / crystal


def back(ramps):
    """Spread of each packing where order comes back on the way down; nan if it does not."""
    found = []
    for ramp in ramps:
        eta, psi = ramp["down"]["eta"], ramp["down"]["psi6"]
        found.append(crossing(eta, -np.array(psi), -HALF))
    return found


def mean(values):
    """Mean and standard error of numbers, one of each packing; both nan if one is not known."""
    if len(values) < 2:
        return float(np.mean(values)), math.nan
    found, error = ld.jackknife(list(values))
    return float(found), float(error)


def shown(value, error, digits=2):
    """Both with as many decimals as the error has with two digits."""
    if not math.isfinite(value):
        return "–"
    if not error > 1e-9 * abs(value):
        return f"{value:.3g}"
    decimals = max(0, digits - 1 - math.floor(math.log10(error)))
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def known(values):
    """Mean of those that are known, with their number if it is not all."""
    some = [value for value in values if math.isfinite(value)]
    told = shown(*mean(some)) if some else "–"
    return told if len(some) in (0, len(values)) else f"{told} ({len(some)} of {len(values)})"


def power(ramps, name):
    """Power of the spread with which a quantity leaves its value in the crystal, and its error."""
    eta = np.array(ramps[0]["up"]["eta"])
    kept = (eta > 0.0) & (eta <= NEAR)

    def slope(some):
        values = column(some, name).mean(axis=0)
        return np.polyfit(np.log(eta[kept]), np.log(np.abs(values - values[0])[kept]), 1)[0]

    return ld.jackknife(ramps, slope) if len(ramps) > 1 else (slope(ramps), math.nan)


def small_table(data):
    """Powers of small spreads, and displacements over those of linear response."""
    powers = "u^2 | 1 - psi_6 | 1 - Bragg | forces"
    yield f"| | phi | N | linear u^2/eta^2 | u^2 at 0.01 | at 0.05 | power of {powers} |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for (law, phi, number), ramps in groups(data["ramps"]).items():
        eta = ramps[0]["up"]["eta"]
        linear = np.array([ramp["linear_u2"] for ramp in ramps])
        u2 = column(ramps, "u2")
        ratios = [u2[:, eta.index(at)] / at**2 / linear for at in (0.01, 0.05)]
        cells = [shown(*mean(each)) for each in (linear, *ratios)]
        powers = [shown(*power(ramps, n)) for n in ("u2", "psi6", "bragg", "force_spread")]
        yield "| " + " | ".join([law, f"{phi:g}", f"{number}", *cells, *powers]) + " |"


def line_table(data):
    """Where contacts and order are lost, and come back."""
    names = (
        "contacts lost | psi_6 = 1/2 | Bragg = 1/2 | susceptibility | back | energy at 0.3 | 0.4"
    )
    yield f"| | phi | N | packings | {names} |"
    yield "|---|---|---|---|---|---|---|---|---|---|---|"
    for (law, phi, number), ramps in groups(data["ramps"]).items():
        cells = [
            known(line(ramps, "z", LOST)),
            known(line(ramps, "psi6", HALF)),
            known(line(ramps, "bragg", HALF)),
            f"{ramps[0]['up']['eta'][np.argmax(column(ramps, 'psi6').var(axis=0))]:g}",
            known(back(ramps)),
            *(known(cost(ramps, at)) for at in (0.3, 0.4)),
        ]
        yield "| " + " | ".join([law, f"{phi:g}", f"{number}", f"{len(ramps)}", *cells]) + " |"


def level_table(data):
    """The same with other levels, and how much packings differ."""
    yield "| | phi | N | z = 5.99 | 5.9 | psi_6 = 0.7 | 0.6 | 0.4 | standard deviation at 1/2 |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for (law, phi, number), ramps in groups(data["ramps"]).items():
        levels = [("z", 5.99), ("z", 5.9), ("psi6", 0.7), ("psi6", 0.6), ("psi6", 0.4)]
        cells = [known(line(ramps, *level)) for level in levels]
        width = np.std(line(ramps, "psi6", HALF), ddof=min(1, len(ramps) - 1))
        cells += [f"{width:.3f}" if math.isfinite(width) else "–"]
        yield "| " + " | ".join([law, f"{phi:g}", f"{number}", *cells]) + " |"


def stiffness_table(data):
    """Pressure and moduli over those of the crystal, of the packings that come first."""
    yield "| | phi | N | eta | psi_6 | z | p | G | K | G/K |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    first = data["ramps"][0]
    for (law, phi, number), ramps in groups(data["ramps"]).items():
        if (phi, number) != (first["phi"], first["number"]):
            continue
        eta = ramps[0]["up"]["eta"]
        moduli = {name: column(ramps, name) for name in ("pressure", "G", "K")}
        relative = {name: values / values[:, :1] for name, values in moduli.items()}
        relative["G/K"] = moduli["G"] / moduli["K"]
        for n in np.flatnonzero(np.isfinite(moduli["K"]).any(axis=0)):
            cells = [known(column(ramps, name)[:, n]) for name in ("psi6", "z")]
            cells += [known(values[:, n]) for values in relative.values()]
            yield "| " + " | ".join([law, f"{phi:g}", f"{number}", f"{eta[n]:g}", *cells]) + " |"


def impurity_table(data):
    """Mean of <u^2>/eta^2 over all packings by number of particles, and what e times more add."""
    numbers = sorted({row["number"] for row in data["impurities"]})
    heads = " | ".join(f"N = {number}" for number in numbers)
    yield f"| | phi | {heads} | slope over ln N |"
    yield "|---" * (len(numbers) + 3) + "|"
    found = {}
    for row in data["impurities"]:
        found.setdefault((row["law"], row["phi"]), {})[row["number"]] = row["u2"]
    for (law, phi), u2 in found.items():
        values = [u2[number] for number in numbers]
        cells = [f"{value:.4f}" for value in values]
        slope = (values[-1] - values[-2]) / math.log(numbers[-1] / numbers[-2])
        yield "| " + " | ".join([law, f"{phi:g}", *cells, f"{slope:.5f}"]) + " |"


def compression_table(data):
    """psi_6 at the least phi, at 0.94 on the way up, at the largest, and on the way down."""
    yield "| | N | eta | 0.92 | 0.94 | 0.98 | 0.94 | 0.92 |"
    yield "|---|---|---|---|---|---|---|---|"
    found = {}
    for row in data["compressions"]:
        found.setdefault((row["law"], row["number"], row["eta"]), []).append(row["psi6"])
    for (law, number, eta), psi in found.items():
        cells = [shown(*mean(np.array(psi)[:, n])) for n in (0, 2, 4, -3, -1)]
        yield "| " + " | ".join([law, f"{number}", f"{eta:g}", *cells]) + " |"


TABLES = (small_table, impurity_table, line_table, level_table, stiffness_table, compression_table)


def seconds(data):
    return sum(row["seconds"] for rows in data.values() for row in rows)


def show(data):
    for table in TABLES:
        print(table.__doc__, *table(data), sep="\n", end="\n\n")
    print(f"{seconds(data) / 60.0:.3g} minutes of processor time")


def draw(data, file):
    """Two packings of droplets, order up and down, contacts, the line, g_6, and displacements."""
    found, (phi, number) = groups(data["ramps"]), (data["ramps"][0][n] for n in ("phi", "number"))
    figure, axes = plt.subplots(2, 4, figsize=(15, 7.4), layout="constrained")
    (first, second, order, contacts), (lines, far, moved, stiff) = axes
    for ax, eta in ((first, 0.3), (second, 0.6)):
        draw_packing(ax, Path(file).with_name(f"packing_{number}_{eta:g}"), eta)
    for law, color in COLORS.items():
        ramps = found[law, phi, number]
        eta = np.array(ramps[0]["up"]["eta"])
        style = {"color": color, "ms": 3, "label": law}
        order.errorbar(eta, *errors(ramps, "psi6"), fmt="o-", **style)
        down = ramps[0]["down"]["eta"]
        order.plot(down, column(ramps, "psi6", "down").mean(axis=0), ":", color=color)
        contacts.errorbar(eta, *errors(ramps, "z"), fmt="o-", **style)
        linear = np.mean([ramp["linear_u2"] for ramp in ramps])
        moved.loglog(eta[1:], column(ramps, "u2").mean(axis=0)[1:], "o", **style)
        moved.loglog(eta[1:], linear * eta[1:] ** 2, "-", color=color, lw=0.8)
        ratio = (column(ramps, "G") / column(ramps, "K")).mean(axis=0)
        some = np.isfinite(ratio)
        stiff.plot(eta[some], (ratio / ratio[0])[some], "o-", **style)
        at = {}
        for (name, each, _), others in found.items():
            if name == law:
                at[each] = others if each not in at or len(others) >= len(at[each]) else at[each]
        for quantity, level, mark in (("psi6", HALF, "o-"), ("z", LOST, "s:")):
            points = [(each, *mean(line(at[each], quantity, level))) for each in sorted(at)]
            lines.errorbar(*np.transpose(points), fmt=mark, color=color, ms=4)
        for curve, dashes in zip(range(3), ("-", "--", ":"), strict=True):
            g6 = np.array([ramp["g6"][curve]["g6"] for ramp in ramps], dtype=float).mean(axis=0)
            far.plot(ramps[0]["g6"][curve]["r"], g6, dashes, color=color)
    order.axhline(HALF, color="k", lw=0.5)
    order.set(xlabel=r"$\eta$", ylabel=r"$|\psi_6|$, dotted: on the way down")
    contacts.set(xlabel=r"$\eta$", ylabel="z")
    lines.set(xlabel=r"$\phi$", ylabel=r"$\eta$ where $\psi_6 = 1/2$; dotted: contacts lost")
    spreads = ", ".join(f"{curve['eta']:g}" for curve in next(iter(found.values()))[0]["g6"])
    far.set(xlabel="r/R", ylabel=rf"$g_6(r)$ at $\eta$ = {spreads}")
    moved.set(xlabel=r"$\eta$", ylabel=r"$\langle u^2 \rangle/a^2$; lines: linear response")
    stiff.set(xlabel=r"$\eta$", ylabel="G/K over that of the crystal")
    order.legend(frameon=False)
    figure.savefig(file, dpi=75)


def errors(ramps, name):
    values = column(ramps, name)
    return values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(len(values))


def draw_packing(ax, folder, eta):
    if not folder.exists():
        ax.set_axis_off()
        return
    with ld.Run(folder).simulation() as sim:
        state = sim.state()
    order = np.abs(state.hexatic())
    state.plot(ax, title=rf"droplets, $\eta$ = {eta:g}, mean $|\psi_6|$ {order.mean():.2f}")


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("file", type=Path, help="what disordered_crystals.py has written")
    given = options.parse_args()
    if given.file.suffix != ".json" or not given.file.exists():
        options.error(f"{given.file} is no result: full.json, for example")
    result = json.loads(given.file.read_text())
    show(result)
    draw(result, given.file.with_suffix(".png"))

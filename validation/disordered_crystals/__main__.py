"""Disordered crystals: the sizes on a triangular lattice spread until its order is lost.

python -m validation.disordered_crystals           a minute: 144 particles at one phi
python -m validation.disordered_crystals --full    what docs/disordered_crystals.md has

Errors come from leaving out one packing after another (jackknife).
"""

import argparse
import itertools
import json
import math
import os
import time
import warnings
from pathlib import Path

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

from validation import options_of
from validation.ensembles import over_cores

# Particles have the mean radius 1. Disks have the contact stiffness 1. Rings have kA = 1, and keep
# their perimeter, or may stretch. Droplets keep their area, and have the line tension 1.
LAWS = {
    "disks": None,
    "rings": ld.Ring(kA=1.0, contact="curved"),
    "soft rings": ld.Ring(kA=1.0, kP=0.1, contact="curved"),
    "droplets": ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact="curved"),
}

# The spread eta of the sizes goes up, and then down.
UP = tuple(n / 100 for n in (0, 1, 2, 5, 10, 15, 20, 25, *range(30, 52, 3), 55, 60))
DOWN = (0.5, 0.4, 0.3, 0.2, 0.1, 0.0)
STIFFNESS_AT = (0.0, 0.1, 0.2, 0.3, 0.39, 0.48, 0.6)
DRAWN = (0.3, 0.45, 0.6)  # g_6 over the distance, and packings of the picture

# At one spread phi goes up, and down the same way.
SPREADS = (0.3, 0.4, 0.5)
PHIS = (0.92, 0.93, 0.94, 0.96, 0.98)

# Largest force over the mean contact force; and the spread of the linear response, which is off by
# a part of this size.
TOLERANCE, SMALL = 1e-4, 1e-5

QUICK = {
    "ramps": list(itertools.product(LAWS, (144,), (0.94,), (1, 2))),
    "compressions": list(itertools.product(("droplets",), (144,), (0.4,), (1, 2))),
    "impurities": list(itertools.product(LAWS, (64, 144), (0.94,))),
}
FULL = {
    "ramps": [
        (law, number, phi, seed)
        for number, phi, packings, laws in (
            (1024, 0.94, 8, LAWS),
            (1024, 0.97, 4, LAWS),
            (256, 0.92, 4, LAWS),
            (256, 0.94, 8, LAWS),
            (256, 0.97, 8, LAWS),
            (256, 0.99, 4, LAWS),
            (4096, 0.94, 2, LAWS),
        )
        for seed in range(1, packings + 1)
        for law in laws
    ],
    "compressions": list(itertools.product(LAWS, (144,), SPREADS, range(1, 5))),
    "impurities": list(itertools.product(LAWS, (64, 256, 1024, 4096), (0.94,))),
}


def crystal(number, phi):
    side = math.isqrt(number)
    return ld.crystal("hex", (side, side // 2), radius=1.0, phi=phi)


def sizes(number, seed):
    """u of each particle, uniform between -1/2 and 1/2."""
    return np.random.default_rng(seed).uniform(-0.5, 0.5, number)


def spread(packing, u, eta):
    """The packing with radii proportional to 1 + eta u; its box and phi stay."""
    radius = 1.0 + eta * u
    radius *= math.sqrt(len(packing) / np.sum(radius**2))
    return packing.replace(radii=radius)


def simulation(packing, law):
    return ld.Simulation(packing, law or ld.SoftContact())


def relaxed(packing, law):
    with simulation(packing, law) as sim:
        return sim.relax(TOLERANCE)


def relaxed_at(packing, u, eta, to, law):
    """At another spread than eta; by half of the step first where it leaves a particle no room."""
    try:
        return relaxed(spread(packing, u, to), law)
    except ld.LammpsError:
        if abs(to - eta) < 1e-3:
            raise
    middle = 0.5 * (eta + to)
    packing = relaxed_at(packing, u, eta, middle, law).packing
    return relaxed_at(packing, u, middle, to, law)


def linear_response(packing, law, u):
    """Displacements over eta in the limit of small eta, shape (N, 2): one step of Newton's."""
    with simulation(spread(packing, u, SMALL), law) as sim:
        hessian = sim.state().hessian()
    step = -hessian.response(hessian.gradient)[: hessian.size].reshape(-1, 2)
    return step / SMALL


def mean_square(displacements, packing):
    """In units of the spacing of the lattice, without the motion of all together."""
    spacing = packing.box[0, 0] / math.isqrt(len(packing))
    moved = displacements - displacements.mean(axis=0)
    return np.sum(moved**2) / len(packing) / spacing**2


def bragg_peaks(packing):
    """The three shortest wave vectors of the lattice, but for signs."""
    side, (lx, ly) = math.isqrt(len(packing)), packing.box.diagonal()
    return 2.0 * np.pi * side * np.array([[0.0, 1 / ly], [1 / lx, 0.5 / ly], [1 / lx, -0.5 / ly]])


def correlation(state):
    """Distances up to half of the box, and g_6."""
    return state.hexatic_correlation(20, 0.495 * state.packing.box.diagonal().min())


def measure(state, stiffness):
    """Order, motion from the lattice, contacts and forces, one number each; moduli if asked for."""
    packing, psi = state.packing, state.hexatic()
    r, g6 = correlation(state)
    forces = np.array([force for *_, force in state.graph().edges(data="force")])
    row = {
        "psi6": abs(psi.mean()),
        "local_psi6": np.abs(psi).mean(),
        "g6_far": np.nanmean(g6[r > 0.7 * r.max()]),
        "bragg": np.abs(state.density_waves(bragg_peaks(packing))).mean(),
        "u2": mean_square(state.nonaffine(crystal(len(packing), packing.phi)), packing),
        "force_spread": forces.std() / forces.mean(),
        "z": state.coordination,
        "shape": np.mean(getattr(state, "shape_parameter", 1.0)),
        "pressure": state.pressure,
        "energy": state.energy / len(packing),
        "residual": state.residual,
        "beyond": getattr(state, "beyond", 0),
        "G": math.nan,
        "K": math.nan,
    }
    if stiffness:
        try:
            moduli = state.moduli()
            row |= {"G": moduli.mean_shear_modulus, "K": moduli.bulk_modulus}
        except ld.ParameterError:  # a motion has no stiffness
            pass
    return row


def columns(rows):
    """A list for each name, of numbers with six digits; null where there is none."""
    return {
        name: [float(f"{row[name]:.6g}") if math.isfinite(row[name]) else None for row in rows]
        for name in rows[0]
    }


def ramp(law, number, phi, seed):
    """The sizes of a crystal spread, and become equal again."""
    warnings.simplefilter("ignore", ld.BeyondModelWarning)  # `beyond` counts
    start, u, packing = time.process_time(), sizes(number, seed), crystal(number, phi)
    found = {"law": law, "number": number, "phi": phi, "seed": seed}
    linear = mean_square(linear_response(packing, LAWS[law], u), packing)
    found |= {"linear_u2": float(f"{linear:.6g}"), "g6": []}
    last = 0.0
    for way, etas in (("up", UP), ("down", DOWN)):
        rows = []
        for eta in etas:
            state = relaxed_at(packing, u, last, eta, LAWS[law])
            packing, last = state.packing, eta
            stiffness = way == "up" and eta in STIFFNESS_AT and number <= 1024
            rows.append({"eta": eta, **measure(state, stiffness)})
            if way == "up" and eta in DRAWN:
                r, g6 = correlation(state)
                curve = columns([{"r": a, "g6": b} for a, b in zip(r, g6, strict=True)])
                found["g6"].append({"eta": eta, **curve})
                if (law, phi, seed) == ("droplets", 0.94, 1):
                    state.save(f"packing_{number}_{eta:g}", mode="w")
        found[way] = columns(rows)
    return found | {"seconds": round(time.process_time() - start, 1)}


def compression(law, number, eta, seed):
    """A crystal with spread sizes, compressed and expanded again."""
    warnings.simplefilter("ignore", ld.BeyondModelWarning)
    start, u, packing = time.process_time(), sizes(number, seed), crystal(number, PHIS[0])
    for step in np.arange(1, round(20 * eta)) / 20:
        packing = relaxed(spread(packing, u, step), LAWS[law]).packing
    packing, rows = spread(packing, u, eta), []
    for phi in (*PHIS, *PHIS[-2::-1]):
        state = relaxed(packing.at(phi), LAWS[law])
        packing = state.packing
        rows.append({"phi": phi, **measure(state, stiffness=False)})
    found = {"law": law, "number": number, "eta": eta, "seed": seed, **columns(rows)}
    return found | {"seconds": round(time.process_time() - start, 1)}


def impurity(law, number, phi):
    """Displacements around one particle of another size, and what they say of all sizes.

    All sites of a lattice are alike, and sizes are independent, with the variance 1/12 of u. So the
    mean of <u^2>/eta^2 over all packings is a twelfth of the sum of squares around one impurity.
    """
    start, packing = time.process_time(), crystal(number, phi)
    one = np.zeros(number)
    one[0] = 1.0
    total = number * mean_square(linear_response(packing, LAWS[law], one), packing)
    found = {"law": law, "number": number, "phi": phi, "u2": float(f"{total / 12.0:.6g}")}
    return found | {"seconds": round(time.process_time() - start, 1)}


# Tables with errors, and the picture.

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


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--full", action="store_true", help="the figures of the page")
    options.add_argument("--workers", type=int, help="calls at a time; one per core if omitted")
    options.add_argument(
        "--show", type=os.path.abspath, metavar="FILE", help="only show this result"
    )
    given = options_of(options, __file__)
    if given.show:
        data = json.loads(Path(given.show).read_text())
        show(data)
        draw(data, Path(given.show).with_suffix(".png"))
        return
    if given.workers is not None and given.workers < 1:
        options.error(f"--workers must be at least 1, not {given.workers}")
    plan, name = (FULL, "full") if given.full else (QUICK, "quick")
    # each ramp is kept as soon as it is measured: an interrupted run goes on from there
    data = {
        kind: over_cores(function, plan[kind], given.workers, f"{name}_kept")
        for kind, function in (
            ("ramps", ramp),
            ("compressions", compression),
            ("impurities", impurity),
        )
    }
    with open(f"{name}.json", "w") as file:
        json.dump(data, file, separators=(",", ":"))
    show(data)
    draw(data, f"{name}.png")


if __name__ == "__main__":
    main()

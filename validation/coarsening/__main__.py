"""Foams that age: how bubbles grow, in the plane and in space, from dry to wet.

python -m validation.coarsening --number 128 --foams 1

Each foam is kept in coarsening_NUMBER.json when it is there, and not measured again.
"""

import argparse
import json
import math
from pathlib import Path

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from lammps_deformable.protocols.coarsening import gas_flow
from scipy.stats import lognorm

from validation import options_of
from validation.ensembles import over_cores

# Dimension, packing fraction, thickness of films over the mean radius at first.
CASES = (
    (2, 0.98, 0.0),
    (2, 0.95, 0.02),
    (2, 0.90, 0.02),
    (2, 0.86, 0.02),
    (2, 0.70, 0.02),
    (3, 0.82, 0.02),
    (3, 0.72, 0.02),
    (3, 0.50, 0.02),
)
WIDTH = 0.3  # of the logarithm of radii at first
LEFT = 0.1  # part of the bubbles at the end
STATES = 30  # one where the number has fallen by equal factors
LATE = 0.4  # the part of the bubbles at which growth is measured from

BUBBLES = ld.Ring(kA=math.inf, kP=0, tension=1.0, contact="curved", reach=2.0)
DROPLETS = ld.Droplet(tension=1.0)


def start(dimension, phi, number, seed):
    """A foam at rest, and its law."""
    packing = ld.polydisperse(number, lognorm(WIDTH), dimension=dimension, seed=seed)
    law = BUBBLES if dimension == 2 else DROPLETS
    jammed = ld.jam(packing).packing
    if phi < jammed.phi:
        return jammed.at(phi), law
    with ld.Simulation(jammed, law) as sim:
        return sim.compress(phi=phi, steps=4, keep=False)[-1], law


def age(dimension, phi, thickness, number, seed):
    """The growth of one foam: a row where the number has fallen by equal factors.

    Times are in units of pi R^2/(permeability tension), with the mean radius R at first.
    """
    foam, law = start(dimension, phi, number, seed)
    radius = float(np.mean(foam.radii))
    unit = math.pi * radius**2
    rows, step = [], 0.25 * unit
    with ld.Simulation(foam, law) as sim:
        state = sim.relax()
        while True:
            rows.append(row_of(state, unit, radius))
            if len(state.packing) <= LEFT * number or len(rows) > 100 * STATES:
                break
            state = sim.coarsen(1.0, time=step, border=thickness * radius, keep=False)[-1]
            lost = math.log(rows[-1]["number"] / len(state.packing))
            step *= min(2.0, max(0.5, math.log(1.0 / LEFT) / STATES / max(lost, 1e-3)))
    case = {"dimension": dimension, "phi": phi, "thickness": thickness, "seed": seed}
    return case | {"number": number, "rows": rows}


def row_of(state, unit, radius):
    """What is measured in a state; radii in units of the mean one at first."""
    radii = state.radii / radius
    row = {
        "time": state.time / unit,
        "number": len(radii),
        "radius": radii.mean(),
        "sauter": np.sum(radii**3) / np.sum(radii**2),
        "width": radii.std() / radii.mean(),
        "rattlers": np.mean(state.rattlers),
        "coordination": state.coordination,
    }
    if state.packing.dimension == 2:
        row["slope"] = slope(state)
    return {name: float(value) for name, value in row.items()}


def slope(state):
    """dV/dt of a neighbor more, by least squares, over that of a dry foam."""
    flow, neighbors = gas_flow(state, 1.0), state.n_contacts
    counted = neighbors > 2
    if len(np.unique(neighbors[counted])) < 2:
        return math.nan
    return np.polyfit(neighbors[counted], flow[counted], 1)[0] / (2.0 * math.pi / 3.0)


def growth(foam):
    """The exponent of the radius over the time, and the mean width, late in the growth.

    R ~ (t - t0)^n has d ln(dt/dR)/d ln R = 1/n - 1, with no t0 to find: from a fit of t by powers,
    t = t0 + c R^(1/n), with the least squares.
    """
    late = [row for row in foam["rows"] if row["number"] <= LATE * foam["number"]]
    time, radius = (np.array([row[name] for row in late]) for name in ("time", "sauter"))

    def left(power):
        basis = np.column_stack([np.ones(len(radius)), radius**power])
        found = np.linalg.lstsq(basis, time, rcond=None)[0]
        return float(np.sum((basis @ found - time) ** 2))

    powers = np.arange(1.0, 6.0, 0.01)
    best = powers[np.argmin([left(power) for power in powers])]
    return 1.0 / best, float(np.mean([row["width"] for row in late]))


def lines(foams):
    """The table."""
    yield (
        "| dimension | phi | films over R | foams | exponent of R32 | width of radii | rattlers "
        "| slope over von Neumann's |"
    )
    yield "|" + "---|" * 8
    for case in CASES:
        some = [f for f in foams if (f["dimension"], f["phi"], f["thickness"]) == case]
        if not some:
            continue
        found = np.array([growth(foam) for foam in some])
        late = [row for f in some for row in f["rows"] if row["number"] <= LATE * f["number"]]
        rattlers = np.mean([row["rattlers"] for row in late])
        slopes = [row["slope"] for row in late if "slope" in row and not math.isnan(row["slope"])]
        slope = f"{np.mean(slopes):.2f}" if slopes and case[1] > 0.8 else ""
        mean = found.mean(axis=0)
        error = (
            found.std(axis=0, ddof=1) / math.sqrt(len(found)) if len(found) > 1 else [math.nan] * 2
        )
        yield (
            f"| {case[0]} | {case[1]} | {case[2]} | {len(some)} | {mean[0]:.2f} ± {error[0]:.2f} | "
            f"{mean[1]:.2f} | {rattlers:.2f} | {slope} |"
        )


def draw(foams, file):
    """Mean radii over the time."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for ax, dimension in zip(axes, (2, 3), strict=True):
        for n, case in enumerate(case for case in CASES if case[0] == dimension):
            some = [f for f in foams if (f["dimension"], f["phi"], f["thickness"]) == case]
            for k, foam in enumerate(some):
                time, radius = (
                    np.array([row[name] for row in foam["rows"]]) for name in ("time", "sauter")
                )
                label = f"phi = {case[1]:.2f}" if k == 0 else None
                ax.loglog(time[1:], radius[1:], f"C{n}", lw=1, label=label)
        ax.set(xlabel="time", ylabel="$R_{32}$", title="plane" if dimension == 2 else "space")
        ax.legend(frameon=False)
    figure.savefig(file, dpi=80)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=256, help="bubbles of a foam")
    parser.add_argument("--foams", type=int, default=2, help="of each case")
    parser.add_argument("--workers", type=int, help="foams at a time")
    asked = options_of(parser, __file__)
    file = Path(f"coarsening_{asked.number}.json")
    foams = json.loads(file.read_text()) if file.exists() else []
    known = {(f["dimension"], f["phi"], f["thickness"], f["seed"]) for f in foams}
    calls = [
        (*case, asked.number, seed)
        for seed in range(1, asked.foams + 1)
        for case in CASES
        if (*case, seed) not in known
    ]
    foams += over_cores(age, calls, asked.workers, file.with_suffix(".kept"))
    foams.sort(
        key=lambda one: (CASES.index((one["dimension"], one["phi"], one["thickness"])), one["seed"])
    )
    file.write_text(json.dumps(foams))
    print(*lines(foams), sep="\n")
    draw(foams, file.with_suffix(".png"))


if __name__ == "__main__":
    main()

"""Bubbles that stick: how much gas flows through films, over the liquid, by the contact angle.

    python -m validation.coarsening.angles

A film of the tension 2 g - w meets outlines at the contact angle theta, w = 2 g (1 - cos theta).
The rate is the mean of |dA/dt| over bubbles, with films alone, over permeability and tension g.
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
from validation.coarsening.__main__ import WIDTH
from validation.ensembles import over_cores

ANGLES = (0, 2.5, 5, 10)  # degrees
PHIS = (0.98, 0.96, 0.94, 0.92, 0.90, 0.88, 0.86, 0.84, 0.82, 0.80, 0.78)
TOLD = (0.98, 0.94, 0.90, 0.86, 0.82, 0.78)  # in the table


def bubbles(angle):
    """The law of bubbles of the line tension 1 that meet at this contact angle."""
    adhesion = 2.0 * (1.0 - math.cos(math.radians(angle)))
    return ld.Ring(kA=math.inf, kP=0, tension=1.0, contact="curved", adhesion=adhesion, reach=2.0)


def expand(angle, number, seed):
    """The rates of a foam that takes up liquid, from the driest one on."""
    jammed = ld.jam(ld.polydisperse(number, lognorm(WIDTH), seed=seed)).packing
    rates = []
    with ld.Simulation(jammed, bubbles(angle)) as sim:
        sim.compress(phi=PHIS[0], steps=6, keep=False)
        for phi in PHIS:
            state = sim.compress(phi=phi, steps=2, keep=False)[-1]
            rates.append(float(np.mean(np.abs(gas_flow(state, 1.0)))))
    return {"angle": angle, "seed": seed, "number": number, "rates": rates}


def rates_of(foams, angle):
    """The mean over foams and its error, at each phi."""
    found = np.array([foam["rates"] for foam in foams if foam["angle"] == angle])
    return found.mean(axis=0), found.std(axis=0, ddof=1) / math.sqrt(len(found))


def lines(foams):
    """The table: the rate at each contact angle."""
    yield "| liquid | " + " | ".join(f"{angle:g}°" for angle in ANGLES) + " |"
    yield "|---" * (len(ANGLES) + 1) + "|"
    for phi in TOLD:
        at = PHIS.index(phi)
        found = (rates_of(foams, angle) for angle in ANGLES)
        cells = (f"{mean[at]:.3f} ± {error[at]:.3f}" for mean, error in found)
        yield f"| {1.0 - phi:.2f} | " + " | ".join(cells) + " |"


def draw(foams, file):
    """Rates over the liquid fraction."""
    figure, ax = plt.subplots(figsize=(4.5, 3.4), layout="constrained")
    liquid = 1.0 - np.array(PHIS)
    for angle in ANGLES:
        mean, error = rates_of(foams, angle)
        ax.errorbar(liquid, mean, error, fmt="o-", ms=3, lw=1, label=f"{angle:g}°")
    ax.set(
        xlabel="liquid fraction",
        ylabel="mean |dA/dt|/(permeability g)",
        ylim=(0, None),
        xticks=(0.0, 0.05, 0.1, 0.15, 0.2),
    )
    ax.legend(title="contact angle", frameon=False)
    figure.savefig(file, dpi=80)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=256, help="bubbles of a foam")
    parser.add_argument("--foams", type=int, default=6, help="of each contact angle")
    parser.add_argument("--workers", type=int, help="foams at a time")
    asked = options_of(parser, __file__)
    seeds = range(1, asked.foams + 1)
    calls = [(angle, asked.number, seed) for angle in ANGLES for seed in seeds]
    foams = over_cores(expand, calls, asked.workers)
    Path("angles.json").write_text(json.dumps(foams) + "\n")
    print(*lines(foams), sep="\n")
    draw(foams, "angles.png")


if __name__ == "__main__":
    main()

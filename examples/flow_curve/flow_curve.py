"""Flow curves of an emulsion: its stress at several shear rates, and without rate.

A drag to the mean flow takes up energy, or the films between droplets.

python flow_curve.py                         64 droplets
python flow_curve.py --number 128            the figures of the README
"""

import argparse
import json
import math

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import curve_fit

# Droplets keep their area and have a line tension of 1. Stresses are given in units of tension/R0,
# with the mean radius R0. Where rates are 1 and a droplet moves by rate R0, its drag, or a film of
# the length R0, has a force of the tension.
DROPLETS = ld.Ring(kA=math.inf, kP=0.0, tension=1.0)
RADII, PHI, DRAG = (0.5, 0.7), 0.90, 5.0
R0 = np.mean(RADII)
FILMS = {
    "films": ld.Friction(0.0, kt=0.0, film=5.0),
    "films, square root": ld.Friction(0.0, kt=0.0, film=1.0, power=0.5),
}
UNITS = {"drag": 1.0 / (DRAG * R0)} | {
    by: (film.film * R0) ** (-1.0 / film.power) / R0 for by, film in FILMS.items()
}

RATES = (2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2)

BEGIN, BLOCK = 1.0, 1.0  # strain where the mean begins, and of a block
LONGER = 4.0  # fast runs cost less: they go up to this many times the strain of the slowest
STEP = 0.01  # strain between states


def prepare(number):
    """A packing at rest."""
    loose = ld.bidisperse(number, sizes=RADII, seed=1)
    jammed = ld.jam(loose, DROPLETS, pressure=1e-4 / R0).packing
    with ld.Simulation(jammed.at(PHI), DROPLETS) as sim:
        return sim.relax(1e-4)


def flow(state, by, rate, strain):
    """Strain, stress and pressure of an emulsion that flows, or in relaxed steps at the rate 0."""
    how = {"drag": DRAG} if by == "drag" else {"inertia": True}
    how = how | {"rate": rate} if rate else {"tolerance": 1e-4}
    with ld.Simulation(state, state.law, friction=FILMS.get(by)) as sim:
        states = sim.shear(strain, steps=round(strain / STEP), **how)[1:]
        rows = [(state.shear_strain, state.shear_stress, state.pressure) for state in states]
    return np.transpose(rows)


def blocks(strain, stress):
    """Means over blocks of strain, which are independent if blocks are long."""
    number = np.floor((strain - BEGIN) / BLOCK).astype(int)
    last = number.max()  # which may be incomplete
    return [float(stress[number == n].mean() * R0) for n in range(last)]


def mean(values):
    """The mean of independent values and its standard error."""
    return np.mean(values), np.std(values, ddof=1) / math.sqrt(len(values))


def herschel_bulkley(rate, yield_stress, factor, power):
    return yield_stress + factor * rate**power


def fit(rates, stress, error):
    """Yield stress, factor and power, their standard errors, and chi^2 per degree of freedom."""
    start = (0.8 * stress.min(), 0.2, 0.5)
    bounds = 0.0, (np.inf, np.inf, 1.0)
    found, covariance = curve_fit(
        herschel_bulkley, rates, stress, start, error, absolute_sigma=True, bounds=bounds
    )
    chi2 = np.sum(((herschel_bulkley(rates, *found) - stress) / error) ** 2)
    return found, np.sqrt(np.diag(covariance)), chi2 / (len(rates) - len(found))


def results(data, by):
    """Rates, mean stresses, errors and the fit, of what `flow` has measured."""
    flows = [row for row in data["runs"] if row["rate"] and row["by"] == by]
    rates = np.array([row["rate"] for row in flows]) / UNITS[by]
    stress, error = np.transpose([mean(row["blocks"]) for row in flows])
    return rates, stress, error, *fit(rates, stress, error)


def quasistatic(data):
    """The mean stress without a rate, and its error."""
    (still,) = (row for row in data["runs"] if not row["rate"])
    return mean(still["blocks"])


def show(data):
    for by in UNITS:
        rates, stress, error, found, errors, chi2 = results(data, by)
        print(f"{by}:")
        for rate, s, e in zip(rates, stress, error, strict=True):
            print(f"rate {rate:.2e}  stress {s:.4f} ± {e:.4f}")
        names = ("yield stress", "factor", "power")
        for name, value, e in zip(names, found, errors, strict=True):
            print(f"{name} {value:.4f} ± {e:.4f}")
        print(f"chi^2 {chi2:.2f}")
    print("quasistatic {:.4f} ± {:.4f}".format(*quasistatic(data)))


def draw(data, slow, relaxed, file):
    """Flow curves with their fits, and stress over strain at the smallest rate and without rate."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
    for n, by in enumerate(UNITS):
        rates, stress, error, found, _, _ = results(data, by)
        left.errorbar(rates, stress, error, fmt=f"C{n}o", ms=4)
        line = np.geomspace(0.5 * rates.min(), 1.5 * rates.max())
        label = rf"{by}: $\sigma_y$ + {found[1]:.2f} rate$^{{{found[2]:.2f}}}$"
        left.semilogx(line, herschel_bulkley(line, *found), f"C{n}", label=label)
    s, e = quasistatic(data)
    left.axhspan(s - e, s + e, color="gray", alpha=0.5, label="quasistatic")
    left.set(xlabel="rate", ylabel=r"stress [$\gamma/R_0$]", ylim=(0, None))
    left.legend(frameon=False)
    for curve, label in (
        (slow, f"drag, rate {RATES[0] / UNITS['drag']:.0e}"),
        (relaxed, "quasistatic"),
    ):
        right.plot(curve[0], curve[1] * R0, lw=1, label=label)
    right.set(xlabel="strain", ylabel=r"stress [$\gamma/R_0$]")
    right.legend(frameon=False)
    figure.savefig(file, dpi=80)


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("--number", type=int, default=64, help="droplets")
    options.add_argument("--strain", type=float, default=8.0, help="strain of the slowest run")
    given = options.parse_args()
    if given.strain <= BEGIN + 2 * BLOCK:
        options.error(f"--strain must be above {BEGIN + 2 * BLOCK:g}, for the means of two blocks")
    state = prepare(given.number)
    longer = [min(math.sqrt(rate / RATES[0]), LONGER) for rate in RATES]
    flows = [(rate, given.strain * more) for rate, more in zip(RATES, longer, strict=True)]
    calls = [("", 0.0, given.strain), *((by, *flow) for by in UNITS for flow in flows)]
    found = ld.parallel_map(lambda call: flow(state, *call), calls)
    runs = [
        {"by": by, "rate": rate, "blocks": blocks(*curve[:2])}
        for (by, rate, _), curve in zip(calls, found, strict=True)
    ]
    data = {"number": given.number, "strain": given.strain, "runs": runs}
    with open("flow_curve.json", "w") as file:
        json.dump(data, file, separators=(",", ":"))
    show(data)
    draw(data, found[1], found[0], "flow_curve.png")

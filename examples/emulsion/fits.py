"""Fits with errors, the table and the picture of a result of emulsion.py.

python fits.py emulsion_512.json

The picture needs the packing that emulsion.py has saved beside the result, such as packing_512.
"""

import json
import math
import sys
import warnings
from pathlib import Path

import deformable
import matplotlib.pyplot as plt
import numpy as np
from deformable.studies.ensemble.packings import before_rearrangement
from scipy.optimize import curve_fit

CLOSE = 0.0065  # phi - phi_J up to which powers are fitted
WIDE = 0.052

# z - z_iso over phi - phi_J: of soft disks, of foam with films, and the sum of both, which is that
# of deformable polygons (see the README)
SHAPES = {
    "square root": lambda x, a: a * np.sqrt(x),
    "linear": lambda x, a: a * x,
    "both": lambda x, a, b: a * np.sqrt(x) + b * x,
}


def column(packings, name):
    """One quantity, shape (packings, phi)."""
    return np.array([packing[name] for packing in packings])


def unbroken(packing):
    """Number of states until a packing rearranges: then its pressure leaves its bulk modulus."""
    names = ("phi", "excess_phi", "pressure", "bulk_modulus")
    states = zip(*(packing[name] for name in names), strict=True)
    rows = [dict(zip(names, state, strict=True), seed=packing["seed"]) for state in states]
    return len(before_rearrangement(rows))


def near(packings, name, widest):
    """As `column`, up to a phi - phi_J; close to the onset nan once a packing has rearranged.

    It has another onset then. Farther above, the difference does not matter.
    """
    found = column(packings, name)[:, column(packings, "excess_phi")[0] <= widest]
    if widest <= CLOSE:
        for values, packing in zip(found, packings, strict=True):
            values[unbroken(packing) :] = np.nan
    return found


def mean(values):
    """Mean over packings and its standard error."""
    count = np.isfinite(values).sum(axis=0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # nan where there are too few packings
        return np.nanmean(values, axis=0), np.nanstd(values, axis=0, ddof=1) / np.sqrt(count)


def jackknife(packings, fit):
    """A fit of all packings and its standard error, from leaving out one packing after another.

    The points of a fit are means over the same packings, so their errors are not independent.
    """
    without = [fit(packings[:n] + packings[n + 1 :]) for n in range(len(packings))]
    spread = np.sum((without - np.mean(without, axis=0)) ** 2, axis=0)
    return fit(packings), np.sqrt((len(packings) - 1) / len(packings) * spread)


def points(packings, name, widest):
    """phi - phi_J, mean, error, and which of them are over three packings and well above zero."""
    values = near(packings, name, widest)
    y, error = mean(values)
    kept = (np.isfinite(values).sum(axis=0) >= 3) & (y > 2.0 * error) & (error > 0.0)
    return column(packings, "excess_phi")[0][: len(y)][kept], y[kept], error[kept], kept


def exponent(packings, name, widest):
    """Slope of a straight line through the logarithms, and its error."""
    x, _, _, kept = points(packings, name, widest)
    if len(x) < 3:
        return np.nan, np.nan

    def slope(some):
        return np.polyfit(np.log(x), np.log(mean(near(some, name, widest)[:, kept])[0]), 1)[0]

    return jackknife(packings, slope)


def contacts(packings, shape, widest):
    """Coefficients of z - z_iso with their errors, and chi^2 over the degrees of freedom."""
    x, y, error, kept = points(packings, "excess_coordination", widest)
    start = np.ones(shape.__code__.co_argcount - 1)
    if len(x) <= len(start):
        return np.nan * start, np.nan * start, np.nan

    def fit(some):
        z, _ = mean(near(some, "excess_coordination", widest)[:, kept])
        return curve_fit(shape, x, z, p0=start, sigma=error)[0]

    best, errors = jackknife(packings, fit)
    chi2 = np.sum(((shape(x, *best) - y) / error) ** 2) / (len(x) - len(best))
    return best, errors, chi2


def summary(result):
    """All fits of a result, as a dictionary."""
    packings = result["packings"]
    onset, error = mean(column(packings, "phi_J"))
    found = {"phi_J": [onset, error]}
    for name in ("pressure", "bulk_modulus", "shear_modulus", "excess_coordination"):
        found[f"exponent of {name}"] = list(exponent(packings, name, CLOSE))
    for name, shape in SHAPES.items():
        for widest in (CLOSE, WIDE):
            best, errors, chi2 = contacts(packings, shape, widest)
            found[f"contacts, {name}, up to {widest}"] = {
                "coefficients": best.tolist(),
                "errors": errors.tolist(),
                "chi2": chi2,
            }
    return found


def table(result):
    """Lines of means over the packings with standard errors."""
    packings = result["packings"]
    names = ("pressure", "excess_coordination", "shear_modulus", "bulk_modulus", "shape_parameter")
    columns = [mean(column(packings, name)) for name in ("phi", "excess_phi", *names)]
    for rows in zip(*(np.transpose(both) for both in columns), strict=True):
        yield "| " + " | ".join(with_error(*row) for row in rows) + " |"


def with_error(value, error):
    """Both with as many decimals as the error has with two digits; one packing has no error."""
    if not np.isfinite(value):
        return "too few packings or points above zero"
    if not error > 1e-9 * abs(value):
        return f"{value:.4g}"
    decimals = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def show(result):
    print(f"{len(result['packings'])} packings of {result['number']} droplets")
    print("| phi | phi - phi_J | pressure | z - z_iso | shear modulus | bulk modulus | shape |")
    print("|---|---|---|---|---|---|---|")
    print(*table(result), sep="\n")
    for name, value in summary(result).items():
        if isinstance(value, dict):
            terms = zip(value["coefficients"], value["errors"], strict=True)
            found = ", ".join(with_error(*term) for term in terms)
            chi2 = f"chi^2 per degree of freedom {value['chi2']:.3g}"
            known = np.isfinite(value["chi2"])
            print(
                f"{name}: {found}, {chi2}"
                if known
                else f"{name}: too few packings or points above zero"
            )
        else:
            print(f"{name}: {with_error(*value)}")


def princen(phi):
    """Osmotic pressure of a hexagonal array of equal droplets [tension/R]."""
    onset = np.pi / np.sqrt(12.0)
    return np.sqrt(phi / onset) * (np.sqrt((1.0 - onset) / (1.0 - phi)) - 1.0)


def draw(result, packing, file):
    """The packing, and pressure, contacts and moduli over phi."""
    packings = result["packings"]
    x, phi = (column(packings, name).mean(axis=0) for name in ("excess_phi", "phi"))
    figure, ((one, two), (three, four)) = plt.subplots(2, 2, figsize=(9, 7.6), layout="constrained")
    with deformable.Run(packing).simulation() as sim:
        state = sim.state()
    state.plot(one, title=rf"$\phi$ = {state.phi:.2f}")

    def bars(axes, name, **style):
        y, error = mean(column(packings, name))
        axes.errorbar(x, y, error, fmt="o", ms=4, **style)
        return y

    two.errorbar(phi, *mean(column(packings, "pressure")), fmt="o", ms=4, label="droplets")
    dense = np.linspace(0.907, 0.996, 200)[1:]
    two.semilogy(dense, princen(dense), "k--", lw=1, label="hexagonal array (Princen)")
    two.set(xlabel=r"$\phi$", ylabel=r"pressure [$\gamma/R_0$]", ylim=(1e-4, None))
    two.legend(frameon=False)

    bars(three, "excess_coordination", color="k")
    line = np.geomspace(x.min(), WIDE, 100)
    for (name, shape), style in zip(SHAPES.items(), ("--", ":", "-"), strict=True):
        best, _, _ = contacts(packings, shape, WIDE)
        three.loglog(line, shape(line, *best), style, label=name)
    three.set(xlabel=r"$\phi - \phi_J$", ylabel=r"$z - z_\mathrm{iso}$", ylim=(8e-3, 4.0))
    three.legend(frameon=False)

    bars(four, "bulk_modulus", label="bulk modulus")
    bars(four, "shear_modulus", label="shear modulus")
    bars(four, "pressure", label="pressure")
    four.set(xscale="log", yscale="log", xlabel=r"$\phi - \phi_J$", ylabel=r"[$\gamma/R_0$]")
    four.set_ylim(1e-4, None)
    four.legend(frameon=False)
    figure.savefig(file, dpi=80)


if __name__ == "__main__":
    (name,) = sys.argv[1:]
    with open(name) as file:
        result = json.load(file)
    show(result)
    packing = Path(name).with_name(f"packing_{result['number']}")
    if packing.exists():
        draw(result, packing, name.replace(".json", ".png"))
    else:
        print(f"no picture without {packing}: emulsion.py writes it", file=sys.stderr)

"""Foam or soft particles? How many contacts packings gain above the onset of jamming, by law.

python -m validation.foam_or_particles --number 32 --seeds 2    ten seconds
python -m validation.foam_or_particles                          512 in 8 packings, as the page
python -m validation.foam_or_particles --number 2048 --seeds 5 --laws disks

Fits have x = phi - phi_J and the shapes a sqrt(x), b x and a sqrt(x) + b x.
"""

import argparse
import json
import math
import os
import time
import warnings

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import curve_fit

from validation import options_of
from validation.ensembles import over_cores
from validation.jamming.packings import before_rearrangement

RADII = (0.5, 0.7)
R0 = float(np.mean(RADII))
DROPLETS = {"kA": math.inf, "kP": 0.0, "tension": 1.0}
KP = R0**2  # the stiffness of the perimeter of elastic rings: as that of the area, kA R0^2

# Each law with its unit of pressure. All of them start from the same jammed disks: at their onset
# particles are round, so that all laws have the same contacts there.
LAWS = {
    "foam": (ld.Ring(**DROPLETS, contact="curved"), 1.0 / R0),
    "straight films": (ld.Ring(**DROPLETS, contact="balanced"), 1.0 / R0),
    "elastic rings": (ld.Ring(kA=1.0, kP=KP, contact="curved"), 0.5 * KP),
    "stiff rings": (ld.Ring(kA=1.0, contact="curved"), R0**2),
    "disks": (None, 1.0),
}
WETTED = "foam, wetted"  # from the end of the foam back to its onset

ONSET = 1e-7  # pressure of jammed disks [k]: phi is 3e-7 above phi_J
TOLERANCE = 1e-6  # largest force on a particle over the mean contact force
NEAR = 10.0 ** np.arange(-4.0, -0.9, 0.2)  # phi - phi_J, five a decade
PRESSURES = 10.0 ** np.arange(-0.4, -4.1, -0.2)  # of the way back, about phi - phi_J
DENSE = (0.95, 0.96, 0.97, 0.98, 0.99)  # phi
MOST = 12  # contacts that are counted


def measure(law, number, seed):
    """A packing of a law from its onset to phi = 0.99, and of foam back again."""
    warnings.simplefilter("ignore", ld.UnjammedWarning)  # near the onset some rearrange
    began = time.process_time()
    loose = ld.bidisperse(number, sizes=RADII, seed=seed)
    onset = ld.jam(loose, pressure=ONSET, tolerance=1e-6).packing
    particles, unit = LAWS[law]
    sim = ld.Simulation(onset, particles) if particles else ld.Simulation(onset, ld.SoftContact())
    key = {"number": number, "seed": seed}
    with sim:
        states = [row(state, unit) for state in compressed(sim, onset.phi)]
        found = [key | {"law": law, "phi_J": onset.phi} | cost(sim, began) | columns(states)]
        if law == "foam":
            began, before = time.process_time(), found[0]["iterations"]
            *states, last = [row(state, unit) for state in decompressed(sim, unit)]
            phi_J = last["phi"] - last["pressure"]  # in these units it is the distance from there
            more = {"law": WETTED, "phi_J": phi_J} | cost(sim, began, before)
            found.append(key | more | columns(states[::-1]))
    return found


def compressed(sim, phi_J):
    near = [phi_J + x for x in NEAR if phi_J + x < DENSE[0]]
    for phi in (*near, *DENSE):
        (state,) = sim.compress(phi=phi, tolerance=TOLERANCE)[1:]
        yield state


def decompressed(sim, unit):
    """Back to the onset, first by phi, then by pressure, which tells how near the onset is."""
    for phi in DENSE[-2::-1]:
        (state,) = sim.compress(phi=phi, tolerance=TOLERANCE)[1:]
        yield state
    for pressure in (*PRESSURES, 10.0 * ONSET):
        yield sim.relax(TOLERANCE, pressure=pressure * unit)


def row(state, unit):
    """What is measured of a state. One without a contact network has numbers that are nan."""
    try:
        moduli = state.moduli()
        shear, bulk = moduli.mean_shear_modulus / unit, moduli.bulk_modulus / unit
    except ld.ParameterError:  # it resists no strain
        shear = bulk = math.nan
    rigid = state.coordination > 0.0
    return {
        "phi": state.phi,
        "pressure": state.pressure / unit,
        "coordination": state.coordination if rigid else math.nan,
        "excess": [state.excess_coordination(t) if rigid else math.nan for t in THRESHOLDS],
        "degrees": np.bincount(state.network_degree, minlength=MOST + 1)[: MOST + 1].tolist(),
        "bulk_modulus": bulk,
        "shear_modulus": shear,
        "residual": state.residual,
    }


def columns(rows):
    return {name: [rounded(each[name]) for each in rows] for name in rows[0]}


def rounded(value):
    """Six digits; None in the place of nan."""
    if isinstance(value, list):
        return [rounded(each) for each in value]
    if isinstance(value, int):
        return value
    return float(f"{value:.6g}") if math.isfinite(value) else None


def cost(sim, began, before=0):
    """Processor time [s] and iterations of the minimizer since then."""
    seconds = round(time.process_time() - began, 2)
    return {"seconds": seconds, "iterations": sim.lmp.extract_global("ntimestep") - before}


# Fits with errors, and tables.

NAMES = ("foam", "foam, wetted", "straight films", "elastic rings", "stiff rings", "disks")
THRESHOLDS = (0.0, 1e-3, 1e-2, 0.03, 0.1, 0.2, 0.3)  # of the mean contact force
SHOWN = THRESHOLDS[:5]  # above them too few contacts are left for a network near the onset
WINDOW = (2e-4, 0.05)  # of x
CLOSE = 0.007  # x up to which the onset of a packing must be known well
WINDOWS = ((2e-4, 5e-3), (2e-4, 0.02), WINDOW, (2e-4, 0.12), (1e-3, 0.05), (5e-3, 0.12))
EQUAL = np.arange(0.83, 0.9001, 0.005)  # phi at which packings are averaged for comparison

# Powers of x. The last shape is a line with an onset of its own.
SHAPES = {"sum": (0.5, 1.0), "root": (0.5,), "line": (1.0,), "free line": (1.0, 0.0)}


def chosen(rows, law, number):
    """The packings of a law."""
    return [row for row in rows if (row["law"], row["number"]) == (law, number)]


def column(packings, name):
    """A quantity, nan where a packing has come apart, shape (packings, states)."""
    values, z = (np.array([row[of] for row in packings], float) for of in (name, "coordination"))
    if name not in ("phi", "phi_J"):
        values[np.isnan(z)] = np.nan
    return values


def excess_phi(packings):
    return column(packings, "phi") - column(packings, "phi_J")[:, None]


def excess(packings, threshold=0.0):
    """z - z_iso of contacts that bear this part of the mean force, shape (packings, states)."""
    return column(packings, "excess")[:, :, THRESHOLDS.index(threshold)]


def mean(values):
    """Mean over the packings that have a value; nan without any."""
    count = np.isfinite(values).sum(axis=0)
    return np.where(count > 0, np.nansum(values, axis=0) / np.maximum(count, 1), np.nan)


def error_of(values, floor=0.0):
    """Standard error of the mean, at least the floor over the root of the number of packings.

    The floor of z - z_iso is that of one contact, 2/N: packings may have the same number by chance.
    """
    count = np.isfinite(values).sum(axis=0)
    squares = np.nansum((values - mean(values)) ** 2, axis=0)
    spread = np.sqrt(squares / np.maximum(count - 1, 1))
    return np.where(count > 1, np.maximum(spread, floor) / np.sqrt(np.maximum(count, 1)), np.nan)


def means(packings, threshold):
    """z - z_iso and its error at each state."""
    z = excess(packings, threshold)
    return mean(z), error_of(z, 2.0 / packings[0]["number"])


def points(packings, window, threshold):
    """Which states lie in a window of x, over two packings or more; x, z - z_iso and its error."""
    x, z = mean(excess_phi(packings)), excess(packings, threshold)
    kept = (window[0] < x) & (x < window[1]) & (np.isfinite(z).sum(axis=0) >= 2)
    return kept, x[kept], means(packings, threshold)[1][kept]


def fit(packings, shape, window=WINDOW, threshold=0.0):
    """Coefficients of a shape, their errors and chi^2 per degree of freedom.

    The means are weighted by their errors. Those of the coefficients come from leaving out one
    packing after another, because all means are over the same packings.
    """
    kept, x, error = points(packings, window, threshold)
    terms = np.transpose([x**power for power in SHAPES[shape]])

    def coefficients(some):
        z = mean(excess(some, threshold)[:, kept])
        return np.linalg.lstsq(terms / error[:, None], z / error, rcond=None)[0]

    found, errors = ld.jackknife(packings, coefficients)
    z = mean(excess(packings, threshold)[:, kept])
    chi2 = np.sum(((terms @ found - z) / error) ** 2) / (len(x) - len(found))
    return found, errors, chi2


def power(packings, window=WINDOW, threshold=0.0):
    """The power of x by a straight line through the logarithms, and its error."""
    kept, x, error = points(packings, window, threshold)

    def slope(some):
        z = mean(excess(some, threshold)[:, kept])
        if not (z > 0.0).all():
            return math.nan
        return np.polyfit(np.log(x), np.log(z), 1, w=z / error)[0]

    return ld.jackknife(packings, slope)


def with_error(value, error):
    """Both with as many decimals as the error has with two digits."""
    if not (math.isfinite(value) and math.isfinite(error)):
        return "–"
    if not error > 1e-9 * abs(value):
        return f"{value:.4g}"
    decimals = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def of_fits(packings, window=WINDOW, threshold=0.0):
    """Cells of a table: a and b of the sum, chi^2 of all shapes, and the power."""
    found = {shape: fit(packings, shape, window, threshold) for shape in SHAPES}
    terms = [with_error(*term) for term in zip(*found["sum"][:2], strict=True)]
    chi2 = [short(found[shape][2]) for shape in SHAPES]
    return [*terms, *chi2, with_error(*power(packings, window, threshold))]


def short(chi2):
    """Two digits, without powers of ten."""
    return f"{float(f'{chi2:.2g}'):g}"


FITS = ("a", "b", "chi^2 of the sum", "of the root", "of the line", "of the free line", "power")


def table(heads, rows):
    for line in (heads, ["---"] * len(heads), *rows):
        yield "| " + " | ".join(map(str, line)) + " |"


def laws_table(rows):
    """Fits of each law and size in the window."""
    heads = ("law", "N", "packings", "phi_J", *FITS)
    lines = []
    for number in dict.fromkeys(row["number"] for row in rows):
        for law in NAMES:
            packings = chosen(rows, law, number)
            if packings:
                onset = ld.jackknife([row["phi_J"] for row in packings])
                lines.append([law, number, len(packings), with_error(*onset), *of_fits(packings)])
    return table(heads, lines)


def windows_table(packings):
    lines = [[f"{low:g} to {high:g}", *of_fits(packings, (low, high))] for low, high in WINDOWS]
    lines.append([f"{WINDOW[0]:g} to {WINDOW[1]:g}, unbroken", *of_fits(unbroken(packings))])
    return table(("x", *FITS), lines)


def unbroken(packings):
    """The packings without what follows a rearrangement up to x = 0.007: it has another onset.

    There the pressure leaves the integral of the bulk modulus by a quarter.
    """
    found = []
    names = ("phi", "pressure", "bulk_modulus")
    for packing in packings:
        states = [
            dict(zip(names, values, strict=True), seed=packing["seed"])
            for values in zip(*(packing[name] for name in names), strict=True)
        ]
        x = excess_phi([packing])[0]
        series = [state | {"excess_phi": at} for state, at in zip(states, x, strict=True)]
        known = (np.arange(len(x)) < len(before_rearrangement(series))) | (x > CLOSE)
        z = [
            each if kept else None
            for each, kept in zip(packing["coordination"], known, strict=True)
        ]
        found.append(packing | {"coordination": z})
    return found


def thresholds_table(packings):
    lines = [[f"{t:g}", *of_fits(packings, WINDOW, t)] for t in SHOWN]
    return table(("threshold", *FITS), lines)


def states_table(packings):
    """Means of the states: pressure, contacts, moduli, and shares of the numbers of contacts."""
    heads = ("phi - phi_J", "pressure", "z - z_iso", "K", "G", "rattlers", *SHARES)
    names = ("pressure", "bulk_modulus", "shear_modulus")
    pressure, bulk, shear = (column(packings, name) for name in names)
    quantities = (pressure, excess(packings), bulk, shear)
    x, shared = mean(excess_phi(packings)), mean(shares(packings))
    cells = [
        [with_error(*pair) for pair in zip(mean(q), error_of(q), strict=True)] for q in quantities
    ]
    lines = [
        [f"{x[k]:.2g}", *(cell[k] for cell in cells), *(f"{share:.3f}" for share in shared[k])]
        for k in range(0, len(x), 2)
    ]
    return table(heads, lines)


def at_equal_phi(packings, shape):
    """Fit to the mean z of the packings that are rigid at the same phi, and chi^2.

    Shapes are functions of phi and of two coefficients, the second of which is phi at the onset.
    """
    rigid = [np.isfinite(column([packing], "coordination")[0]) for packing in packings]
    z = np.array(
        [
            np.interp(
                EQUAL,
                *(column([packing], name)[0][kept] for name in ("phi", "coordination")),
                np.nan,
            )
            for packing, kept in zip(packings, rigid, strict=True)
        ]
    )
    kept = np.isfinite(z).sum(axis=0) >= 3
    error = error_of(z, 2.0 / packings[0]["number"])[kept]

    def coefficients(some):
        return curve_fit(shape, EQUAL[kept], mean(some)[kept], (10.0, 0.83), error)[0]

    found, errors = ld.jackknife(z, lambda some: coefficients(np.array(some)))
    deviation = (shape(EQUAL[kept], *found) - mean(z)[kept]) / error
    return found, errors, np.sum(deviation**2) / (kept.sum() - 2)


def line(phi, slope, onset):
    return 4.0 + slope * (phi - onset)


def root(phi, factor, onset):
    return 4.0 + factor * np.sqrt(np.maximum(phi - onset, 0.0))


def equal_table(rows):
    """Packings averaged at equal phi, by law and size."""
    heads = ("law", "N", "packings", "spread of phi_J", "slope", "onset", "chi^2", "of a root")
    lines = []
    for number in dict.fromkeys(row["number"] for row in rows):
        for law in NAMES:
            packings = chosen(rows, law, number)
            if len(packings) > 2:
                spread = f"{np.std([row['phi_J'] for row in packings], ddof=1):.4f}"
                found, errors, chi2 = at_equal_phi(packings, line)
                terms = [with_error(*term) for term in zip(found, errors, strict=True)]
                other = short(at_equal_phi(packings, root)[2])
                lines.append([law, number, len(packings), spread, *terms, short(chi2), other])
    return table(heads, lines)


SHARES = ("3", "4", "5", "6", "7 and more")


def shares(packings):
    """Part of the rattlers, and of the others with 3, 4, 5, 6 and more contacts.

    Shape (packings, states, 6).
    """
    degrees = column(packings, "degrees")
    rigid = degrees[:, :, 3:].sum(axis=2)
    parts = [degrees[:, :, 3], degrees[:, :, 4], degrees[:, :, 5], degrees[:, :, 6]]
    parts.append(degrees[:, :, 7:].sum(axis=2))
    with np.errstate(invalid="ignore"):
        parts = [part / rigid for part in parts]
    return np.stack([degrees[:, :, 0] / degrees.sum(axis=2), *parts], axis=2)


def costs_table(rows):
    """Processor time of a packing, and of a particle in an iteration of the minimizer."""
    lines = []
    for number in dict.fromkeys(row["number"] for row in rows):
        for law in NAMES:
            packings = chosen(rows, law, number)
            if packings:
                seconds, iterations = (
                    np.array([row[name] for row in packings], float)
                    for name in ("seconds", "iterations")
                )
                each = 1e6 * seconds.sum() / (iterations.sum() * number)
                steps = f"{iterations.mean() * number:.1e}".replace("e+0", "e")
                lines.append([law, number, f"{seconds.mean():.2g}", steps, f"{each:.2g}"])
    return table(("law", "N", "seconds", "particle-steps", "microseconds each"), lines)


def page(rows):
    """All tables of the page; those of one law are of the first one and its size."""
    first = chosen(rows, rows[0]["law"], rows[0]["number"])
    for lines in (
        laws_table(rows),
        windows_table(first),
        thresholds_table(first),
        equal_table(rows),
        states_table(first),
        costs_table(rows),
    ):
        yield from lines
        yield ""


def read(files):
    return [row for name in files for row in json.loads(open(name).read())]


def draw(rows, file):
    """z - z_iso of the laws and of foam above thresholds, moduli, and numbers of contacts."""
    number = rows[0]["number"]
    laws = [law for law in NAMES if len(chosen(rows, law, number)) > 1]
    foam = chosen(rows, laws[0], number)
    figure, axes = plt.subplots(2, 3, figsize=(14, 8), layout="constrained")
    (one, two, three), (four, five, six) = axes
    for law in laws:
        packings = chosen(rows, law, number)
        x, z, error = mean(excess_phi(packings)), *means(packings, 0.0)
        one.errorbar(x, z, error, fmt="o", ms=3, label=law)
        two.errorbar(np.sqrt(x), z / np.sqrt(x), error / np.sqrt(x), fmt="o-", ms=3, lw=0.6)
    line = np.geomspace(1e-4, 0.1, 100)
    for shape, style in (("sum", "-"), ("root", ":"), ("line", "--")):
        found, _, _ = fit(foam, shape)
        z = sum(a * line**power for a, power in zip(found, SHAPES[shape], strict=True))
        one.loglog(line, z, "k" + style, lw=1, label=f"{laws[0]}, {shape}")
    one.set(xlabel=r"$x = \phi - \phi_J$", ylabel=r"$z - z_\mathrm{iso}$", ylim=(0.01, 3.0))
    two.set(ylabel=r"$(z - z_\mathrm{iso})/\sqrt{x}$", title="a root is level, a sum a line")
    for threshold in SHOWN:
        x, z, error = mean(excess_phi(foam)), *means(foam, threshold)
        label = f"{threshold:g} of the mean force"
        three.errorbar(np.sqrt(x), z / np.sqrt(x), error / np.sqrt(x), fmt="o-", ms=3, label=label)
    three.set(title=f"{laws[0]}: contacts that bear more than")
    for axes in (two, three):
        axes.set(xlabel=r"$\sqrt{x}$", ylim=(-4.0 if axes is three else 0.0, 8.0))
    for law, marker in (("foam", "o"), ("straight films", "x")):
        packings = chosen(rows, law, number)
        for name, color in (("bulk_modulus", "C0"), ("shear_modulus", "C1"), ("pressure", "C2")):
            if packings:
                x, y = mean(excess_phi(packings)), column(packings, name)
                label = f"{name.replace('_', ' ')}, {law}"
                style = {"fmt": marker, "ms": 4, "color": color, "label": label}
                four.errorbar(x, mean(y), error_of(y), **style)
                if name == "shear_modulus":
                    phi = mean(column(packings, "phi"))
                    five.errorbar(phi, mean(y), error_of(y), **style)
    dense = np.linspace(0.9069, 0.995)
    five.plot(dense, np.sqrt(np.sqrt(3) / (2 * np.pi) * dense), "k--", label="hexagonal array")
    four.set(xscale="log", yscale="log", xlabel=r"$x$", ylabel=r"[$\gamma/R_0$]", ylim=(1e-4, None))
    five.set(xlabel=r"$\phi$", ylabel=r"shear modulus [$\gamma/R_0$]")
    phi, shared = mean(column(foam, "phi")), mean(shares(foam))
    rest = (1.0 - shared[:, :1]) * shared[:, 1:]
    six.stackplot(phi, shared[:, 0], *rest.T, labels=("rattlers", *SHARES), alpha=0.8)
    six.set(xlabel=r"$\phi$", ylabel=f"part of the particles, {laws[0]}", ylim=(0, 1))
    six.set_xlim(phi[0], phi[-1])
    for axes in (one, three, four, five):
        axes.legend(frameon=False, fontsize=8)
    six.legend(fontsize=8, loc="lower right", title="contacts")
    figure.savefig(file, dpi=80)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--number", type=int, default=512, help="particles in a packing")
    options.add_argument("--seeds", type=int, default=8, help="packings")
    options.add_argument("--laws", nargs="+", choices=LAWS, default=list(LAWS))
    options.add_argument("--workers", type=int, help="packings at a time; one per core if omitted")
    options.add_argument(
        "--show", nargs="+", type=os.path.abspath, metavar="FILE", help="only show these results"
    )
    given = options_of(options, __file__)
    if given.show:
        rows = read(given.show)
        print(*page(rows), sep="\n")
        draw(rows, given.show[0].replace("rows", "foam_or_particles").replace(".json", ".png"))
        return
    if given.seeds < 2:
        options.error(f"--seeds must be at least 2, for errors, not {given.seeds}")
    run = f"rows_{given.number}"
    # seed by seed: an interrupted run has some packings of all laws
    calls = [(law, given.number, seed + 1) for seed in range(given.seeds) for law in given.laws]
    # each packing is kept as soon as it is measured: the same command goes on after an interruption
    found = over_cores(measure, calls, given.workers, f"{run}_kept")
    rows = [each for both in found for each in both]
    with open(f"{run}.json", "w") as file:
        file.write(
            "[" + ",\n".join(json.dumps(each, separators=(",", ":")) for each in rows) + "]\n"
        )
    print(*page(rows), sep="\n")
    draw(rows, f"foam_or_particles_{given.number}.png")


if __name__ == "__main__":
    main()

"""Quantities with errors, and tables of them, of a result of melting.py.

The first third of the legs at each temperature is left out. Errors come from leaving out one of the
others after another (jackknife), so they are right if order is forgotten within a leg.
"""

import math

import lammps_deformable as ld
import numpy as np

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


TABLES = (order_table, thermal_table, defect_table, start_table)


def show(data, tables=TABLES):
    print(summary(data))
    for table in tables:
        print("", table.__doc__, *table(data), sep="\n")

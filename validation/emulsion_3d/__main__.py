"""An emulsion in space: osmotic pressure, elastic moduli, contacts and loads of random packings.

python -m validation.emulsion_3d --number 128 --packings 4 --workers 2

Each packing is written to emulsion_3d_NUMBER.json when it is there, and not measured again.
"""

import argparse
import json
import math
import time
from pathlib import Path

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from scipy.stats import lognorm

from validation import options_of
from validation.ensembles import over_cores
from validation.finite_strain import shear_modulus

KINDS = ("nearly equal", "polydisperse")
RADII = (1.0, 1.2)  # of equal numbers: equal droplets begin to crystallize
WIDTH = 0.2  # of the logarithm of radii
ABOVE = (0.001, 0.003, 0.01)  # phi - phi_J
PHI = (0.66, 0.68, 0.70, 0.73, 0.76, 0.79, 0.82, 0.85)
SHORT = (0.66, 0.70, 0.76, 0.82, 0.85)  # rows of the page
FINITE, STRAIN = (0.66, 0.76, 0.85), 1e-4  # where the first packing is sheared, and by how much

NAMES = ("phi", "pressure", "shear", "bulk", "excess", "load", "largest", "order", "above")
NEAR, FAR = slice(0, len(ABOVE)), slice(len(ABOVE) + 1, None)  # rows of fits over the pressure
COLORS = ("#0072b2", "#d55e00")  # which the color-blind tell apart
HEADS = ("pressure", "3.2 (phi - 0.64)^2/sqrt(1 - phi)", "shear modulus", "1.6 phi (phi - 0.64)")
HEADS = (*HEADS, "bulk modulus", "z - z_iso", "mean load", "largest load")


def measure(kind, number, seed):
    """phi_J of a packing of spheres, and a row for each phi; moduli in units of tension/R32."""
    if kind == "polydisperse":
        start = ld.polydisperse(number, lognorm(WIDTH), dimension=3, seed=seed)
    else:
        start = ld.bidisperse(number, sizes=RADII, dimension=3, seed=seed)
    jammed = ld.jam(start).packing
    unit = np.sum(jammed.radii**2) / np.sum(jammed.radii**3)
    rows = []
    with ld.Simulation(jammed, ld.Droplet(tension=1.0)) as sim:
        for phi in [*(jammed.phi + above for above in ABOVE), *PHI]:
            begun, step = time.process_time(), sim.lmp.extract_global("ntimestep")
            (state,) = sim.compress(phi=phi)[1:]
            taken = time.process_time() - begun, sim.lmp.extract_global("ntimestep") - step
            row = row_of(state, unit) | dict(zip(("seconds", "steps"), taken, strict=True))
            if seed == 1 and phi in FINITE:
                row["sheared"] = shear_modulus(state, STRAIN).value / unit
            rows.append(row)
    width = float(jammed.radii.std() / jammed.radii.mean())
    return {"kind": kind, "seed": seed, "width": width, "phi_J": jammed.phi, "rows": rows}


def row_of(state, unit):
    """What is measured in a state."""
    moduli = state.moduli()
    row = {
        "phi": state.phi,
        "pressure": state.pressure / unit,
        "shear": moduli.mean_shear_modulus / unit,  # of all directions
        "bulk": moduli.bulk_modulus / unit,
        "excess": state.excess_coordination(),
        "load": state.loads.mean(),
        "largest": state.loads.max(),
        "order": state.steinhardt(6).mean(),
        "simple": moduli.shear_modulus / unit,  # along x alone
    }
    return {name: float(value) for name, value in row.items()}


def master_curve(phi):
    """Osmotic pressure of emulsions, as published."""
    return 3.2 * (phi - 0.64) ** 2 / np.sqrt(1.0 - phi)


def mason(phi):
    """Shear modulus of emulsions (Mason, Bibette and Weitz 1995)."""
    return 1.6 * phi * (phi - 0.64)


def of_kind(packings, kind):
    """Quantities of all packings of a kind, shape (packings, phi, quantities)."""
    rows = [
        [[*map((row | {"above": row["phi"] - one["phi_J"]}).get, NAMES)] for row in one["rows"]]
        for one in packings
        if one["kind"] == kind
    ]
    return np.array(rows)


def means(packings, kind):
    """Means over the packings and their errors, by name, each of one number for each phi."""
    values, errors = ld.jackknife(of_kind(packings, kind), lambda some: np.mean(some, 0))
    return dict(zip(NAMES, values.T, strict=True)), dict(zip(NAMES, errors.T, strict=True))


def onset(packings, kind):
    """phi_J of a kind, and its error."""
    return ld.jackknife([p["phi_J"] for p in packings if p["kind"] == kind])


def exponent(packings, kind, name, rows):
    """n of the mean quantity ~ pressure^n in some rows, and its error."""
    pressure, column = NAMES.index("pressure"), NAMES.index(name)

    def slope(some):
        mean = np.mean(some, axis=0)[rows]
        return np.polyfit(np.log(mean[:, pressure]), np.log(np.abs(mean[:, column])), 1)[0]

    return ld.jackknife(of_kind(packings, kind), slope)


def microseconds(packings, number):
    """Processor time of relaxations for each droplet and step, the median."""
    rows = [row for packing in packings for row in packing["rows"]]
    return 1e6 * float(np.median([row["seconds"] / row["steps"] / number for row in rows]))


def summary(packings, kind, number):
    """What the packings of a kind are."""
    some = [packing for packing in packings if packing["kind"] == kind]
    width = np.mean([packing["width"] for packing in some])
    return (
        f"{kind}: phi_J = {with_error(*onset(packings, kind))}, relative width of the radii "
        f"{width:.2f}, {len(some)} packings of {number} droplets"
    )


def exponents(packings):
    """The lines of the table of exponents, with errors of the last digits."""
    yield "| | pressure | bulk modulus | shear modulus | z - z_iso |"
    yield "|" + "---|" * 5
    for kind in KINDS:
        pressure = means(packings, kind)[0]["pressure"]
        for rows in (NEAR, FAR):
            found = (
                with_error(*exponent(packings, kind, name, rows))
                for name in ("bulk", "shear", "excess")
            )
            span = f"{pressure[rows][0]:.2g} to {pressure[rows][-1]:.2g}"
            yield f"| {kind} | {span} | " + " | ".join(found) + " |"


def table(packings, kind):
    """The lines of the table, with errors of the last digits."""
    yield "| " + " | ".join((kind, *HEADS)) + " |"
    yield "|" + "---|" * (len(HEADS) + 1)
    values, errors = means(packings, kind)
    for n, phi in enumerate([*(f"phi_J + {above}" for above in ABOVE), *PHI]):
        cells = {name: with_error(values[name][n], errors[name][n]) for name in NAMES}
        at = values["phi"][n]
        curves = (f"{master_curve(at):.4f}", f"{mason(at):.3f}") if n >= len(ABOVE) else ("", "")
        row = (phi, cells["pressure"], curves[0], cells["shear"], curves[1], cells["bulk"])
        row = (*row, cells["excess"], cells["load"], cells["largest"])
        yield "| " + " | ".join(map(str, row)) + " |"


def short_table(packings):
    """Pressure and shear modulus of both kinds beside the curves of emulsions, at some phi."""
    kinds = [f"{name}, {kind}" for name in ("pressure", "shear modulus") for kind in KINDS]
    yield f"| phi | {kinds[0]} | {kinds[1]} | emulsions | {kinds[2]} | {kinds[3]} | emulsions |"
    yield "|" + "---|" * 7
    found = [means(packings, kind) for kind in KINDS]
    for n, phi in enumerate(PHI, len(ABOVE)):
        if phi not in SHORT:
            continue
        cells = []
        for name, curve in (("pressure", master_curve(phi)), ("shear", mason(phi))):
            cells += [with_error(values[name][n], errors[name][n]) for values, errors in found]
            cells.append(f"{curve:.3f}")
        yield f"| {phi} | " + " | ".join(cells) + " |"


def height(phi, pressure, start):
    """Height above the floor of floating droplets, from dp/dz = weight phi [pressure/weight].

    It is 0 at the densest point, and the emulsion ends where its pressure does, at the first phi.
    """
    phi, pressure = np.append(start, phi), np.append(0.0, pressure)
    depth = np.append(0.0, np.cumsum(np.diff(pressure) / (0.5 * (phi[1:] + phi[:-1]))))
    return depth[-1] - depth, phi


def with_error(value, error):
    """Both with as many decimals as the error has with two digits."""
    if not error > 1e-9 * abs(value):
        return f"{value:.4g}"
    decimals = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def lines(packings, number):
    """All that the log has."""
    for kind in KINDS:
        yield from (summary(packings, kind, number), *table(packings, kind), "")
    yield from (*exponents(packings), "")
    taken = microseconds(packings, number)
    yield f"a step of a relaxation takes {taken:.1f} microseconds of processor time a droplet"


def draw(packings, file):
    """Pressure and shear modulus over phi, and both over the curves of emulsions."""
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.6), layout="constrained")
    dense = np.linspace(0.645, 0.86, 200)
    quantities = (
        ("pressure", master_curve, "osmotic pressure"),
        ("shear", mason, "shear modulus"),
    )
    for (name, curve, label), left in zip(quantities, axes, strict=False):
        left.plot(dense, curve(dense), "k--", lw=1, label="emulsions, fit to measurements")
        left.set(xlabel=r"$\phi$", ylabel=rf"{label} [$\gamma/R_{{32}}$]")
        for kind, mark, color in zip(KINDS, "os", COLORS, strict=True):
            values, errors = means(packings, kind)
            style = {"fmt": mark, "ms": 4, "color": color}
            left.errorbar(values["phi"], values[name], errors[name], label=kind, **style)
            fit = curve(values["phi"])
            loose = values["phi"] > 0.69  # before, the curve is near its zero
            axes[2].errorbar(
                values["phi"][loose],
                (values[name] / fit)[loose],
                (errors[name] / fit)[loose],
                label=f"{label}, {kind}",
                **style | {"mfc": color if name == "pressure" else "white"},
            )
    axes[2].axhline(1.0, color="k", ls="--", lw=1)
    axes[2].set(xlabel=r"$\phi$", ylabel="over that of emulsions", ylim=(0.65, 1.25))
    axes[2].set_xticks([0.70, 0.75, 0.80, 0.85])
    for letter, each in zip("abc", axes, strict=True):
        each.set_title(f"({letter})", loc="left", fontsize=10)
    axes[0].legend(frameon=False, fontsize=8)
    axes[2].legend(frameon=False, fontsize=8)
    figure.savefig(file, dpi=150)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=512, help="droplets of a packing")
    parser.add_argument("--packings", type=int, default=8, help="of each kind")
    parser.add_argument("--workers", type=int, help="packings at a time")
    asked = options_of(parser, __file__)
    file = Path(f"emulsion_3d_{asked.number}.json")
    packings = json.loads(file.read_text()) if file.exists() else []
    known = {(packing["kind"], packing["seed"]) for packing in packings}
    seeds = range(1, asked.packings + 1)
    calls = [
        (kind, asked.number, seed) for seed in seeds for kind in KINDS if (kind, seed) not in known
    ]
    packings += over_cores(measure, calls, asked.workers, file.with_suffix(".kept"))
    file.write_text(json.dumps(packings))
    packings.sort(key=lambda one: (one["seed"], one["kind"]))
    print(*lines(packings, asked.number), sep="\n")
    draw(packings, file.with_suffix(".png"))


if __name__ == "__main__":
    main()

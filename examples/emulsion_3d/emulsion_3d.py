"""An emulsion in space: pressure, shear modulus and loads, and how it lies under its own weight.

python emulsion_3d.py --number 128 --packings 8

A packing that is measured is kept in emulsion_3d_NUMBER.json, and not measured again.
"""

import argparse
import json
import math
from pathlib import Path

import deformable
import matplotlib.pyplot as plt
import numpy as np

RADII = (1.0, 1.2)  # of equal numbers, so that they do not crystallize
RADIUS = np.mean(RADII)
TENSION = 1.0
UNIT = TENSION / RADIUS  # of pressures and moduli
PHI = (0.66, 0.68, 0.70, 0.73, 0.76, 0.79, 0.82, 0.85)
STRAIN = 1e-4  # to both sides, for the shear modulus
NAMES = ("pressure", "coordination", "shear", "load")
HEADS = ("phi", "pressure", "3.2 (phi - 0.64)^2/sqrt(1 - phi)", "shear modulus")
HEADS = (*HEADS, "1.6 phi (phi - 0.64)", "z", "load")


def measure(number, seed):
    """phi_J of a packing of spheres, and a row for each phi."""
    start = deformable.bidisperse(number, radii=RADII, dimension=3, seed=seed)
    jammed = deformable.jam(start)
    rows = []
    with deformable.Simulation(jammed, deformable.Droplet(TENSION)) as sim:
        for phi in PHI:
            (state,) = deformable.compress(sim, phi=phi, steps=1)
            values = state.pressure / UNIT, state.coordination, shear_modulus(state) / UNIT
            rows.append([*map(float, values), float(state.load.mean()), float(state.load.max())])
    return {"seed": seed, "phi_J": jammed.phi, "rows": rows}


def shear_modulus(state):
    """From two opposite strains of the relaxed state."""
    stress = []
    for strain in (STRAIN, -STRAIN):
        with deformable.Simulation(state, state.law) as sim:
            (sheared,) = deformable.shear(sim, strain, steps=1, tolerance=1e-7)
        stress.append(sheared.shear_stress)
    return (stress[0] - stress[1]) / (2.0 * STRAIN)


def master_curve(phi):
    """Osmotic pressure of emulsions, as published."""
    return 3.2 * (phi - 0.64) ** 2 / np.sqrt(1.0 - phi)


def mason(phi):
    """Shear modulus of emulsions (Mason, Bibette and Weitz 1995)."""
    return 1.6 * phi * (phi - 0.64)


def means(packings):
    """Means over the packings and their errors, each of shape (phi, quantities).

    A shear modulus that is not positive is that of a packing that gives way, and is left out.
    """
    rows = np.array([packing["rows"] for packing in packings])
    rows[..., 2][rows[..., 2] <= 0.0] = np.nan
    return deformable.jackknife(lambda some: np.nanmean(some, axis=0), rows)


def height(phi, pressure, onset):
    """Height above the floor of floating droplets, from dp/dz = weight phi [pressure/weight].

    It is 0 at the densest point, and the emulsion ends where its pressure does, at the onset.
    """
    phi, pressure = np.append(onset, phi), np.append(0.0, pressure)
    depth = np.append(0.0, np.cumsum(np.diff(pressure) / (0.5 * (phi[1:] + phi[:-1]))))
    return depth[-1] - depth, phi


def table(packings, number):
    """phi_J, and the lines of the table, with errors of the last digits."""
    onset, error = deformable.jackknife(np.mean, [packing["phi_J"] for packing in packings])
    yield f"phi_J = {with_error(onset, error)}, {len(packings)} packings of {number} droplets"
    yield "| " + " | ".join(HEADS) + " |"
    yield "|" + "---|" * len(HEADS)
    for phi, values, errors in zip(PHI, *means(packings), strict=True):
        p, z, shear, load, _ = (with_error(*pair) for pair in zip(values, errors, strict=True))
        curves = f"{master_curve(phi):.4f}", f"{mason(phi):.3f}"
        yield f"| {phi} | {p} | {curves[0]} | {shear} | {curves[1]} | {z} | {load} |"


def with_error(value, error):
    """Both with as many decimals as the error has with two digits."""
    if not error > 1e-9 * abs(value):
        return f"{value:.4g}"
    decimals = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def draw(packings, file):
    """Pressure, shear modulus and loads over phi, and phi over the height."""
    figure, ((one, two), (three, four)) = plt.subplots(2, 2, figsize=(9, 7.2), layout="constrained")
    (pressure, _, shear, load, largest), errors = (each.T for each in means(packings))
    dense = np.linspace(0.645, 0.86, 200)
    for axes, values, error, curve, name in (
        (one, pressure, errors[0], master_curve, r"osmotic pressure [$\gamma/R$]"),
        (two, shear, errors[2], mason, r"shear modulus [$\gamma/R$]"),
    ):
        axes.errorbar(PHI, values, error, fmt="o", ms=4, label="Droplet")
        axes.plot(dense, curve(dense), "k--", lw=1, label="emulsions, published")
        axes.set(xlabel=r"$\phi$", ylabel=name)
        axes.legend(frameon=False)
    three.errorbar(PHI, load, errors[3], fmt="o", ms=4, label="mean load")
    three.plot(PHI, largest, "s", ms=4, label="largest load")
    three.axhline(0.4, color="k", ls=":", lw=1)
    three.set(xlabel=r"$\phi$", ylabel="part of the surface in facets", yscale="log")
    three.legend(frameon=False)
    onset = np.mean([packing["phi_J"] for packing in packings])
    four.plot(*height(PHI, pressure, onset)[::-1], "o-", ms=4)
    four.set(xlabel=r"$\phi$", ylabel=r"height [$\gamma/(R\,\Delta\rho\,g)$]")
    figure.savefig(file, dpi=80)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=512, help="droplets of a packing")
    parser.add_argument("--packings", type=int, default=8)
    asked = parser.parse_args()
    file = Path(f"emulsion_3d_{asked.number}.json")
    packings = json.loads(file.read_text()) if file.exists() else []
    for seed in range(len(packings) + 1, asked.packings + 1):
        packings.append(measure(asked.number, seed))
        file.write_text(json.dumps(packings))
    print(*table(packings, asked.number), sep="\n")
    draw(packings, file.with_suffix(".png"))


if __name__ == "__main__":
    main()

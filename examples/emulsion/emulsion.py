"""An emulsion: droplets are jammed and compressed towards confluence, and measured on the way.

python emulsion.py
"""

import json
import math

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

# Droplets keep their area and have a line tension of 1; films between them curve as pressures say.
DROPLETS = ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact="curved")
RADII = (0.5, 0.7)
UNIT = 1.0 / np.mean(RADII)  # of pressures and moduli: tension/R0, with R0 the mean radius

NUMBER, SEEDS = 64, range(1, 9)
PHI = (0.85, 0.86, 0.88, 0.90, 0.92, 0.95, 0.97, 0.98, 0.99)
SHOWN = 0.95  # phi of the picture
HEADS = ("phi", "pressure", "coordination", "shear modulus", "bulk modulus", "shape")


def measure(seed):
    """A packing from its onset to the last phi: phi_J, and a row for each phi."""
    loose = ld.bidisperse(NUMBER, sizes=RADII, seed=seed)
    jammed = ld.jam(loose, DROPLETS, tolerance=1e-6).packing  # 1e-6 above the onset
    rows = []
    with ld.Simulation(jammed, DROPLETS) as sim:
        for phi in PHI:
            (state,) = sim.compress(phi=phi)[1:]
            moduli = state.moduli()
            shear, bulk = moduli.mean_shear_modulus / UNIT, moduli.bulk_modulus / UNIT
            shape = float(state.shape_parameter.mean())
            rows.append((state.pressure / UNIT, state.coordination, shear, bulk, shape))
            if (seed, phi) == (SEEDS[0], SHOWN):
                state.save("packing", mode="w")
    return {"phi_J": jammed.phi, "rows": rows}


def means(packings):
    """Means over the packings and their errors, each of shape (phi, quantities)."""
    rows = [packing["rows"] for packing in packings]
    return ld.jackknife(rows, lambda some: np.mean(some, axis=0))


def table(packings):
    """phi_J, and the lines of the table, with errors of the last digits."""
    onset, error = ld.jackknife([packing["phi_J"] for packing in packings])
    yield f"phi_J = {with_error(onset, error)}, {len(packings)} packings of {NUMBER} droplets"
    yield "| " + " | ".join(HEADS) + " |"
    yield "|" + "---|" * len(HEADS)
    for phi, *both in zip(PHI, *means(packings), strict=True):
        cells = (with_error(*pair) for pair in zip(*both, strict=True))
        yield f"| {phi} | " + " | ".join(cells) + " |"


def with_error(value, error):
    """Both with as many decimals as the error has with two digits."""
    if not error > 1e-9 * abs(value):
        return f"{value:.4g}"
    decimals = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def princen(phi):
    """Pressure and shear modulus of a hexagonal array of equal droplets [tension/R]."""
    onset = np.pi / np.sqrt(12.0)
    pressure = np.sqrt(phi / onset) * (np.sqrt((1.0 - onset) / (1.0 - phi)) - 1.0)
    return pressure, np.sqrt(np.sqrt(3.0) / (2.0 * np.pi) * phi)


def draw(packings, file):
    """A packing, and pressure, contacts and moduli over phi."""
    figure, ((one, two), (three, four)) = plt.subplots(2, 2, figsize=(9, 7.6), layout="constrained")
    with ld.Run("packing").simulation() as sim:
        sim.state().plot(one)
    (pressure, z, shear, bulk, _), errors = (each.T for each in means(packings))
    dense = np.linspace(0.907, 0.992, 200)[1:]
    array = {"color": "k", "ls": "--", "lw": 1, "label": "hexagonal array (Princen)"}
    two.errorbar(PHI, pressure, errors[0], fmt="o", ms=4, label="droplets")
    two.semilogy(dense, princen(dense)[0], **array)
    two.set(ylabel=r"pressure [$\gamma/R_0$]", ylim=(1e-3, None))
    three.errorbar(PHI, z, errors[1], fmt="o", ms=4)
    three.set(ylabel="contacts of a droplet")
    four.errorbar(PHI, bulk, errors[3], fmt="o", ms=4, label="bulk modulus")
    four.errorbar(PHI, shear, errors[2], fmt="o", ms=4, label="shear modulus")
    four.semilogy(dense, princen(dense)[1], **array)
    four.set(ylabel=r"[$\gamma/R_0$]")
    for axes in (two, three, four):
        axes.set(xlabel=r"$\phi$")
    two.legend(frameon=False)
    four.legend(frameon=False)
    figure.savefig(file, dpi=80)


if __name__ == "__main__":
    packings = ld.parallel_map(measure, SEEDS)
    with open("emulsion.json", "w") as file:
        json.dump(packings, file, separators=(",", ":"))
    print(*table(packings), sep="\n")
    draw(packings, "emulsion.png")

"""An emulsion: droplets are jammed and compressed towards confluence, and measured on the way.

python emulsion.py                                  eight packings of 64 droplets
python emulsion.py --number 512 --seeds 8           the ensemble of the README
"""

import argparse
import json
import math
import warnings

import deformable
import fits
import numpy as np

# Droplets keep their area and have a line tension of 1. Pressures and moduli are given in units
# of tension/R0, with R0 the mean radius.
DROPLETS = deformable.Ring(kA=math.inf, kP=0.0, tension=1.0)
RADII = (0.5, 0.7)
UNIT = 1.0 / np.mean(RADII)

ONSET = 1e-6  # pressure at which a packing counts as jammed: phi is 1e-6 above phi_J there
NEAR = 1e-4 * 2.0 ** np.arange(10)  # phi - phi_J, up to 0.05
DENSE = (0.92, 0.95, 0.97, 0.98, 0.99, 0.995)  # phi
SHOWN = 0.95  # phi of the picture


def measure(number, seed):
    """One packing from its onset to phi = 0.995; lists with one number for each phi."""
    warnings.simplefilter("ignore", deformable.UnjammedWarning)  # expected near the onset
    loose = deformable.bidisperse(number, radii=RADII, seed=seed)
    onset = deformable.jam(loose, DROPLETS, pressure=ONSET, tolerance=1e-6)
    table = []
    with deformable.Simulation(onset, DROPLETS) as sim:
        jammed = sim.relax()
        for phi in (*(jammed.phi + NEAR), *DENSE):
            sim.deform(onset.at(phi).box)
            state = sim.relax(1e-8)
            table.append({"phi": state.phi, "excess_phi": state.phi - jammed.phi, **row(state)})
            table[-1] |= moduli(state, 0.01 * min(state.phi - jammed.phi, 1.0 - state.phi))
            if seed == 1 and phi == SHOWN:
                state.save(f"packing_{number}")
    columns = {name: [float(f"{line[name]:.6g}") for line in table] for name in table[0]}
    more = jammed.network_contacts - jammed.isostatic_contacts
    onset = {"phi_J": jammed.phi, "rattlers": int(jammed.rattlers.sum()), "excess_contacts": more}
    return {"seed": seed} | onset | columns


def row(state):
    """Pressure, contacts and shape; z - z_iso counts the contacts of droplets that bear forces."""
    more = state.network_contacts - state.isostatic_contacts
    return {
        "pressure": state.pressure / UNIT,
        "coordination": state.coordination,
        "excess_coordination": 4.0 * more / (state.isostatic_contacts + 1),
        "shape_parameter": state.shape_parameter.mean(),
        "beyond": state.beyond,
        "residual": state.residual,
    }


def moduli(state, strain):
    shear, bulk = deformable.shear_modulus(state, strain), deformable.bulk_modulus(state, strain)
    return {
        "shear_modulus": shear.value / UNIT,
        "bulk_modulus": bulk.value / UNIT,
        "linear": shear.linear and bulk.linear,
    }


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("--number", type=int, default=64, help="droplets in a packing")
    options.add_argument("--seeds", type=int, default=8, help="packings")
    options.add_argument("--workers", type=int, help="packings at a time; one per core if omitted")
    given = options.parse_args()
    if given.seeds < 1:
        options.error(f"--seeds must be at least 1, not {given.seeds}")
    run = f"emulsion_{given.number}"
    calls = [(given.number, seed) for seed in range(1, given.seeds + 1)]
    # each packing is kept as soon as it is measured: an interrupted run goes on from there
    packings = deformable.parallel_map(measure, calls, given.workers, keep=f"{run}_kept")
    result = {"number": given.number, "packings": packings}
    with open(f"{run}.json", "w") as file:
        json.dump(result, file, separators=(",", ":"))
    fits.show(result)
    fits.draw(result, f"packing_{given.number}", f"{run}.png")

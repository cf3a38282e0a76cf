"""Foam or soft particles? How many contacts packings gain above the onset of jamming, by law.

python foam_or_particles.py --number 32 --seeds 2      ten seconds
python foam_or_particles.py                            512 particles in 8 packings: the page's
python foam_or_particles.py --number 2048 --seeds 5 --laws disks
"""

import argparse
import json
import math
import time
import warnings

import lammps_deformable as ld
import numpy as np

from validation.foam_or_particles import fits, picture

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
    loose = ld.bidisperse(number, radii=RADII, seed=seed)
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
        (state,) = ld.compress(sim, phi=phi, steps=1, tolerance=TOLERANCE)
        yield state


def decompressed(sim, unit):
    """Back to the onset, first by phi, then by pressure, which tells how near the onset is."""
    for phi in DENSE[-2::-1]:
        (state,) = ld.compress(sim, phi=phi, steps=1, tolerance=TOLERANCE)
        yield state
    for pressure in (*PRESSURES, 10.0 * ONSET):
        yield sim.relax(TOLERANCE, pressure=pressure * unit)


def row(state, unit):
    """What is measured of a state. One without a contact network has numbers that are nan."""
    try:
        moduli = state.elastic_moduli()
        shear, bulk = moduli.mean_shear_modulus / unit, moduli.bulk_modulus / unit
    except ld.ParameterError:  # it resists no strain
        shear = bulk = math.nan
    rigid = state.coordination > 0.0
    return {
        "phi": state.phi,
        "pressure": state.pressure / unit,
        "coordination": state.coordination if rigid else math.nan,
        "excess": [state.excess_coordination(t) if rigid else math.nan for t in fits.THRESHOLDS],
        "degrees": np.bincount(state.network_degree, minlength=MOST + 1)[: MOST + 1].tolist(),
        "bulk_modulus": bulk,
        "shear_modulus": shear,
        "residual": state.residual,
    }


def columns(rows):
    return {name: [short(each[name]) for each in rows] for name in rows[0]}


def short(value):
    """Six digits; None in the place of nan."""
    if isinstance(value, list):
        return [short(each) for each in value]
    if isinstance(value, int):
        return value
    return float(f"{value:.6g}") if math.isfinite(value) else None


def cost(sim, began, before=0):
    """Processor time [s] and iterations of the minimizer since then."""
    seconds = round(time.process_time() - began, 2)
    return {"seconds": seconds, "iterations": sim.lmp.extract_global("ntimestep") - before}


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--number", type=int, default=512, help="particles in a packing")
    options.add_argument("--seeds", type=int, default=8, help="packings")
    options.add_argument("--laws", nargs="+", choices=LAWS, default=list(LAWS))
    options.add_argument("--workers", type=int, help="packings at a time; one per core if omitted")
    given = options.parse_args()
    if given.seeds < 2:
        options.error(f"--seeds must be at least 2, for errors, not {given.seeds}")
    run = f"rows_{given.number}"
    # seed by seed: an interrupted run has some packings of all laws
    calls = [(law, given.number, seed + 1) for seed in range(given.seeds) for law in given.laws]
    # each packing is kept as soon as it is measured: the same command goes on after an interruption
    found = ld.parallel_map(measure, calls, given.workers, keep=f"{run}_kept")
    rows = [each for both in found for each in both]
    with open(f"{run}.json", "w") as file:
        file.write(
            "[" + ",\n".join(json.dumps(each, separators=(",", ":")) for each in rows) + "]\n"
        )
    print(*fits.page(rows), sep="\n")
    picture.draw(rows, f"foam_or_particles_{given.number}.png")


if __name__ == "__main__":
    main()

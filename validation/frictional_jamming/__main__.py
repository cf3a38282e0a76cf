"""Jamming with friction: packing fraction and contacts at the onset over the friction of contacts.

python frictional_jamming.py          20 s: 32 droplets at three coefficients of friction
python frictional_jamming.py large    five minutes of processor time: 64 droplets at seven
"""

import argparse
import json
import math
import time
from pathlib import Path

import lammps_deformable as ld
import numpy as np

from validation.ensembles import over_cores
from validation.frictional_jamming import results

# Droplets of radii 1 : 1.4 and mass 1 that keep their area. A contact has the stiffness 2 to 4, so
# that these springs and dashpots are as stiff, and damp a bounce nearly.
LAW = ld.Ring(kA=math.inf, kP=0.0, tension=1.0)
SPRING, DASHPOT, DAMPING = 1.0, 0.5, 1.0
TIMESTEP = 0.08  # the longest stable one for any contacts of these droplets
LOOSE = 0.7

# particles, packings, coefficients of friction, pressures one after another, inertial number
PLANS = {
    "small": (32, 4, (0.0, 0.1, 10.0), (5e-4, 2e-3), 5e-3),
    "large": (64, 20, (0.0, 0.01, 0.03, 0.1, 0.3, 1.0, 10.0), (1e-4, 4e-4, 1.6e-3), 2e-3),
}

# A contact is fully mobilized from this part of Coulomb's bound on.
MOBILIZED = 0.999


def measure(sim, state, mu):
    """Numbers of a state at rest."""
    contacts = state.contact_table[state.contact_table["i"] < state.contact_table["j"]]
    normal, along = contacts["force"], np.abs(contacts["friction"])
    used = along / (mu * normal) if mu else np.zeros(len(contacts))
    free = state.rattlers[contacts["i"]] | state.rattlers[contacts["j"]]
    force = np.linalg.norm(np.reshape(sim.lmp.gather("f", 1, 3), (-1, 3)), axis=1)
    torque = np.reshape(sim.lmp.gather("torque", 1, 3), (-1, 3))[:, 2] / state.packing.radius
    numbers = {
        "phi": state.phi,
        "pressure": state.pressure,
        "rigid": int(np.sum(~state.rattlers)),
        "contacts": state.network_contacts,
        "z": state.coordination,
        "mobilized": int(np.sum(used[~free] > MOBILIZED)),
        "mobilization": used[~free].mean(),
        "coulomb": np.max(along - mu * normal) / normal.mean(),
        "force": force.max() / normal.mean(),
        "torque": np.abs(torque).max() / normal.mean(),
        "at_rest": not state.stalled,
    }
    return {name: n if isinstance(n, int) else float(f"{n:.6g}") for name, n in numbers.items()}


def jammed(number, mu, seed, pressures, inertial_number):
    """A loose packing that is compressed to a pressure, and to higher ones from there."""
    begun = time.process_time()
    friction = ld.Friction(mu, SPRING, DASHPOT, damp=DAMPING)
    start = ld.push_off(ld.bidisperse(number, phi=LOOSE, seed=seed))
    found = []
    with ld.Simulation(start, LAW, friction=friction) as sim:
        for pressure in pressures:
            state = ld.settle(sim, pressure, inertial_number=inertial_number, timestep=TIMESTEP)
            found.append(measure(sim, state, mu))
    seconds = time.process_time() - begun
    return {"mu": mu, "seed": seed, "seconds": round(seconds, 1), "states": found}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("plan", nargs="?", default="small", choices=PLANS)
    parser.add_argument("--workers", type=int, help="processes, all cores if not given")
    asked = parser.parse_args()
    number, packings, frictions, pressures, slow = PLANS[asked.plan]
    calls = [
        (number, mu, seed, pressures, slow) for seed in range(1, packings + 1) for mu in frictions
    ]
    keep = f"{asked.plan}_kept"
    rows = over_cores(jammed, calls, asked.workers, keep)
    found = {"number": number, "pressures": pressures, "inertial_number": slow, "packings": rows}
    Path(f"{asked.plan}.json").write_text(json.dumps(found, indent=1) + "\n")
    results.write(found, asked.plan)


if __name__ == "__main__":
    main()

"""Equal droplets in a heat bath: a motion in legs, each of which is kept in a folder."""

import math
import time
from dataclasses import replace

import lammps_deformable as ld
import numpy as np

from validation.ensembles import once

# Droplets have the radius 1, the line tension 1 and the mass 1, and hardly change their area: hot
# ones that may not change it at all find no shape now and then, which ends a run.
LAW = ld.Ring(kA=30.0, kP=0.0, tension=1.0, contact="curved")
BATH = {"friction": 0.1, "timestep": 0.06, "tolerance": 1e-4}
STEPS, SAMPLES = 4000, 25  # of a leg
PHI = 0.92


def crystal(number, phi):
    side = math.isqrt(number)
    return ld.triangular(side, side, radius=1.0, phi=phi)


def spacing(packing):
    """Of the lattice that fits into the box."""
    return packing.box[0, 0] / math.isqrt(len(packing))


def begin(number, phi, start, seed):
    """Positions before the first leg: the crystal, or random ones of droplets that balance."""
    packing = crystal(number, phi)
    if start == "random":
        at = np.random.default_rng(seed).random((number, 2)) @ packing.box
        packing = ld.push_off(replace(packing, positions=at))
        with ld.Simulation(packing, LAW) as sim:
            packing = sim.relax(1e-2).packing
    return packing.positions


def leg(number, phi, temperature, seed, positions, law=LAW, bath=BATH, steps=STEPS):
    """Some thousand steps from given positions: energies, stresses, places and psi_6 of samples.

    Velocities are drawn anew, as the bath would. A droplet may find no shape: then the run ends.
    """
    begun, packing = time.process_time(), replace(crystal(number, phi), positions=positions)
    rows, places, order = [], [], []
    try:
        with ld.Simulation(packing, law) as sim:
            for state in ld.move(
                sim, steps, temperature=temperature, every=steps // SAMPLES, seed=seed, **bath
            ):
                rows.append(
                    {
                        "energy": state.energy / number,
                        "pressure": state.pressure + number * temperature / packing.area,
                        "stress": state.stress.tolist(),
                        "z": state.coordination,
                        "bath": state.temperature / temperature,
                        "beyond": state.beyond / number,
                    }
                )
                places.append(state.packing.positions)
                order.append(state.hexatic())
    except ld.LammpsError as error:
        return {"ended": str(error), "seconds": time.process_time() - begun}
    return {
        "rows": rows,
        "places": np.array(places),
        "order": np.array(order),
        "seconds": time.process_time() - begun,
    }


def kept(function, arguments, folder):
    """The result of a call, from a folder of pickles that has it."""
    return once(folder, function, *arguments)

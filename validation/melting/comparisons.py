"""Comparisons: other time steps and laws, energies at rest, and polygons."""

import math
import time
from dataclasses import replace

import lammps_deformable as ld
import numpy as np

from validation.melting.limits import harmonic
from validation.melting.motion import BATH, LAW, PHI, STEPS, begin, crystal, kept, leg
from validation.melting.order import defects, neighbors

EXACT = BATH | {"timestep": 0.03, "tolerance": 1e-8}
SETTINGS = {
    "curved, 0.06, 1e-4": (LAW, BATH, STEPS),
    "curved, 0.03, 1e-8": (LAW, EXACT, 2 * STEPS),
    "balanced, 0.06, 1e-4": (replace(LAW, contact="balanced"), BATH, STEPS),
}

# Laws whose crystal and whose packings with defects have energies to be compared.
LAWS = {
    "droplets": LAW,
    "soft droplets": ld.Ring(kA=3.0, kP=0.0, tension=1.0, contact="curved"),
    "rings": ld.Ring(kA=1.0, contact="curved"),
    "soft rings": ld.Ring(kA=1.0, kP=0.1, contact="curved"),
}


def check(name, temperature, folder, number=256, legs=3):
    """Energy and pressure with one of the settings, from the crystal; the first leg is left out."""
    law, bath, steps = SETTINGS[name]
    positions, rows, seconds = begin(number, PHI, "crystal", 1), [], 0.0
    for n in range(legs):
        call = number, PHI, temperature, n + 1, positions, law, bath, steps
        found = kept(leg, call, folder)
        positions = found["places"][-1]
        seconds += found["seconds"]
        rows.append([(row["energy"], row["pressure"]) for row in found["rows"]])
    (energy, pressure), errors = ld.jackknife(lambda some: np.mean(some, axis=(0, 1)), rows[1:])
    return {
        "settings": name,
        "T": temperature,
        "energy": [float(energy), float(errors[0])],
        "pressure": [float(pressure), float(errors[1])],
        "microseconds": 1e6 * seconds / (legs * steps * number),
    }


def solid(law, phi):
    """Moduli of the crystal at rest, and where its dislocations would unbind with these."""
    return {"law": law, "phi": phi} | harmonic(phi, LAWS[law])


def quench(law, number, phi, positions, start, temperature):
    """Energy of a particle at rest above that of the crystal, order, and part with defects."""
    packing, energies = crystal(number, phi), []
    scaled = positions * packing.box[0, 0] / crystal(number, PHI).box[0, 0]
    for at in (packing.positions, scaled):
        begun = ld.push_off(replace(packing, positions=at))
        with ld.Simulation(begun, LAWS[law]) as sim:
            state = sim.relax(1e-3)
        energies.append(state.energy / number)
    box, places = state.packing.box.diagonal(), state.packing.positions
    return {
        "law": law,
        "phi": phi,
        "start": start,
        "T": temperature,
        "crystal": energies[0],
        "excess": energies[1] / energies[0] - 1.0,
        "psi": float(abs(state.hexatic().mean())),
    } | defects(neighbors(places, box), number)


def polygons(number=16, vertices=76, steps=2000):
    """Processor time of smooth polygons with the same stiffnesses, cold, at constant energy.

    The mass of a particle is shared by its vertices. Steps are the part 1/2 of the time in which
    the fastest vertex would turn by a radian; twice as long ones are unstable.
    """
    model = ld.PolygonModel(
        vertices=vertices, radius=0.02, kL=float(vertices), kA=30.0, kr=300.0, smooth=True
    )
    with ld.Simulation(crystal(number, 0.88), model) as sim:
        fastest = sim.polygons.fastest_frequency(model.kr) * math.sqrt(vertices)
        step = 0.5 / fastest
        sim.lmp.commands_string(
            f"mass * {1.0 / vertices!r}\nvelocity all create 1e-3 1 dist gaussian\n"
            f"fix move all nve\nfix plane all enforce2d\ntimestep {step!r}\nrun 100 post no"
        )
        begun = time.process_time()
        sim.lmp.command(f"run {steps} post no")
        seconds = time.process_time() - begun
    each = 1e6 * seconds / steps / number
    return {"vertices": vertices, "step": step, "microseconds": each}

"""What is known exactly, or by other means: the crystal at rest, and gases."""

import math

import lammps_deformable as ld
import numpy as np
from scipy.integrate import simpson

from validation.melting.motion import BATH, LAW, crystal, spacing


def harmonic(phi, law=LAW):
    """Pressure and moduli of the crystal at rest, and where its dislocations would unbind.

    Kosterlitz, Thouless, Halperin, Nelson and Young: T = Y a^2 / 16 pi with Y = 4 G K / (G + K), of
    the moduli at this temperature. Those at rest give an estimate.
    """
    with ld.Simulation(crystal(64, phi), law) as sim:
        state = sim.relax(1e-8)
        moduli = state.elastic_moduli()
    shear, bulk = moduli.mean_shear_modulus, moduli.bulk_modulus
    young = 4.0 * shear * bulk / (shear + bulk)
    unbinding = young * spacing(state.packing) ** 2 / (16.0 * math.pi)
    return {"pressure": state.pressure, "G": shear, "K": bulk, "unbinding": float(unbinding)}


def pair(distances):
    """Energy and virial -r dU/dr of two droplets at distances, from states of both alone."""
    energies, virials = [], []
    for distance in distances:
        places, box = [[0.0, 0.0], [distance, 0.0]], np.diag([12.0, 12.0])
        with ld.Simulation(ld.Packing(places, [0, 0], [1.0], box), LAW) as sim:
            state = sim.state()
        energies.append(state.energy)
        virials.append(2.0 * state.pressure * state.packing.area)
    return np.array(energies), np.array(virials)


def second_virial(temperature):
    """B_2 = pi integral (1 - exp(-U/T)) r dr, and the same from the virials.

    Within the nearest distance the weight is 0.
    """
    r = np.linspace(1.6, 2.0, 41)
    energy, virial = pair(r)
    weight = np.exp(-energy / temperature)
    by_energy = np.pi * (r[0] ** 2 / 2.0 + simpson((1.0 - weight) * r, x=r))
    by_pressure = np.pi / (2.0 * temperature) * simpson(r * virial * weight, x=r)
    return by_energy, by_pressure


def dilute(phi, temperature=0.02, number=64, steps=20_000):
    """p A / N T of a gas by motion, and by virial coefficients; the third one is that of disks."""
    packing, rows = crystal(number, phi), []
    with ld.Simulation(packing, LAW) as sim:
        for state in ld.move(sim, steps, temperature=temperature, every=10, seed=1, **BATH):
            rows.append(1.0 + state.pressure * packing.area / number / temperature)
    blocks = np.array_split(rows[len(rows) // 10 :], 20)
    found, error = ld.jackknife([block.mean() for block in blocks])
    x = second_virial(temperature)[0] * number / packing.area
    return {
        "phi": phi,
        "temperature": temperature,
        "z": float(found),
        "error": float(error),
        "virial": float(1.0 + x + 0.782 * x**2),
    }

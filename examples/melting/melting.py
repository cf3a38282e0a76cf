"""Melting: equal droplets in a heat bath, from a crystal and from random positions.

python melting.py               a minute: 64 particles at four temperatures
python melting.py middle        some minutes: 256 particles at three temperatures
python melting.py large         up to 16 384 particles: two months of processor time
"""

import argparse
import itertools
import json
import math
import time
from dataclasses import replace

import deformable
import numpy as np
import results
from scipy.integrate import simpson
from scipy.spatial import cKDTree

# Droplets have the radius 1, the line tension 1 and the mass 1, and hardly change their area: hot
# ones that may not change it at all find no shape now and then, which ends a run.
LAW = deformable.Ring(kA=30.0, kP=0.0, tension=1.0, contact="curved")
PHI = 0.92
# A step of the integrator is below the longest stable one at all these temperatures.
BATH = {"friction": 0.1, "timestep": 0.03}
SAMPLES, BINS = 40, 24  # of each leg; of g_6

# of each size: temperatures, legs, and steps of a leg
MELTING = tuple(n / 400 for n in range(28, 41))
PLANS = {
    "small": {64: ((0.02, 0.06, 0.08, 0.1), 6, 4000)},
    "middle": {256: ((0.06, 0.08, 0.1), 4, 4000)},
    "large": {
        1024: (MELTING, 50, 20_000),
        4096: (MELTING, 50, 20_000),
        16_384: (MELTING, 100, 40_000),
    },
}
STARTS = ("crystal", "random")


def crystal(number, phi=PHI):
    side = math.isqrt(number)
    return deformable.triangular(side, side, radius=1.0, phi=phi)


def spacing(packing):
    return packing.box[0, 0] / math.isqrt(len(packing))


def started(number, start):
    """Positions before the first leg."""
    packing = crystal(number)
    if start == "random":
        at = np.random.default_rng(number).random((number, 2)) @ packing.box
        packing = deformable.push_off(replace(packing, positions=at))
    return packing.positions


def bragg_peaks(packing):
    """The three shortest wave vectors of the lattice that fits into the box, but for signs."""
    side, (lx, ly) = math.isqrt(len(packing)), packing.box.diagonal()
    return 2.0 * np.pi * side * np.array([[0.0, 1 / ly], [1 / lx, 0.5 / ly], [1 / lx, -0.5 / ly]])


def pressure(state, temperature):
    """Of contacts and motion: half the trace of the stress, and N T over the area."""
    return state.pressure + len(state.packing) * temperature / state.packing.area


def measure(state, temperature):
    """Order, defects, contacts, pressure and energy of one state, a number each."""
    psi = state.hexatic().mean()
    return {
        "psi_x": psi.real,
        "psi_y": psi.imag,
        "bragg": np.mean(np.abs(state.density_waves(bragg_peaks(state.packing))) ** 2),
        "defects": np.mean(state.cell_sides != 6),
        "z": state.coordination,
        "pressure": pressure(state, temperature),
        "energy": state.energy / len(state.packing),
        "bath": state.temperature / temperature,
        "beyond": state.beyond / len(state.packing),
    }


def neighbors(packing, cutoff):
    """Pairs of particles up to a distance, and the vectors between them."""
    box = packing.box.diagonal()
    tree = cKDTree(packing.positions % box, boxsize=box)
    i, j = tree.query_pairs(cutoff, output_type="ndarray").T
    return i, j, apart(packing, i, j)


def apart(packing, i, j):
    box = packing.box.diagonal()
    between = packing.positions[j] - packing.positions[i]
    return between - box * np.rint(between / box)


def leg(number, temperature, start, seed, steps, positions):
    """Some thousand steps from given positions; what was measured, and where they ended.

    Velocities are drawn anew, as the bath would. Neighbors that keep their places move apart by a
    small <(u_i - u_j)^2> / 2 a^2 (Lindemann). A droplet may find no shape: then the run ends.
    """
    begun, packing = time.process_time(), replace(crystal(number), positions=positions)
    i, j, before = neighbors(packing, 1.4 * spacing(packing))
    r_max = 0.495 * packing.box.diagonal().min()
    rows, curves, found = [], [], {"number": number, "temperature": temperature, "start": start}
    try:
        with deformable.Simulation(packing, LAW) as sim:
            if start == "random" and seed == 1:
                sim.relax(1e-2)  # soft disks that balance are no droplets that do
            every = steps // SAMPLES
            for state in deformable.move(
                sim, steps, temperature=temperature, every=every, seed=seed, **BATH
            ):
                rows.append(measure(state, temperature))
                r, g6 = state.hexatic_correlation(r_max, BINS)
                curves.append(g6)
    except deformable.LammpsError as error:
        return found | {"ended": str(error), "seconds": time.process_time() - begun}
    moved = apart(state.packing, i, j) - before
    return found | {
        "time": steps * BATH["timestep"],
        "series": {name: rounded([row[name] for row in rows]) for name in rows[0]},
        "r": rounded(r),
        "g6": rounded(np.mean(curves, axis=0)),
        "lindemann": float(np.mean(np.sum(moved**2, axis=1)) / 2.0 / spacing(packing) ** 2),
        "seconds": round(time.process_time() - begun, 1),
        "positions": state.packing.positions,
    }


def rounded(values):
    """With five digits; null where there is none."""
    return [float(f"{value:.5g}") if math.isfinite(value) else None for value in values]


def measured(plan, name, workers, save):
    """All legs, those of one round at a time: each begins where that of the last round ended."""
    legs = []
    for number, (temperatures, rounds, steps) in plan.items():
        at = {
            (number, temperature, start): started(number, start)
            for temperature, start in itertools.product(temperatures, STARTS)
        }
        for n in range(1, rounds + 1):
            calls = [(*run, n, steps, positions) for run, positions in at.items()]
            text = f"N = {number}, leg {n} of {rounds}"
            found = deformable.parallel_map(leg, calls, workers, text, keep=f"{name}_kept")
            ends = [each.pop("positions", None) for each in found]
            at = {run: end for run, end in zip(at, ends, strict=True) if end is not None}
            legs += found
            save(legs)
    return legs


def harmonic():
    """Pressure and moduli of the crystal at rest, and where its dislocations would unbind.

    Kosterlitz, Thouless, Halperin, Nelson and Young: T = K a^2 / 16 pi with K = 4 mu (mu + lambda)
    / (2 mu + lambda), of the moduli at this temperature. Those at rest give an estimate.
    """
    with deformable.Simulation(crystal(64), LAW) as sim:
        state = sim.relax(1e-8)
        moduli = state.elastic_moduli()
    mu, bulk = moduli.mean_shear_modulus, moduli.bulk_modulus
    stiffness = 4.0 * mu * bulk / (mu + bulk)
    unbinding = stiffness * spacing(state.packing) ** 2 / (16.0 * math.pi)
    return {"pressure": state.pressure, "G": mu, "K": bulk, "unbinding": float(unbinding)}


def pair(distances):
    """Energy and virial -r dU/dr of two droplets at distances, from states of both alone."""
    energies, virials = [], []
    for distance in distances:
        places, box = [[0.0, 0.0], [distance, 0.0]], np.diag([12.0, 12.0])
        with deformable.Simulation(deformable.Packing(places, [0, 0], [1.0], box), LAW) as sim:
            state = sim.state()
        energies.append(state.energy)
        virials.append(2.0 * pressure(state, 0.0) * state.packing.area)
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


def dilute(phi, temperature=0.02, number=64, steps=40_000):
    """p A / N T of a gas by motion, and by virial coefficients; the third one is that of disks."""
    packing, rows = crystal(number, phi), []
    with deformable.Simulation(packing, LAW) as sim:
        for state in deformable.move(sim, steps, temperature=temperature, every=20, seed=1, **BATH):
            rows.append(pressure(state, temperature) * packing.area / number / temperature)
    blocks = np.array_split(rows[len(rows) // 10 :], 20)
    found, error = deformable.jackknife(np.mean, [block.mean() for block in blocks])
    x = second_virial(temperature)[0] * number / packing.area
    return {
        "phi": phi,
        "temperature": temperature,
        "z": float(found),
        "error": float(error),
        "virial": float(1.0 + x + 0.782 * x**2),
    }


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("plan", nargs="?", default="small", choices=PLANS)
    options.add_argument("--workers", type=int, help="calls at a time; one per core if omitted")
    given = options.parse_args()
    if given.workers is not None and given.workers < 1:
        options.error(f"--workers must be at least 1, not {given.workers}")
    start = {"phi": PHI, **BATH, "crystal": harmonic(), "dilute": [dilute(0.1), dilute(0.2)]}

    def save(legs):
        """After each round: an interrupted run leaves what it has, and goes on from there."""
        with open(f"{given.plan}.json", "w") as file:
            json.dump(start | {"legs": legs}, file, separators=(",", ":"))

    measured(PLANS[given.plan], given.plan, given.workers, save)
    results.report(f"{given.plan}.json")

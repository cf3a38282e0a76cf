"""Disordered crystals: the sizes on a triangular lattice spread until its order is lost.

python disordered_crystals.py                   a minute: 144 particles at one packing fraction
python disordered_crystals.py --full            the figures of docs/disordered_crystals.md
"""

import argparse
import itertools
import json
import math
import time
import warnings
from dataclasses import replace

import lammps_deformable as ld
import numpy as np

from validation.disordered_crystals import results

# Particles have the mean radius 1. Disks have the contact stiffness 1. Rings have kA = 1, and keep
# their perimeter, or may stretch. Droplets keep their area, and have the line tension 1.
LAWS = {
    "disks": None,
    "rings": ld.Ring(kA=1.0, contact="curved"),
    "soft rings": ld.Ring(kA=1.0, kP=0.1, contact="curved"),
    "droplets": ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact="curved"),
}

# The spread eta of the sizes goes up, and then down.
UP = tuple(n / 100 for n in (0, 1, 2, 5, 10, 15, 20, 25, *range(30, 52, 3), 55, 60))
DOWN = (0.5, 0.4, 0.3, 0.2, 0.1, 0.0)
STIFFNESS_AT = (0.0, 0.1, 0.2, 0.3, 0.39, 0.48, 0.6)
DRAWN = (0.3, 0.45, 0.6)  # g_6 over the distance, and packings of the picture

# At one spread phi goes up, and down the same way.
SPREADS = (0.3, 0.4, 0.5)
PHIS = (0.92, 0.93, 0.94, 0.96, 0.98)

# Largest force over the mean contact force; and the spread of the linear response, which is off by
# a part of this size.
TOLERANCE, SMALL = 1e-4, 1e-5

QUICK = {
    "ramps": list(itertools.product(LAWS, (144,), (0.94,), (1, 2))),
    "compressions": list(itertools.product(("droplets",), (144,), (0.4,), (1, 2))),
    "impurities": list(itertools.product(LAWS, (64, 144), (0.94,))),
}
FULL = {
    "ramps": [
        (law, number, phi, seed)
        for number, phi, packings, laws in (
            (1024, 0.94, 8, LAWS),
            (1024, 0.97, 4, LAWS),
            (256, 0.92, 4, LAWS),
            (256, 0.94, 8, LAWS),
            (256, 0.97, 8, LAWS),
            (256, 0.99, 4, LAWS),
            (4096, 0.94, 2, LAWS),
        )
        for seed in range(1, packings + 1)
        for law in laws
    ],
    "compressions": list(itertools.product(LAWS, (144,), SPREADS, range(1, 5))),
    "impurities": list(itertools.product(LAWS, (64, 256, 1024, 4096), (0.94,))),
}


def crystal(number, phi):
    side = math.isqrt(number)
    return ld.triangular(side, side, radius=1.0, phi=phi)


def sizes(number, seed):
    """u of each particle, uniform between -1/2 and 1/2."""
    return np.random.default_rng(seed).uniform(-0.5, 0.5, number)


def spread(packing, u, eta):
    """The packing with radii proportional to 1 + eta u; its box and phi stay."""
    radius = 1.0 + eta * u
    radius *= math.sqrt(len(packing) / np.sum(radius**2))
    return replace(packing, radii=[radius.max()], particle_radii=radius)


def simulation(packing, law):
    return ld.Simulation(packing, law or ld.SoftContact())


def relaxed(packing, law):
    with simulation(packing, law) as sim:
        return sim.relax(TOLERANCE)


def relaxed_at(packing, u, eta, to, law):
    """At another spread than eta; by half of the step first where it leaves a particle no room."""
    try:
        return relaxed(spread(packing, u, to), law)
    except ld.LammpsError:
        if abs(to - eta) < 1e-3:
            raise
    middle = 0.5 * (eta + to)
    packing = relaxed_at(packing, u, eta, middle, law).packing
    return relaxed_at(packing, u, middle, to, law)


def linear_response(packing, law, u):
    """Displacements over eta in the limit of small eta, shape (N, 2): one step of Newton's."""
    with simulation(spread(packing, u, SMALL), law) as sim:
        hessian = sim.state().hessian()
    step = -hessian.response(hessian.gradient)[: hessian.size].reshape(-1, 2)
    return step / SMALL


def mean_square(displacements, packing):
    """In units of the spacing of the lattice, without the motion of all together."""
    spacing = packing.box[0, 0] / math.isqrt(len(packing))
    moved = displacements - displacements.mean(axis=0)
    return np.sum(moved**2) / len(packing) / spacing**2


def bragg_peaks(packing):
    """The three shortest wave vectors of the lattice, but for signs."""
    side, (lx, ly) = math.isqrt(len(packing)), packing.box.diagonal()
    return 2.0 * np.pi * side * np.array([[0.0, 1 / ly], [1 / lx, 0.5 / ly], [1 / lx, -0.5 / ly]])


def correlation(state):
    """Distances up to half of the box, and g_6."""
    return state.hexatic_correlation(0.495 * state.packing.box.diagonal().min(), bins=20)


def measure(state, stiffness):
    """Order, motion from the lattice, contacts and forces, one number each; moduli if asked for."""
    packing, psi = state.packing, state.hexatic()
    r, g6 = correlation(state)
    forces = np.array([force for *_, force in state.graph().edges(data="force")])
    row = {
        "psi6": abs(psi.mean()),
        "local_psi6": np.abs(psi).mean(),
        "g6_far": np.nanmean(g6[r > 0.7 * r.max()]),
        "bragg": np.abs(state.density_waves(bragg_peaks(packing))).mean(),
        "u2": mean_square(state.nonaffine(crystal(len(packing), packing.phi)), packing),
        "force_spread": forces.std() / forces.mean(),
        "z": state.coordination,
        "shape": np.mean(getattr(state, "shape_parameter", 1.0)),
        "pressure": state.pressure,
        "energy": state.energy / len(packing),
        "residual": state.residual,
        "beyond": getattr(state, "beyond", 0),
        "G": math.nan,
        "K": math.nan,
    }
    if stiffness:
        try:
            moduli = state.elastic_moduli()
            row |= {"G": moduli.mean_shear_modulus, "K": moduli.bulk_modulus}
        except ld.ParameterError:  # a motion has no stiffness
            pass
    return row


def columns(rows):
    """A list for each name, of numbers with six digits; null where there is none."""
    return {
        name: [float(f"{row[name]:.6g}") if math.isfinite(row[name]) else None for row in rows]
        for name in rows[0]
    }


def ramp(law, number, phi, seed):
    """The sizes of a crystal spread, and become equal again."""
    warnings.simplefilter("ignore", ld.BeyondModelWarning)  # `beyond` counts
    start, u, packing = time.process_time(), sizes(number, seed), crystal(number, phi)
    found = {"law": law, "number": number, "phi": phi, "seed": seed}
    linear = mean_square(linear_response(packing, LAWS[law], u), packing)
    found |= {"linear_u2": float(f"{linear:.6g}"), "g6": []}
    last = 0.0
    for way, etas in (("up", UP), ("down", DOWN)):
        rows = []
        for eta in etas:
            state = relaxed_at(packing, u, last, eta, LAWS[law])
            packing, last = state.packing, eta
            stiffness = way == "up" and eta in STIFFNESS_AT and number <= 1024
            rows.append({"eta": eta, **measure(state, stiffness)})
            if way == "up" and eta in DRAWN:
                r, g6 = correlation(state)
                curve = columns([{"r": a, "g6": b} for a, b in zip(r, g6, strict=True)])
                found["g6"].append({"eta": eta, **curve})
                if (law, phi, seed) == ("droplets", 0.94, 1):
                    state.save(f"packing_{number}_{eta:g}", overwrite=True)
        found[way] = columns(rows)
    return found | {"seconds": round(time.process_time() - start, 1)}


def compression(law, number, eta, seed):
    """A crystal with spread sizes, compressed and expanded again."""
    warnings.simplefilter("ignore", ld.BeyondModelWarning)
    start, u, packing = time.process_time(), sizes(number, seed), crystal(number, PHIS[0])
    for step in np.arange(1, round(20 * eta)) / 20:
        packing = relaxed(spread(packing, u, step), LAWS[law]).packing
    packing, rows = spread(packing, u, eta), []
    for phi in (*PHIS, *PHIS[-2::-1]):
        state = relaxed(packing.at(phi), LAWS[law])
        packing = state.packing
        rows.append({"phi": phi, **measure(state, stiffness=False)})
    found = {"law": law, "number": number, "eta": eta, "seed": seed, **columns(rows)}
    return found | {"seconds": round(time.process_time() - start, 1)}


def impurity(law, number, phi):
    """Displacements around one particle of another size, and what they say of all sizes.

    All sites of a lattice are alike, and sizes are independent, with the variance 1/12 of u. So the
    mean of <u^2>/eta^2 over all packings is a twelfth of the sum of squares around one impurity.
    """
    start, packing = time.process_time(), crystal(number, phi)
    one = np.zeros(number)
    one[0] = 1.0
    total = number * mean_square(linear_response(packing, LAWS[law], one), packing)
    found = {"law": law, "number": number, "phi": phi, "u2": float(f"{total / 12.0:.6g}")}
    return found | {"seconds": round(time.process_time() - start, 1)}


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("--full", action="store_true", help="the figures of the page")
    options.add_argument("--workers", type=int, help="calls at a time; one per core if omitted")
    given = options.parse_args()
    if given.workers is not None and given.workers < 1:
        options.error(f"--workers must be at least 1, not {given.workers}")
    plan, name = (FULL, "full") if given.full else (QUICK, "quick")
    # each ramp is kept as soon as it is measured: an interrupted run goes on from there
    data = {
        kind: ld.parallel_map(function, plan[kind], given.workers, kind, keep=f"{name}_kept")
        for kind, function in (
            ("ramps", ramp),
            ("compressions", compression),
            ("impurities", impurity),
        )
    }
    with open(f"{name}.json", "w") as file:
        json.dump(data, file, separators=(",", ":"))
    results.show(data)
    results.draw(data, f"{name}.png")

"""Which friction makes the ring law agree with polygons of beads, whose roughness is friction?

python beads.py        a quarter of an hour of processor time

Polygons of beads are compressed to a pressure by damped motion, as the droplets are, and so are
particles of the ring law that have their stiffness, with contacts that rub. The friction at which
these have as many contacts is that of the beads.
"""

import argparse
import itertools
import json
import math
import time
from pathlib import Path

import lammps_deformable as ld
import numpy as np
from lammps_deformable.comparison import matching, matching_laws
from lammps_deformable.contacts import without_rattlers

from validation.frictional_jamming import results

NUMBER, LOOSE = 32, 0.65
PACKINGS = 24  # of rings
PRESSURE, INERTIAL_NUMBER = 1e-4, 1e-2
BEADS = {18: 4, 24: 4, 40: 3}  # of a small polygon, large ones have more; and packings
FRICTION = (0.0, 0.03, 0.1, 0.3, 1.0, 10.0)
AT_REST, LOOK, MOST = 1e-2, 10_000, 2_000_000

MOTION = """
fix move all nve
fix drag all viscous {drag!r}
fix flat all enforce2d
fix box all deform/pressure 1 box pressure {pressure!r} {gain!r} remap x
fix_modify box press deformable_virial
timestep {timestep!r}
"""


def model(beads):
    return ld.PolygonModel(vertices=beads, radius=0.05, kL=300.0, kA=1.0, kr=30.0)


def bead_friction(polygons, radius):
    """Slope of the hollow between two beads of each species, over which one of a polygon climbs."""
    half = 0.5 * polygons.spacing
    return half / np.sqrt(4.0 * radius**2 - half**2)


def loose(seed):
    return ld.push_off(ld.bidisperse(NUMBER, phi=LOOSE, seed=seed))


def of_beads(beads, seed):
    """Polygons at rest, with the packing fraction of their effective radii."""
    begun, start = time.process_time(), loose(seed)
    with ld.Simulation(matching(start, model(beads)), model(beads)) as sim:
        polygons = sim.polygons
        mass = float(polygons.number[start.species].mean())
        rate = math.sqrt(PRESSURE / mass)
        drag = rate * min(2.0, 0.4 / (INERTIAL_NUMBER * NUMBER))
        sim.lmp.commands_string(
            MOTION.format(
                drag=drag,
                pressure=PRESSURE,
                gain=INERTIAL_NUMBER * rate / PRESSURE,
                timestep=1.0 / polygons.fastest_frequency(model(beads).kr),
            )
        )
        for _ in range(0, MOST, LOOK):
            sim.lmp.command(f"run {LOOK} post no")
            state = sim.state()
            if max(state.residual, abs(state.pressure / PRESSURE - 1.0)) < AT_REST:
                break
    table = state.contact_table
    sides = np.append(table.i, table.j), np.append(table.j, table.i)
    particle = sides[0][without_rattlers(*sides, NUMBER, at_most=1)]
    rigid = len(np.unique(particle))
    return {
        "beads": beads,
        "seed": seed,
        "hollow": bead_friction(polygons, 0.05).tolist(),
        "phi": float(np.sum(np.pi * start.radius**2) / state.packing.area),
        "z": len(particle) / rigid if rigid else 0.0,
        "rigid": rigid,
        "seconds": round(time.process_time() - begun, 1),
    }


def of_rings(mu, beads, seed):
    """Particles of the ring law at rest, with the stiffness of those polygons."""
    begun, start = time.process_time(), loose(seed)
    polygons = model(beads).polygons(matching(start, model(beads)).radii)
    law = matching_laws(model(beads), polygons)["balanced"]
    # about the stiffness k of contacts, and damping of sqrt(k m), at this pressure
    friction = ld.Friction(mu, kt=0.01, gt=0.05, damp=0.1)
    with ld.Simulation(start, law, friction=friction) as sim:
        state = ld.settle(sim, PRESSURE, AT_REST, INERTIAL_NUMBER)
    return {
        "mu": mu,
        "beads": beads,
        "seed": seed,
        "phi": state.packing.phi,
        "z": state.coordination,
        "rigid": int(np.sum(~state.rattlers)),
        "seconds": round(time.process_time() - begun, 1),
    }


def friction_of(polygons, rings, name):
    """mu at which rings have z or phi of polygons, between those of the list linear in log(mu)."""
    mu = np.array([each for each in FRICTION if each])
    of_mu = [np.mean([row[name] for row in rings if row["mu"] == each]) for each in mu]
    target = np.mean([row[name] for row in polygons])
    falling = np.minimum.accumulate(of_mu)
    return float(np.exp(np.interp(target, falling[::-1], np.log(mu[::-1]))))


def with_error(polygons, rings, name):
    """That mu and its error, from leaving out packings of both, one after another."""
    mu, first = ld.jackknife(lambda some: friction_of(some, rings, name), polygons)
    seeds = sorted({row["seed"] for row in rings})

    def without(some):
        return friction_of(polygons, [row for row in rings if row["seed"] in some], name)

    return mu, math.hypot(first, ld.jackknife(without, seeds)[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--workers", type=int, help="processes, all cores if not given")
    workers = parser.parse_args().workers
    calls = list(itertools.product(FRICTION, BEADS, range(1, PACKINGS + 1)))
    rings = ld.parallel_map(of_rings, calls, workers, "rings", keep="rings_kept")
    calls = [(beads, seed) for beads, count in BEADS.items() for seed in range(1, count + 1)]
    polygons = ld.parallel_map(of_beads, calls, workers, "polygons", keep="beads_kept")
    found = {"pressure": PRESSURE, "polygons": polygons, "rings": rings}
    Path("beads.json").write_text(json.dumps(found, indent=1) + "\n")
    results.write_beads(found, with_error)


if __name__ == "__main__":
    main()

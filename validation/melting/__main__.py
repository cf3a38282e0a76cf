"""Melting: equal droplets in a heat bath, from a crystal and from random positions.

python -m validation.melting         a minute: 64 droplets at four temperatures
python -m validation.melting full    half an hour: up to 1024 droplets, heated and cooled

Each leg of a motion begins where the last one ended, so that an interrupted run goes on.
"""

import argparse
import json
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np

from validation import options_of
from validation.ensembles import over_cores
from validation.melting import measure, results
from validation.melting.measure import BATH, PHI

ATTEMPTS = 10  # of a leg in which a droplet finds no shape
MEANS = ("energy", "pressure", "z", "bath", "beyond")  # of the samples of a leg

# Stages of a ramp: temperatures, and legs at each.
COLD = ((0.02, 3), (0.04, 3), (0.06, 6), (0.065, 4))
UP = (*COLD, *((temperature, 4) for temperature in (0.07, 0.075, 0.0775, 0.08)))
DOWN = ((0.09, 1), (0.08, 4), (0.075, 4), (0.07, 4), (0.06, 2))
FEW = tuple((temperature, 4) for temperature in (0.06, 0.07, 0.075, 0.0775, 0.08, 0.09))
DENSITIES = (0.89, 0.9, 0.91, 0.93)

# Number, packing fraction, start, seed, stages.
PLANS = {
    "small": [
        (64, PHI, start, 1, ((temperature, 4),))
        for temperature in (0.02, 0.06, 0.08, 0.1)
        for start in ("crystal", "random")
    ],
    "full": [
        (1024, PHI, "random", 1, DOWN),
        (1024, PHI, "crystal", 1, UP),
        (256, PHI, "random", 1, FEW[::-1]),
        (256, PHI, "crystal", 1, FEW),
        *((256, phi, "crystal", 1, ((0.075, 4),)) for phi in DENSITIES),
    ],
}
QUENCHED = (0.07, 0.09)  # temperatures whose last places are brought to rest
PICTURED = (("crystal", 0.06), ("crystal", 0.08), ("random", 0.08))


def ramp(number, phi, start, seed, stages, folder):
    """Legs in the order of time, and the places at the end of each stage.

    A leg in which a droplet finds no shape begins anew with other noise, and is counted.
    """
    positions = measure.kept(measure.begin, (number, phi, start, seed), folder)
    legs, ended, ends = [], 0, []
    for temperature, repeats in stages:
        for n in range(repeats):
            for attempt in range(ATTEMPTS):
                seeds = 100_000 * attempt + 1000 * seed + n + 1
                one = measure.kept(
                    measure.leg, (number, phi, temperature, seeds, positions), folder
                )
                if "ended" not in one:
                    break
                ended += 1
            else:
                raise RuntimeError(f"T = {temperature}: {one['ended']}")
            found = measure.kept(
                measure.measured, (number, phi, one["places"], one["order"]), folder
            )
            means = {name: np.mean([row[name] for row in one["rows"]]) for name in MEANS}
            legs.append({"T": temperature, "seconds": one["seconds"]} | means | found)
            positions = one["places"][-1]
        ends.append((temperature, positions))
    return {"number": number, "phi": phi, "start": start, "seed": seed} | {
        "ended": ended,
        "legs": legs,
        "ends": ends,
    }


def compared(ramps, folder, workers):
    """Other settings, energies at rest, and polygons: what the full plan adds."""
    checks = list(product(measure.SETTINGS, (0.06, 0.1), [folder]))
    laws = list(product(measure.LAWS, (PHI, 0.98)))
    quenched = [
        (law, each["number"], phi, places, each["start"], temperature)
        for law, phi in laws
        for each in ramps
        for temperature, places in each["ends"]
        if (each["number"], each["phi"]) == (256, PHI) and temperature in QUENCHED
    ]
    share = partial(over_cores, workers=workers, keep=folder)
    return {
        "checks": share(measure.check, checks),
        "solids": share(measure.solid, laws),
        "quenches": share(measure.quench, quenched),
        "polygons": measure.polygons(),
    }


def without_places(ramps):
    """Ramps as they are saved, and some places at their ends for the picture."""
    pictured = [
        {"start": each["start"], "T": temperature, "places": places.round(3).tolist()}
        for each in ramps
        for temperature, places in each.pop("ends")
        if each["number"] == 1024 and (each["start"], temperature) in PICTURED
    ]
    return {"ramps": ramps} | ({"places": pictured} if pictured else {})


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("plan", nargs="?", default="small", choices=PLANS)
    options.add_argument("--workers", type=int, help="calls at a time; one per core if omitted")
    given = options_of(options, __file__)
    if given.workers is not None and given.workers < 1:
        options.error(f"--workers must be at least 1, not {given.workers}")
    folder = f"{given.plan}_kept"
    plan = [(*each, folder) for each in PLANS[given.plan]]
    ramps = over_cores(ramp, plan, given.workers)
    found = {
        "phi": PHI,
        **BATH,
        "crystal": measure.harmonic(PHI),
        "dilute": [measure.dilute(0.1), measure.dilute(0.2)],
    }
    if given.plan == "full":
        found |= compared(ramps, folder, given.workers)
    found |= without_places(ramps)
    Path(f"{given.plan}.json").write_text(json.dumps(found, separators=(",", ":")))
    results.report(Path(f"{given.plan}.json"))

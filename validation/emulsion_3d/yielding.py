"""At which strain an emulsion yields, from the onset of jamming to a dense one.

python -m validation.emulsion_3d.yielding --number 64 --packings 1

Packings are sheared slowly. A yield strain is a stress over the shear modulus at rest: where the
line of the modulus reaches that stress, the largest one of the packing or the mean one of its flow.
Each packing is written to yielding_NUMBER.json when it is there, and not measured again.
"""

import argparse
import json
from pathlib import Path

import lammps_deformable as ld
import numpy as np

from validation import options_of
from validation.emulsion_3d.__main__ import RADII, with_error
from validation.ensembles import over_cores

PHI = (0.66, 0.70, 0.76, 0.82, 0.85)
STRAIN, STEPS = 0.6, 60  # of a shear
FLOWS = 0.2  # from this strain on the stress is that of the flow
HEADS = (
    "phi",
    "shear modulus",
    "largest stress",
    "of flow",
    "largest over modulus",
    "flow over it",
)
HEADS = (*HEADS, "foams")


def sheared(number, phi, seed):
    """Shear modulus of a packing, and its stress under shear [tension/R32]."""
    start = ld.bidisperse(number, sizes=RADII, dimension=3, seed=seed)
    jammed = ld.jam(start).packing
    unit = np.sum(jammed.radii**2) / np.sum(jammed.radii**3)
    with ld.Simulation(jammed, ld.Droplet(tension=1.0)) as sim:
        rest = sim.compress(phi=phi, keep=False)[-1]
        modulus = rest.moduli().mean_shear_modulus / unit
        table = sim.shear(STRAIN, steps=STEPS).table()
    stress = (table["shear_stress"] / unit).tolist()
    strain = table["shear_strain"].tolist()
    found = {"number": number, "phi": phi, "seed": seed, "modulus": float(modulus)}
    return found | {"strain": strain, "stress": stress}


def quantities(packing):
    """Modulus, mean stress of the flow, and the largest stress."""
    strain, stress = np.array(packing["strain"]), np.array(packing["stress"])
    return [packing["modulus"], stress[strain > FLOWS].mean(), stress.max()]


def measured(phi):
    """Yield strain of foams, a line through the ends of Saint-Jalmes and Durian (1999)."""
    (begin, low), (end, high) = (0.635, 0.045), (1.0, 0.18)
    return low + (high - low) * (phi - begin) / (end - begin)


def table(packings):
    """The lines of the table, with errors of the last digits."""
    yield "| " + " | ".join(HEADS) + " |"
    yield "|" + "---|" * len(HEADS)
    for phi in sorted({packing["phi"] for packing in packings}):
        values = np.array([quantities(each) for each in packings if each["phi"] == phi])
        found = [
            with_error(*ld.jackknife(values, lambda some, f=f: f(*np.mean(some, axis=0))))
            for f in (
                lambda modulus, flow, largest: modulus,
                lambda modulus, flow, largest: largest,
                lambda modulus, flow, largest: flow,
                lambda modulus, flow, largest: largest / modulus,
                lambda modulus, flow, largest: flow / modulus,
            )
        ]
        yield f"| {phi} | " + " | ".join(found) + f" | {measured(phi):.3f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=256, help="droplets of a packing")
    parser.add_argument("--packings", type=int, default=4, help="of each packing fraction")
    parser.add_argument("--workers", type=int, help="packings at a time")
    asked = options_of(parser, __file__)
    file = Path(f"yielding_{asked.number}.json")
    packings = json.loads(file.read_text()) if file.exists() else []
    known = {(packing["phi"], packing["seed"]) for packing in packings}
    calls = [
        (asked.number, phi, seed)
        for seed in range(1, asked.packings + 1)
        for phi in PHI
        if (phi, seed) not in known
    ]
    packings += over_cores(sheared, calls, asked.workers, file.with_suffix(".kept"))
    packings.sort(key=lambda one: (one["phi"], one["seed"]))
    file.write_text(json.dumps(packings))
    print(*table(packings), sep="\n")


if __name__ == "__main__":
    main()

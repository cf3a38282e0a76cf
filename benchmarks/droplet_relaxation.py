"""Do FIRE and cg relax every packing of droplets in three dimensions, and in how many steps?

    python benchmarks/droplet_relaxation.py [--out benchmarks/results/droplet_relaxation.json]

Packings of several sizes, size ratios and box shapes are jammed as soft spheres and brought from a
packing fraction just above jamming to 0.85. Each one is relaxed by each minimizer until no force
exceeds 1e-8 of the mean contact force. The summary is that of relaxation.py, and has the number of
packings where both minimizers end at the same energy: others have found another minimum.

cg has the line search `forcezero`, which looks at forces. LAMMPS' default compares energies, and so
ends at larger forces. It also has a closer balance of contacts than the default, 1e-8 of the
largest force: that may be many times the mean one, and each search begins anew from the forces of
a long step.
"""

from __future__ import annotations

import argparse
import itertools
import json
import time
import warnings
from pathlib import Path
from typing import Any

import lammps_deformable as ld
from lammps_deformable.moduli import balanced_to
from lammps_deformable.versions import machine
from relaxation import summary

HERE = Path(__file__).parent
NUMBERS, SEEDS = (16, 32, 64, 128), (1, 2)
SHAPES = ((1.0, 0.0), (1.2, 0.0), (1.4, 0.0), (3.0, 0.0), (1.2, 0.4))  # ratios of sizes, tilts
ABOVE, PHIS = 0.005, (0.70, 0.75, 0.80, 0.85)
TOLERANCE = 1e-8
# commands, and the imbalance of contacts that they leave; None: the default
MINIMIZERS = {
    "fire": ("min_style fire", None),
    "cg": ("min_style cg\nmin_modify dmax 0.01 line forcezero", 1e-10),
}


def relax(packing: ld.Packing, minimizer: str) -> dict[str, Any]:
    commands, balance = MINIMIZERS[minimizer]
    with ld.Simulation(packing, ld.Droplet()) as sim:
        sim.lmp.commands_string(commands)
        before = sim.lmp.extract_global("ntimestep")
        began = time.process_time()
        with balanced_to(sim, packing, balance):
            state = sim.relax(TOLERANCE)
        return {
            "minimizer": minimizer,
            "N": len(packing),
            "phi": state.phi,
            "residual": state.residual,
            "stalled": (not state.converged),
            "energy": state.energy,
            "beyond": state.beyond,
            "seconds": time.process_time() - began,
            "steps": sim.lmp.extract_global("ntimestep") - before,
        }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "droplet_relaxation.json")
    parser.add_argument("--numbers", nargs="+", type=int, default=NUMBERS, help="of particles")
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)  # the rows have what they report
    rows: list[dict[str, Any]] = []
    same = 0
    for number, seed, (ratio, tilt) in itertools.product(options.numbers, SEEDS, SHAPES):
        sizes = 0.5, 0.5 * ratio
        start = ld.bidisperse(number, seed=seed, dimension=3, sizes=sizes, tilt=tilt)
        jammed = ld.jam(start).packing
        for phi in (jammed.phi + ABOVE, *PHIS):
            pair = [relax(jammed.at(phi), minimizer) for minimizer in MINIMIZERS]
            rows += [{"seed": seed, "ratio": ratio, "tilt": tilt, **row} for row in pair]
            first, second = (row["energy"] for row in pair)
            same += abs(first - second) <= 1e-9 * first
    result = {
        "command": "python benchmarks/droplet_relaxation.py"
        f" --numbers {' '.join(map(str, options.numbers))}",
        "machine": machine()["processor"],
        "tolerance": TOLERANCE,
        **{m: summary([row for row in rows if row["minimizer"] == m]) for m in MINIMIZERS},
        "same_energy": same,
        "beyond_the_model": sum(row["beyond"] > 0 for row in rows[:: len(MINIMIZERS)]),
    }
    for key, value in result.items():
        print(key, value, flush=True)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps({**result, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()

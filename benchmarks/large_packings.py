"""Time and memory of large packings at rest: a quench, then a compression by 1 %.

    python benchmarks/large_packings.py [--numbers 1000 10000] [--minimizers lbfgs fire]

Bidisperse disks at random places with phi = 0.86, just above the onset of jamming, are pushed off
as soft disks, relaxed as `balanced` rings, and compressed by 1 % in one step and, from the same
state, in ten. A row has the seconds of the processor, iterations, and pressures in the end, which
tell whether packings are alike; and the largest memory of the process so far.
"""

from __future__ import annotations

import argparse
import json
import resource
import time
import warnings
from pathlib import Path
from typing import Any

import lammps_deformable as ld
from lammps_deformable.common.versions import machine

HERE = Path(__file__).parent
PHI, STRAIN = 0.86, 0.01


def measure(packing: ld.Packing, minimizer: str) -> dict[str, Any]:
    """One packing with one minimizer."""
    row: dict[str, Any] = {"N": len(packing), "minimizer": minimizer}
    with ld.Simulation(packing, ld.Ring(), minimizer=minimizer) as sim:
        began = time.process_time()
        rest = sim.relax()
        row["quench"] = {
            "seconds": time.process_time() - began,
            "iterations": rest.iterations,
            "pressure": rest.pressure,
        }
        for steps in (1, 10):
            sim.reset(rest)
            began = time.process_time()
            run = sim.compress(strain=STRAIN, steps=steps)
            row[f"{steps} steps"] = {
                "seconds": time.process_time() - began,
                "iterations": sum(state.iterations or 0 for state in run[1:]),
                "pressure": run[-1].pressure,
                "stalled": sum(not state.converged for state in run),
            }
    row["megabytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--numbers", nargs="+", type=int, default=(1000, 10_000))
    parser.add_argument("--minimizers", nargs="+", default=("lbfgs", "fire"))
    parser.add_argument("--out", type=Path, default=HERE / "results" / "large_packings.json")
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)
    rows = []
    for number in options.numbers:
        packing = ld.bidisperse(number, phi=PHI, seed=1).push_off()
        for minimizer in options.minimizers:
            rows.append(measure(packing, minimizer))
            print(json.dumps(rows[-1]), flush=True)
    result = {"machine": machine()["processor"], "rows": rows}
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

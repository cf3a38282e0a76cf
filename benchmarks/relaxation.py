"""Does a minimizer relax every packing of rings and of droplets, and in how many steps?

    python benchmarks/relaxation.py [--minimizer fire] [--tolerance 1e-6] [--out ...]

Bidisperse packings of several sizes, size ratios and box shapes are jammed as soft disks, or in
space as soft spheres, and compressed in steps to 5 % beyond jamming. Each state is relaxed until no
force exceeds this part of the mean contact force. The summary has the number of states, of those
that stalled and those where FIRE went on, the largest residual, the steps of the minimizer, and the
processor time of `balanced` and of `curved` over that of `radical` for each packing. The laws take
turns, so that ratios are right on a busy machine.
"""

from __future__ import annotations

import argparse
import itertools
import json
import statistics
import time
import warnings
from pathlib import Path
from typing import Any

import lammps_deformable as ld
from lammps_deformable.common.versions import machine

HERE = Path(__file__).parent
NUMBERS, SEEDS = (16, 32, 64, 128), (1, 2, 3)
# ratio of the sizes, and tilt of the box
SHAPES = ((1.4, 0.0), (1.0, 0.0), (3.0, 0.0), (1.4, 0.4))
STRAINS = (0.002, 0.01, 0.03, 0.05)
LAWS: dict[str, ld.Ring | ld.Droplet] = {
    **{contact: ld.Ring(contact=contact) for contact in ("radical", "balanced", "curved")},
    "droplets": ld.Droplet(),
}
OVER_RADICAL = "balanced", "curved"
MINIMIZERS = ("lbfgs", "fire")


def measure(
    law: str, number: int, seed: int, shape: tuple[float, float], minimizer: str, tolerance: float
) -> list[dict[str, Any]]:
    """The relaxed states of one packing, from the onset of jamming on."""
    ratio, tilt = shape
    dimension = 3 if law == "droplets" else 2
    sizes = (0.5, 0.5 * ratio)
    start = ld.bidisperse(number, sizes=sizes, dimension=dimension, tilt=tilt, seed=seed)
    jammed = ld.jam(start).packing
    rows = []
    with ld.Simulation(jammed, LAWS[law], minimizer=minimizer) as sim:
        box = sim.box
        for strain in STRAINS:
            sim.deform(box * (1.0 - strain))
            began = time.process_time()
            state = sim.relax(tolerance)
            seconds = time.process_time() - began
            rows.append(
                {
                    "law": law,
                    "N": number,
                    "seed": seed,
                    "ratio": ratio,
                    "tilt": tilt,
                    "strain": strain,
                    "phi": state.phi,
                    "residual": state.residual,
                    "stalled": (not state.converged),
                    "seconds": seconds,
                    "steps": state.iterations,
                    "minimizer": state.minimizer,
                }
            )
    return rows


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "states": len(rows),
        "stalled": sum(bool(row["stalled"]) for row in rows),
        "fell_back": sum("," in row["minimizer"] for row in rows),
        "largest_residual": max(row["residual"] for row in rows),
        "median_steps": statistics.median(row["steps"] for row in rows),
        "most_steps": max(row["steps"] for row in rows),
        "seconds": sum(row["seconds"] for row in rows),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "relaxation.json")
    parser.add_argument("--minimizer", choices=MINIMIZERS, default=MINIMIZERS[0])
    parser.add_argument("--tolerance", type=float, default=1e-6)
    parser.add_argument("--numbers", nargs="+", type=int, default=NUMBERS, help="of particles")
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)  # the rows have what they report
    rows: list[dict[str, Any]] = []
    ratios: dict[str, list[float]] = {law: [] for law in OVER_RADICAL}
    for number, seed, shape in itertools.product(options.numbers, SEEDS, SHAPES):
        seconds = {}
        for law in LAWS:
            these = measure(law, number, seed, shape, options.minimizer, options.tolerance)
            rows += these
            seconds[law] = sum(row["seconds"] for row in these)
        for law, found in ratios.items():
            found.append(seconds[law] / seconds["radical"])
    summaries = {law: summary([row for row in rows if row["law"] == law]) for law in LAWS}
    for law in LAWS:
        print(law, "  ".join(f"{key} {v}" for key, v in summaries[law].items()), flush=True)
    times = {
        law: {
            "median": statistics.median(found),
            "mean": statistics.fmean(found),
            "smallest": min(found),
            "largest": max(found),
        }
        for law, found in ratios.items()
    }
    print("processor time over that of radical:", times)
    result = {
        "command": f"python benchmarks/relaxation.py --minimizer {options.minimizer} "
        f"--tolerance {options.tolerance} "
        f"--numbers {' '.join(map(str, options.numbers))}",
        "machine": machine()["processor"],
        "tolerance": options.tolerance,
        **summaries,
        "time_over_radical": times,
    }
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps({**result, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()

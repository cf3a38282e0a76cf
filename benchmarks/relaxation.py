"""Does FIRE relax every packing of the ring laws, and in how many steps? Does another minimizer?

    python benchmarks/relaxation.py [--out benchmarks/results/relaxation.json]
    python benchmarks/relaxation.py --minimizer cg [--dmax 0.001] --out ...

Bidisperse packings of several sizes, size ratios and box shapes are jammed as soft disks and
compressed in steps to 5 % beyond jamming. Each state is relaxed until no force exceeds 1e-6 of the
mean contact force, with the ring laws. The summary has the number of states and of stalled ones,
the largest residual, the steps of the minimizer, and the processor time of `balanced` and of
`curved` over that of `radical` for each packing. The laws take turns, so that ratios are right on a
busy machine.
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
from lammps_deformable.versions import machine

HERE = Path(__file__).parent
NUMBERS, SEEDS = (16, 32, 64, 128), (1, 2, 3)
SHAPES = ({"ratio": 1.4}, {"ratio": 1.0}, {"ratio": 3.0}, {"ratio": 1.4, "tilt": 0.4})
STRAINS = (0.002, 0.01, 0.03, 0.05)
TOLERANCE = 1e-6
LAWS = ("radical", "balanced", "curved")
# The first one is that of the package. The line searches of LAMMPS, of cg, end where a step would
# lower the energy by less than 1e-8 in whatever unit, so stiffnesses kA are large there.
MINIMIZERS = {"fire": 1.0, "cg": 1e12}


def measure(
    law: str, number: int, seed: int, shape: dict[str, float], minimizer: str, dmax: float | None
) -> list[dict[str, Any]]:
    """The relaxed states of one packing, from the onset of jamming on."""
    jammed = ld.jam(ld.bidisperse(number, seed=seed, **shape)).packing
    rows = []
    with ld.Simulation(jammed, ld.Ring(kA=MINIMIZERS[minimizer], contact=law)) as sim:
        sim.lmp.command(f"min_style {minimizer}")
        if dmax:
            sim.lmp.command(f"min_modify dmax {dmax!r}")
        box = sim.box
        for strain in STRAINS:
            sim.deform(box * (1.0 - strain))
            before = sim.lmp.extract_global("ntimestep")
            began = time.process_time()
            state = sim.relax(TOLERANCE)
            seconds = time.process_time() - began
            rows.append(
                {
                    "law": law,
                    "N": number,
                    "seed": seed,
                    **shape,
                    "strain": strain,
                    "phi": state.phi,
                    "residual": state.residual,
                    "stalled": (not state.converged),
                    "seconds": seconds,
                    "steps": sim.lmp.extract_global("ntimestep") - before,
                }
            )
    return rows


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "states": len(rows),
        "stalled": sum(bool(row["stalled"]) for row in rows),
        "largest_residual": max(row["residual"] for row in rows),
        "median_steps": statistics.median(row["steps"] for row in rows),
        "most_steps": max(row["steps"] for row in rows),
        "seconds": sum(row["seconds"] for row in rows),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "relaxation.json")
    parser.add_argument("--minimizer", choices=MINIMIZERS, default="fire")
    parser.add_argument("--dmax", type=float, help="of LAMMPS' min_modify: longest step")
    parser.add_argument("--numbers", nargs="+", type=int, default=NUMBERS, help="of particles")
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)  # the rows have what they report
    rows: list[dict[str, Any]] = []
    ratios: dict[str, list[float]] = {law: [] for law in LAWS[1:]}
    for number, seed, shape in itertools.product(options.numbers, SEEDS, SHAPES):
        seconds = {}
        for law in LAWS:
            these = measure(law, number, seed, shape, options.minimizer, options.dmax)
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
        f"{f'--dmax {options.dmax} ' if options.dmax else ''}"
        f"--numbers {' '.join(map(str, options.numbers))}",
        "machine": machine()["processor"],
        "tolerance": TOLERANCE,
        **summaries,
        "time_over_radical": times,
    }
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps({**result, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()

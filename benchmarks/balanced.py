"""Cost and energy conservation of the law `balanced`.

    python benchmarks/balanced.py [--out benchmarks/results/balanced.json]

`steps`: processor time of a time step over that of `radical`, with the iterations of a force call,
in slow motion and in a motion where contacts open and close all the time. The neighbor lists are
LAMMPS' default. `relaxation`: the same ratio for compressions from jamming to 2 % in steps of
0.25 %, each relaxed to 1e-6 of the mean contact force. `energy`: the standard deviation of the
total energy in a run at constant energy, against the time step and against the tolerance of the
balance, and its growth in 16 times the time. A drift would grow 16 times.

The two laws take turns in one process, so that the ratios are right on a busy machine too.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time
import warnings
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
from lammps_deformable.common.versions import machine
from motion import energy_error, step

HERE = Path(__file__).parent
MOTIONS = {"slow": (1e-8, 0.1), "fast": (1e-5, 0.1), "fast, long steps": (1e-5, 0.4)}
LAWS = ("radical", "balanced")
STIFFNESSES = (float("inf"), 0.1)
SEEDS = (1, 2, 3, 4)
TIMESTEPS = (0.4, 0.2, 0.1, 0.05, 0.025, 0.0125)
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10)
LONGER = 16


def steps(repeats: int) -> list[dict[str, Any]]:
    packing = ld.jam(ld.bidisperse(256, seed=1)).packing.at(0.9)
    rows = []
    for kP in STIFFNESSES:
        for motion, (temperature, dt) in MOTIONS.items():
            runs = [
                [step(packing, ld.Ring(kP=kP, contact=c), temperature, dt, 60.0, 400) for c in LAWS]
                for _ in range(repeats)
            ]
            rows.append(
                {
                    "N": len(packing),
                    "kP": str(kP),
                    "motion": motion,
                    "ratio": statistics.median(b[0] / a[0] for a, b in runs),
                    "iterations": runs[0][1][1],
                }
            )
            print("step", rows[-1], flush=True)
    return rows


def relaxation(seed: int, kP: float) -> dict[str, Any]:
    """Time and force calls of a compression with `balanced` over those with `radical`."""
    jammed = ld.jam(ld.bidisperse(64, seed=seed)).packing
    sims = [ld.Simulation(jammed, ld.Ring(kP=kP, contact=c)) for c in LAWS]
    seconds, calls, stalled = np.zeros(2), np.zeros(2), 0
    for strain in np.arange(1, 9) * 0.0025:
        for n, sim in enumerate(sims):
            before = sim.lmp.extract_global("ntimestep")
            sim.deform(jammed.box * (1.0 - strain))
            began = time.process_time()
            stalled += not sim.relax(1e-6).converged
            seconds[n] += time.process_time() - began
            calls[n] += sim.lmp.extract_global("ntimestep") - before
    for sim in sims:
        sim.close()
    row = {
        "N": 64,
        "seed": seed,
        "kP": str(kP),
        "ratio": float(seconds[1] / seconds[0]),
        "ratio_calls": float(calls[1] / calls[0]),
        "stalled": stalled,
    }
    print("relaxation", row, flush=True)
    return row


def energy() -> dict[str, Any]:
    packing = ld.jam(ld.bidisperse(64, seed=1)).packing.at(0.88)

    def error(tolerance: float, dt: float = TIMESTEPS[2], duration: float = 400.0) -> float:
        style = f"pair_style deformable/ring contact balanced balance {tolerance!r} 100 reach 0.3"
        return energy_error(packing, ld.Ring(), dt, duration, 200, style)

    errors = [error(1e-8, dt) for dt in TIMESTEPS]
    order = float(np.polyfit(np.log(TIMESTEPS), np.log(errors), 1)[0])
    print("energy", order, errors, flush=True)
    by_tolerance = [error(tolerance) for tolerance in TOLERANCES]
    longer = [error(tolerance, duration=LONGER * 400.0) for tolerance in TOLERANCES]
    growth = (np.array(longer) / by_tolerance).tolist()
    print("energy", by_tolerance, growth, flush=True)
    return {
        "phi": 0.88,
        "N": 64,
        "dt": TIMESTEPS,
        "error_of_dt": errors,
        "order": order,
        "tolerance": TOLERANCES,
        "error_of_tolerance": by_tolerance,
        "growth": growth,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "balanced.json")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)  # the rows have what they report
    result = {
        "command": "python benchmarks/balanced.py",
        "machine": machine()["processor"],
        "energy": energy(),
        "steps": steps(options.repeats),
        "relaxation": [relaxation(seed, kP) for seed in SEEDS for kP in STIFFNESSES],
    }
    ratios = [row["ratio"] for row in result["relaxation"]]
    median, mean = statistics.median(ratios), statistics.fmean(ratios)
    print(f"relaxation: median {median:.2f}, mean {mean:.2f}")
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

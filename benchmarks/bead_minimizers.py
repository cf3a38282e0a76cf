"""Which minimizer of LAMMPS relaxes rings of beads fastest?

    python benchmarks/bead_minimizers.py [--out benchmarks/results/bead_minimizers.json]

Packings of 16 rings of 50 and 72 beads are strained by 1 % beyond jamming in one step and relaxed
until no force exceeds 1e-1, 1e-2 and 1e-3 of the force on a bead in a contact. Relaxations are
chaotic, so the results are medians over seeds, of force calls and of processor time. A trial ends
after 14 s; a tolerance that it did not reach counts as infinite.
"""

from __future__ import annotations

import argparse
import json
import re
import statistics
import tempfile
import time
from pathlib import Path

import lammps_deformable as ld
import numpy as np

HERE = Path(__file__).parent
NUMBER, BEADS, STRAIN, LIMIT = 16, ld.DeformablePolygon(50, smooth=False), 0.01, 14.0
TOLERANCES = (1e-1, 1e-2, 1e-3)
DMAX = f"min_modify dmax {0.1 * BEADS.radius:g} norm max"
OMEGA = (4.0 * (BEADS.kL + BEADS.kr)) ** 0.5


def fire(step: float, *more: str) -> list[str]:
    """FIRE with this largest time step, in units of 1/omega."""
    return [
        "min_style fire",
        f"{DMAX} tmax 2.0",
        f"timestep {0.5 * step / OMEGA!r}",
        *(f"min_modify {option}" for option in more),
    ]


def search(style: str, *more: str) -> list[str]:
    """A minimizer with line searches."""
    return [f"min_style {style}", DMAX, *(f"min_modify {option}" for option in more)]


QUICKMIN = ["min_style quickmin", DMAX, f"timestep {1.25 / OMEGA!r}"]
FORCEZERO = search("cg", "line forcezero")
HFTN = search("hftn", "norm inf")  # hftn has no other norm

# Commands before the relaxation to each tolerance.
METHODS = {
    "fire 1.0": [fire(1.0), [], []],
    "fire 1.25": [fire(1.25), [], []],
    "fire 1.4": [fire(1.4), [], []],
    "fire 1.5": [fire(1.5), [], []],
    "fire 1.6": [fire(1.6), [], []],
    "fire 1.9": [fire(1.9), [], []],
    "fire 1.25, verlet": [fire(1.25, "integrator verlet"), [], []],
    "fire 1.25, alpha0 0.1": [fire(1.25, "alpha0 0.1"), [], []],
    "fire 1.25, halfstepback no": [fire(1.25, "halfstepback no"), [], []],
    "fire 1.25, abcfire": [fire(1.25, "abcfire yes"), [], []],
    "quickmin 1.25": [QUICKMIN, [], []],
    "cg, quadratic": [search("cg"), [], []],
    "cg, backtrack": [search("cg", "line backtrack"), [], []],
    "cg, forcezero": [FORCEZERO, [], []],
    "sd": [search("sd"), [], []],
    "hftn": [HFTN, [], []],
    "cg, forcezero; then fire 1.25": [FORCEZERO, fire(1.25), []],
    "fire 1.25; then cg, forcezero": [fire(1.25), [], FORCEZERO],
    "fire 1.25; then hftn": [fire(1.25), [], HFTN],
}


def measure(name: str, jammed: ld.Packing, seed: int) -> dict[str, object]:
    """Force calls and processor time until each tolerance, None if it was not reached."""
    row: dict[str, object] = {"method": name, "seed": seed, "calls": [], "seconds": []}
    with (
        tempfile.TemporaryDirectory() as folder,
        ld.Simulation(jammed, BEADS) as rings,
    ):
        log = Path(folder, "log")
        rings.lmp.command(f'log "{log}"')
        rings.deform((1.0 - STRAIN) * rings.box)
        state = rings.state()
        began = time.process_time()
        for tolerance, commands in zip(TOLERANCES, METHODS[name], strict=True):
            for command in commands:
                rings.lmp.command(command)
            while state.residual > tolerance and time.process_time() < began + LIMIT:
                deficit = np.maximum(state.area_deficit, 0.0)
                bears = np.mean(deficit * state.polygons.spacing[jammed.species])  # kA = 1
                rings.lmp.command(f"minimize 0 {float(0.9 * tolerance * bears)!r} 20000 20000")
                state = rings.state()
            reached = state.residual <= tolerance
            calls = re.findall(r"force evaluations = \d+ (\d+)", log.read_text())
            row["calls"].append(sum(map(int, calls)) if reached else None)
            row["seconds"].append(time.process_time() - began if reached else None)
    return {**row, "energy": state.energy, "residual": state.residual}


def median(rows: list[dict[str, object]], quantity: str, n: int) -> float:
    """Median over the seeds; infinite if half of them did not reach the tolerance."""
    values = [row[quantity][n] for row in rows]
    return statistics.median(float("inf") if value is None else value for value in values)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "bead_minimizers.json")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--methods", nargs="+", default=list(METHODS), choices=list(METHODS))
    options = parser.parse_args()
    seeds = range(1, options.seeds + 1)
    packings = [ld.jam(ld.bidisperse(NUMBER, seed=seed)).packing for seed in seeds]
    rows = []
    for name in options.methods:
        new = [measure(name, packing, seed) for seed, packing in zip(seeds, packings, strict=True)]
        rows += new
        print(f"{name:30}", end="")
        for n, tolerance in enumerate(TOLERANCES):
            calls, seconds = (median(new, quantity, n) for quantity in ("calls", "seconds"))
            print(f"  {tolerance:g}: {calls:9.0f} {seconds:6.2f} s", end="")
        print(" ", *(f"{row['energy']:.2e}" for row in new), flush=True)
    result = {
        "command": "python benchmarks/bead_minimizers.py",
        "number": NUMBER,
        "beads": BEADS.vertices,
        "strain": STRAIN,
        "tolerances": TOLERANCES,
        "limit_seconds": LIMIT,
        "rows": rows,
    }
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

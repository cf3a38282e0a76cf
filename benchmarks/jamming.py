"""How long does `jam` take for soft disks, from 1000 to 100 000 particles?

    python benchmarks/jamming.py [1000 4000 10000] [--seeds 3] [--out FILE]
    python benchmarks/jamming.py 100000 --seeds 1 --pressure 1e-6 --tolerance 0.1 --out FILE

Bidisperse packings are jammed from random positions at a pressure of 1e-7, until no force exceeds
1e-6 of a contact force, on one core. Times are processor time. Packings that are in the file are
not measured again: an interrupted call goes on when it is repeated, and sizes can be added.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import time
import warnings
from pathlib import Path

HERE = Path(__file__).parent


def measure(number: int, seed: int, pressure: float, tolerance: float) -> dict[str, object]:
    """One packing, and the seconds of processor time that it took."""
    import lammps_deformable as ld

    start = ld.bidisperse(number, seed=seed)
    began = time.process_time()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ld.StalledWarning)
        jammed = ld.jam(start, pressure=pressure, tolerance=tolerance)
    seconds = time.process_time() - began
    with ld.Simulation(jammed, ld.SoftContact()) as disks:
        state = disks.state()
    return {
        "N": number,
        "seed": seed,
        "seconds": seconds,
        "phi": state.phi,
        "pressure": state.pressure,
        "contacts": state.network_contacts,
        "isostatic": state.isostatic_contacts,
        "rattlers": int(state.rattlers.sum()),
        "stalled": bool(caught),
    }


def summary(rows: list[dict[str, object]]) -> list[dict[str, object]]:
    """Medians over the seeds of each size."""
    found = []
    for number in sorted({row["N"] for row in rows}):
        these = [row for row in rows if row["N"] == number]
        found.append(
            {
                "N": number,
                "packings": len(these),
                "seconds": statistics.median(row["seconds"] for row in these),
                "phi": statistics.mean(row["phi"] for row in these),
                "excess_contacts": [row["contacts"] - row["isostatic"] for row in these],
                "rattlers": statistics.mean(row["rattlers"] / number for row in these),
                "stalled": sum(row["stalled"] for row in these),
            }
        )
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("numbers", type=int, nargs="*", default=[1000, 4000, 10_000])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--pressure", type=float, default=1e-7, help="threshold of `jam`")
    parser.add_argument("--tolerance", type=float, default=1e-6, help="of `jam`")
    parser.add_argument("--out", type=Path, default=HERE / "results" / "jamming.json")
    options = parser.parse_args()
    rows = json.loads(options.out.read_text())["rows"] if options.out.exists() else []
    for number in options.numbers:
        for seed in range(1, options.seeds + 1):
            if (number, seed) in {(row["N"], row["seed"]) for row in rows}:
                continue
            rows.append(measure(number, seed, options.pressure, options.tolerance))
            print(*(f"{key} {value}" for key, value in rows[-1].items()), flush=True)
            rows.sort(key=lambda row: (row["N"], row["seed"]))
            result = {
                "command": "python benchmarks/jamming.py",
                "pressure": options.pressure,
                "tolerance": options.tolerance,
                "sizes": summary(rows),
                "rows": rows,
            }
            options.out.parent.mkdir(parents=True, exist_ok=True)
            options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ[threads] = "1"  # read by numpy when it is imported
    main()

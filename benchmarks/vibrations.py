"""Which modes and moduli do packings above jamming have?

    python benchmarks/vibrations.py LAW N [--seeds 4] [--modes M] [--excess-phi 1e-4 ...]

Packings are jammed as soft disks and compressed to each phi - phi_J; there `State.modes` and
`State.elastic_moduli` are computed. vibrations.json keeps the packings of earlier calls, which are
not measured again, also with other options; vibrations.png shows all of them.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "docs" / "jamming"
DISKS = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1]

# Those with second derivatives.
LAWS = ("disk", "radical", "balanced", "curved")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("law", choices=LAWS)
    parser.add_argument("number", type=int, help="of particles in a packing")
    parser.add_argument("--seeds", type=int, default=4, help="packings")
    parser.add_argument("--modes", type=int, help="lowest ones of each packing; all if omitted")
    parser.add_argument("--excess-phi", type=float, nargs="+", default=DISKS, help="phi - phi_J")
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder of the results")
    options = parser.parse_args()

    from lammps_deformable._files import make_folder, write_whole

    from validation.jamming import vibrations

    path = make_folder(options.out) / "vibrations.json"
    rows = json.loads(path.read_text())["rows"] if path.exists() else []
    for seed in range(1, options.seeds + 1):
        key = (options.law, options.number, seed)
        if key in {(row["law"], row["number"], row["seed"]) for row in rows}:
            print(*key, "is there", flush=True)
            continue
        began = time.process_time()
        rows += vibrations.measure(*key, sorted(options.excess_phi), options.modes)
        rows.sort(key=lambda row: (row["law"], row["number"], row["seed"], row["wanted"]))
        lines = ",\n".join(json.dumps(row) for row in rows)
        means = ",\n".join(json.dumps(finite(row)) for row in vibrations.summarize(rows))
        write_whole(path, f'{{"summary": [\n{means}\n],\n"rows": [\n{lines}\n]}}\n')
        print(*key, f"{time.process_time() - began:.1f} s", flush=True)
    if rows:
        vibrations.figure(rows).savefig(options.out / "vibrations.png", dpi=110)


def finite(row: dict[str, object]) -> dict[str, object]:
    """JSON has no nan."""
    return {name: None if value != value else value for name, value in row.items()}


if __name__ == "__main__":
    for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ[threads] = "1"  # read by numpy when it is imported
    main()

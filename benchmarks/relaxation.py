"""Does FIRE relax every packing of the ring laws, and in how many force calls?

    python benchmarks/relaxation.py [--laws tilted,...] [--out benchmarks/results/relaxation.json]

Bidisperse packings of several sizes, size ratios and box shapes are jammed as soft disks and
compressed in steps to 5 % beyond jamming. Each state is relaxed until no force exceeds 1e-6 of the
mean contact force, with the ring laws. The summary has the number of states and
of stalled ones, the largest residual and the force calls.
"""

from __future__ import annotations

import argparse
import itertools
import json
import statistics
import warnings
from pathlib import Path

import deformable

HERE = Path(__file__).parent
NUMBERS, SEEDS = (16, 32, 64, 128), (1, 2, 3)
SHAPES = ({"ratio": 1.4}, {"ratio": 1.0}, {"ratio": 3.0}, {"ratio": 1.4, "tilt": 0.4})
STRAINS = (0.002, 0.01, 0.03, 0.05)
TOLERANCE = 1e-6
LAWS = ("radical", "balanced", "tilted")


def measure(law: str, number: int, seed: int, shape: dict[str, float]) -> list[dict[str, object]]:
    """The relaxed states of one packing, from the onset of jamming on."""
    jammed = deformable.jam(deformable.bidisperse(number, seed=seed, **shape))
    rows = []
    with deformable.Simulation(jammed, deformable.Ring(contact=law)) as sim:
        box = sim.box
        for strain in STRAINS:
            sim.deform(box * (1.0 - strain))
            before = sim.lmp.extract_global("ntimestep")
            state = sim.relax(TOLERANCE)
            rows.append(
                {
                    "law": law,
                    "N": number,
                    "seed": seed,
                    **shape,
                    "strain": strain,
                    "phi": state.phi,
                    "residual": state.residual,
                    "stalled": state.stalled,
                    "steps": sim.lmp.extract_global("ntimestep") - before,
                }
            )
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "relaxation.json")
    parser.add_argument("--laws", default=",".join(LAWS), help="only these; the others stay")
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)  # the rows have what they report
    before = json.loads(options.out.read_text()) if options.out.exists() else {"rows": []}
    laws = options.laws.split(",")
    rows = [row for row in before["rows"] if row["law"] not in laws]
    summaries = {law: before[law] for law in LAWS if law in before}
    for law in laws:
        these = [
            row
            for number, seed, shape in itertools.product(NUMBERS, SEEDS, SHAPES)
            for row in measure(law, number, seed, shape)
        ]
        rows += these
        summaries[law] = {
            "states": len(these),
            "stalled": sum(bool(row["stalled"]) for row in these),
            "largest_residual": max(row["residual"] for row in these),
            "median_steps": statistics.median(row["steps"] for row in these),
            "most_steps": max(row["steps"] for row in these),
        }
        print(law, "  ".join(f"{key} {v}" for key, v in summaries[law].items()), flush=True)
    result = {"command": "python benchmarks/relaxation.py", "tolerance": TOLERANCE, **summaries}
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps({**result, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()

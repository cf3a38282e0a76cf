"""Errors of laws and polygons in twenty packings, as `deformable report --seed` measures them.

    python -m validation.report.seeds

Writes seeds.json. Each packing of 16 particles takes half a minute; those that are there already
are not computed again.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import lammps_deformable as ld

FILE = Path(__file__).with_name("seeds.json")
SEEDS = range(1, 21)
KEYS = ("method", "vertices", "energy_error", "area_error", "distance")


def rows_of(seed: int) -> list[dict[str, Any]]:
    """Of `compare` for the packing of this seed, without what depends on the machine."""
    found = ld.compare(ld.jam(ld.bidisperse(16, seed=seed)), workers=1)
    return [{key: row[key] for key in KEYS} for row in found.rows]


def main() -> None:
    known = json.loads(FILE.read_text()) if FILE.exists() else {}
    for seed in SEEDS:
        if str(seed) not in known:
            known[str(seed)] = rows_of(seed)
            FILE.write_text(json.dumps(known, indent=1) + "\n")


if __name__ == "__main__":
    main()

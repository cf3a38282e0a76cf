"""What brings smooth polygons to rest: FIRE or Newton's method, soft contacts first or not?

    python benchmarks/smooth_minimizers.py [--out benchmarks/results/smooth_minimizers.json]

Packings of 16 smooth polygons of 80 and 114 vertices are strained beyond jamming in one step and
relaxed to a residual of 1e-6. A trial of FIRE ends after 20 s, soft contacts after half of that.
"""

from __future__ import annotations

import argparse
import json
import time
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import lammps_deformable as ld
import numpy as np
from lammps_deformable.engine import polygon_engine
from lammps_deformable.reference.comparison import standard_polygons

if TYPE_CHECKING:
    from collections.abc import Sequence

HERE = Path(__file__).parent
NUMBER, BEADS, LIMIT, TOLERANCE = 16, standard_polygons(80), 20.0, 1e-6
STRAINS = (0.01, 0.02)
ANNEALED, AT_ONCE = (0.002, 0.02, 0.2, 1.0), (1.0,)


def fire(rings: ld.Simulation, stages: Sequence[float]) -> ld.State:
    """FIRE, with contacts of these stiffnesses over kr; soft ones end at a residual of 1e-3."""
    began = time.process_time()
    for part in stages:
        rings.lmp.command(f"pair_coeff * * {part * BEADS.kr!r} {2.0 * BEADS.radius!r}")
        tolerance = TOLERANCE if part == 1.0 else 1e-3
        end = began + LIMIT * (1.0 if part == 1.0 else 0.5)
        state = rings.state()
        while state.residual > tolerance and time.process_time() < end:
            deficit = np.maximum(state.area_deficit, 0.0)
            bears = np.mean(deficit * state.polygons.spacing[state.packing.species])  # kA = 1
            rings.lmp.command(f"minimize 0 {float(0.9 * tolerance * bears)!r} 5000 10000")
            state = rings.state()
    return state


def newton(rings: ld.Simulation, stages: Sequence[float]) -> ld.State:
    """Newton's method, as `Simulation.relax` or without its soft contacts."""
    before, polygon_engine._SOFT = polygon_engine._SOFT, tuple(stages)
    try:
        return rings.relax(TOLERANCE)
    finally:
        polygon_engine._SOFT = before


METHODS = {
    "FIRE": (fire, AT_ONCE),
    "FIRE, soft contacts first": (fire, ANNEALED),
    "Newton": (newton, AT_ONCE),
    "Newton, soft contacts first": (newton, ANNEALED),
}


def measure(name: str, jammed: ld.Packing, seed: int, strain: float) -> dict[str, object]:
    """Energy, residual and processor time of one relaxation."""
    method, stages = METHODS[name]
    with ld.Simulation(jammed, BEADS) as rings:
        rings.deform((1.0 - strain) * rings.box)
        began = time.process_time()
        state = method(rings, stages)
        seconds = time.process_time() - began
    return {
        "method": name,
        "seed": seed,
        "strain": strain,
        "energy": state.energy,
        "residual": state.residual,
        "seconds": seconds,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "smooth_minimizers.json")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1])
    options = parser.parse_args()
    warnings.simplefilter("ignore")  # the rows have the residuals
    rows = []
    for strain in STRAINS:
        for seed in options.seeds:
            jammed = ld.jam(ld.bidisperse(NUMBER, seed=seed)).packing
            for name in METHODS:
                row = measure(name, jammed, seed, strain)
                rows.append(row)
                print(
                    f"{strain:5g} {seed:3d} {name:28} {row['energy']:.5e} "
                    f"{row['residual']:8.1e} {row['seconds']:6.1f} s",
                    flush=True,
                )
    result = {
        "command": "python benchmarks/smooth_minimizers.py",
        "n": NUMBER,
        "rows": rows,
    }
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

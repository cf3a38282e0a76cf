"""What derivatives of the pressure by all radii cost, beside a solution of the Hessian.

    python benchmarks/derivatives.py [--laws soft balanced curved] [--sizes 100 1000 10000]
    python benchmarks/derivatives.py --laws droplet --sizes 100 1000

Random packings at rest. A row has the seconds of processor time of `state.hessian`, of one
`hessian.solve` for forces on all particles, of `state.derivatives(by="radii")`, and of
`vjp(pressure=1.0)`, which is the derivative of the pressure by all radii; `again` are those of one
more `vjp`, as the factor is kept, and `solves` is the first one over that of `hessian.solve`. Rows
of other laws and sizes stay in the file.
"""

from __future__ import annotations

import argparse
import json
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import lammps_deformable as ld
import numpy as np

HERE = Path(__file__).parent
LAWS = {
    "soft": ld.SoftContact(),
    "balanced": ld.Ring(kA=1.0, kP=0.3),
    "curved": ld.Ring(kA=1.0, kP=0.3, contact="curved"),
    "droplet": ld.Droplet(),
}


def timed(work: Callable[[], object]) -> tuple[float, object]:
    """Seconds of processor time, and the result."""
    start = time.process_time()
    result = work()
    return time.process_time() - start, result


def row(name: str, size: int) -> dict[str, float | str | int]:
    """Of one law and size."""
    law = LAWS[name]
    dimension, phi = (3, 0.72) if name == "droplet" else (2, 0.93)
    sizes = {"sizes": (0.5, 0.6)} if dimension == 3 else {}
    packing = ld.bidisperse(size, phi=phi, dimension=dimension, seed=1, **sizes)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with ld.Simulation(packing.push_off(), law) as sim:
            state = sim.relax(1e-6)
        pull = np.random.default_rng(1).standard_normal(dimension * size)
        build, hessian = timed(lambda: state.hessian(rattlers=False))
        solve, _ = timed(lambda: hessian.solve(pull))
        tables, found = timed(lambda: state.derivatives(by="radii"))
        vjp, _ = timed(lambda: found.vjp(pressure=1.0))
        again, _ = timed(lambda: found.vjp(energy=1.0, positions=pull.reshape(size, dimension)))
    return {
        "law": name,
        "particles": size,
        "hessian": round(build, 3),
        "solve": round(solve, 3),
        "derivatives": round(tables, 3),
        "vjp": round(vjp, 3),
        "again": round(again, 3),
        "solves": round(vjp / solve, 2),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--laws", nargs="+", choices=LAWS, default=["soft", "balanced", "curved"])
    parser.add_argument("--sizes", type=int, nargs="+", default=[100, 1000, 10_000])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "derivatives.json")
    options = parser.parse_args()
    there = json.loads(options.out.read_text()) if options.out.exists() else []
    rows = {(each["law"], each["particles"]): each for each in there}
    row("soft", 50)  # imports
    for name in options.laws:
        for size in options.sizes:
            rows[name, size] = row(name, size)
            print(rows[name, size], flush=True)
            options.out.write_text(json.dumps(list(rows.values()), indent=1) + "\n")


if __name__ == "__main__":
    main()

"""Do packings from L-BFGS have the statistics of those from FIRE?

    python benchmarks/at_rest_statistics.py [--packings 50] [--law balanced]

Random packings of 64 particles are compressed from phi = 0.78 to 0.88 in steps of 0.002, each with
both minimizers, which soon find different packings. A row has the mean of each quantity with the
error of the mean, for both, and the difference over its error: two means of one distribution
differ by less than 2 in 95 % of the cases. phi_J is where p^(1/3) of the first rigid packing
extrapolates to zero, p = 5 (phi - phi_J)^3, z its coordination without rattlers; energy, pressure
and shear modulus are those at phi = 0.88.
"""

from __future__ import annotations

import argparse
import json
import math
import warnings
from pathlib import Path

import lammps_deformable as ld
import numpy as np

HERE = Path(__file__).parent
NUMBER, START, END, STEPS = 64, 0.78, 0.88, 50
RIGID = 1e-6  # pressure


def compressed(job: tuple[str, str, int]) -> dict[str, float]:
    """One packing, compressed with a minimizer."""
    contact, minimizer, seed = job
    law = ld.Ring(contact=contact)
    onset: ld.State | None = None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        packing = ld.bidisperse(NUMBER, phi=START, seed=seed).push_off()
        with ld.Simulation(packing, law, minimizer=minimizer) as sim:
            for phi in np.linspace(START, END, STEPS + 1)[1:]:
                state = sim.compress(phi=float(phi))[-1]
                if onset is None and state.pressure > RIGID:
                    onset = state
    assert onset is not None
    moduli = state.moduli()
    return {
        "phi_J": onset.packing.phi - math.cbrt(onset.pressure / 5.0),
        "z": onset.coordination,
        "energy": 1e4 * state.energy / NUMBER,
        "pressure": 1e4 * state.pressure,
        "G": 1e3 * moduli.mean_shear_modulus,
        "stalled": float(not state.converged),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--packings", type=int, default=50)
    parser.add_argument("--law", default="balanced")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "at_rest_statistics.json")
    options = parser.parse_args()
    seeds = range(1, options.packings + 1)
    found = {
        minimizer: ld.parallel_map(
            compressed,
            [(options.law, minimizer, seed) for seed in seeds],
            workers=options.workers,
        )
        for minimizer in ("fire", "lbfgs")
    }
    rows = []
    for name in found["fire"][0]:
        row: dict[str, object] = {"quantity": name}
        values = {m: np.array([each[name] for each in of]) for m, of in found.items()}
        errors = {m: v.std(ddof=1) / math.sqrt(len(v)) for m, v in values.items()}
        for minimizer in found:
            row[minimizer] = [float(values[minimizer].mean()), float(errors[minimizer])]
        error = math.hypot(*errors.values())
        difference = values["lbfgs"].mean() - values["fire"].mean()
        row["difference over error"] = float(difference / error) if error else 0.0
        rows.append(row)
        print(row)
    options.out.write_text(
        json.dumps({"law": options.law, "packings": options.packings, "rows": rows}, indent=1)
        + "\n"
    )


if __name__ == "__main__":
    main()

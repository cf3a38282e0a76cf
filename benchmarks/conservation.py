"""Energy conservation of the law `balanced` in long runs at the default tolerance.

    python benchmarks/conservation.py [--out benchmarks/results/conservation.json]

Packings at phi = 0.85 and 0.90, relaxed, move at constant energy from random velocities of the
temperatures 1e-8, 1e-7 and 1e-5, by the time step 0.05. `error` is the standard deviation of the
total energy about its linear trend, `drift` what the trend gains over the run, both over the mean
kinetic energy: means over several random velocities, and the standard error of that of the drift.
`steps`: 2e4 for N = 256, and 1e6 for N = 64. Then the same for longer time steps.
"""

from __future__ import annotations

import argparse
import json
import warnings
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
from motion import energies

HERE = Path(__file__).parent
PHIS = (0.85, 0.90)
TEMPERATURES = (1e-8, 1e-7, 1e-5)
TIMESTEP, LONGER = 0.05, (0.1, 0.2, 0.4)
RUNS = ((256, 20_000), (64, 1_000_000))
SAMPLES = 200
SEEDS = range(4711, 4719)
BALANCED = ld.Ring()


def error_and_drift(
    packing: ld.Packing,
    temperature: float,
    dt: float,
    steps: int,
    seed: int,
    law: ld.Ring | ld.Droplet = BALANCED,
    bath: str = "",
) -> tuple[float, float]:
    with ld.Simulation(packing, law) as sim:
        sim.relax(1e-6)
        sim.lmp.commands_string(
            f"timestep {dt!r}\nvelocity all create {temperature!r} {seed} loop all mom yes\n"
            "fix nve all nve\nthermo_style custom step ke etotal\nthermo_modify norm no\n"
            f"{bath.format(temperature=temperature, seed=seed)}run 2000 post no"
        )
        kinetic, total = energies(sim, SAMPLES, steps // SAMPLES)
    time = np.linspace(0.0, 1.0, SAMPLES)
    slope, start = np.polyfit(time, total, 1)
    error = (total - slope * time - start).std()
    return float(error / kinetic.mean()), float(slope / kinetic.mean())


def run(
    packing: ld.Packing,
    temperature: float,
    dt: float,
    steps: int,
    law: ld.Ring | ld.Droplet = BALANCED,
    bath: str = "",
) -> dict[str, Any]:
    """bath: commands before the motion that counts, with {temperature} and {seed}."""
    errors, drifts = np.transpose(
        [error_and_drift(packing, temperature, dt, steps, seed, law, bath) for seed in SEEDS]
    )
    return {
        "N": len(packing),
        "phi": packing.phi,
        "temperature": temperature,
        "dt": dt,
        "steps": steps,
        "error": float(errors.mean()),
        "drift": float(drifts.mean()),
        "drift_uncertainty": float(drifts.std(ddof=1) / np.sqrt(len(drifts))),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "conservation.json")
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)
    rows = []
    for number, steps in RUNS:
        jammed = ld.jam(ld.bidisperse(number, seed=1)).packing
        cases = [(phi, T, TIMESTEP) for phi in PHIS for T in TEMPERATURES]
        if number == RUNS[0][0]:
            cases += [(phi, TEMPERATURES[-1], dt) for phi in PHIS for dt in LONGER]
        for phi, temperature, dt in cases:
            rows.append(run(jammed.at(phi), temperature, dt, steps))
            print(" ".join(f"{key} {value:.3g}" for key, value in rows[-1].items()), flush=True)
    result = {"command": "python benchmarks/conservation.py", "rows": rows}
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

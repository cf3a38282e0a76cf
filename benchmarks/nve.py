"""Energy conservation of the law `radical` at constant energy.

    python benchmarks/nve.py [--out benchmarks/results/nve.json]

A packing of N = 64, jammed as soft disks and brought to phi = 0.80, 0.88 and 0.92, moves from
random velocities with about as much kinetic energy as its contacts have. Velocity Verlet with the
steps dt, dt/2, dt/4, dt/8 and dt/16 covers the same time. The energy error, the standard deviation
of the total energy, falls with dt^2 if the forces are the gradient of one energy. In sixteen times
the time, at dt/4, a drift would grow by a factor of 16, and the random contributions of the kinks
of the force by a factor of 4.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np

HERE = Path(__file__).parent
HALVINGS = 4
SAMPLES = 200
LONGER = 16


RADICAL = ld.Ring(contact="radical", reach=0.2)
AnyLaw = ld.Ring | ld.Droplet


def energies(
    packing: ld.Packing, law: AnyLaw, dt: float, time: float, temperature: float
) -> np.ndarray:
    """Potential and total energy at SAMPLES + 1 times, shape (2, SAMPLES + 1)."""
    with ld.Simulation(packing, law) as sim:
        lmp = sim.lmp
        lmp.commands_string(
            f"timestep {dt!r}\nvelocity all create {temperature!r} 4711 loop all\nfix nve all nve\n"
            "thermo_style custom step pe etotal\nthermo_modify norm no\nrun 0 post no"
        )
        rows = [(lmp.get_thermo("pe"), lmp.get_thermo("etotal"))]
        for _ in range(SAMPLES):
            lmp.command(f"run {round(time / dt / SAMPLES)} post no")
            rows.append((lmp.get_thermo("pe"), lmp.get_thermo("etotal")))
    return np.array(rows).T


def measure(
    jammed: ld.Packing,
    phi: float,
    time: float = 400.0,
    dt: float = 0.4,
    temperature: float = 1e-5,
    law: AnyLaw = RADICAL,
) -> dict[str, Any]:
    """Energy errors at one packing fraction for the steps dt to dt/16, and their order."""
    packing = jammed.at(phi)
    steps = (dt / 2.0 ** np.arange(HALVINGS + 1)).tolist()
    runs = [energies(packing, law, step, time, temperature) for step in steps]
    errors = [float(total.std()) for _, total in runs]
    return {
        "phi": phi,
        "N": len(packing),
        "time": time,
        "kinetic_energy": float((runs[-1][1] - runs[-1][0]).mean()),
        "potential_energy": float(runs[-1][0].mean()),
        "dt": steps,
        "energy_error": errors,
        "order": float(np.polyfit(np.log(steps), np.log(errors), 1)[0]),
    }


def growth(
    jammed: ld.Packing,
    row: dict[str, Any],
    temperature: float = 1e-5,
    law: AnyLaw = RADICAL,
) -> float:
    """Energy error at dt/4 over LONGER times the time, relative to that of the row."""
    packing, time = jammed.at(row["phi"]), LONGER * row["time"]
    _, total = energies(packing, law, row["dt"][2], time, temperature)
    return float(total.std() / row["energy_error"][2])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "nve.json")
    options = parser.parse_args()
    jammed = ld.jam(ld.bidisperse(64, seed=1)).packing
    rows = []
    for phi in (0.80, 0.88, 0.92):
        row = measure(jammed, phi)
        row["error_growth_over_16_times_the_time"] = growth(jammed, row)
        errors = " ".join(f"{error:.2e}" for error in row["energy_error"])
        print(f"phi {phi:.2f}: errors {errors}, order {row['order']:.3f}", end=", ")
        print(f"growth {row['error_growth_over_16_times_the_time']:.2f}")
        rows.append(row)
    result = {"command": "python benchmarks/nve.py", "law": "radical", "rows": rows}
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

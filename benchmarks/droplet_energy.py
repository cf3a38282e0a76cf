"""Energy conservation of droplets in three dimensions, at constant energy.

    python benchmarks/droplet_energy.py [--out benchmarks/results/droplet_energy.json]

A packing of N = 64 of two sizes, jammed as soft spheres, is relaxed at phi = 0.66, 0.75 and 0.85,
and moves from random velocities. `order`: as in nve.py, with time steps from 0.1 to 0.00625 over a
time of 100, and the growth of the error in 16 times the time. `drift`: as in conservation.py, 1e5
steps of 0.05 from eight random starts for each of two temperatures. Before those a bath brings all
modes to the temperature, over a time of 400: the energy's error of second order in the time step
depends on how modes share it, which without the bath goes on changing for longer than the run.
"""

from __future__ import annotations

import argparse
import json
import warnings
from pathlib import Path

import conservation
import lammps_deformable as ld
import nve

HERE = Path(__file__).parent
LAW = ld.Droplet()
PHIS = (0.66, 0.75, 0.85)
TIME, TIMESTEP, TEMPERATURE = 100.0, 0.1, 1e-5
STEPS, TEMPERATURES = 100_000, (1e-6, 1e-4)
BATH = """fix bath all langevin {temperature} {temperature} 10 {seed} zero yes
run 8000 post no
unfix bath
velocity all zero linear
"""


def jammed(number: int = 64) -> ld.Packing:
    """Touching spheres of radii 1 and 1.2."""
    start = ld.bidisperse(number, sizes=(1.0, 1.2), dimension=3, seed=1)
    return ld.jam(start, tolerance=1e-2).packing


def relaxed(packing: ld.Packing) -> ld.Packing:
    with ld.Simulation(packing, LAW) as sim:
        return sim.relax().packing


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "droplet_energy.json")
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)
    spheres = jammed()
    order, drift = [], []
    for phi in PHIS:
        packing = relaxed(spheres.at(phi))
        row = nve.measure(packing, phi, TIME, TIMESTEP, TEMPERATURE, LAW)
        row["error_growth_over_16_times_the_time"] = nve.growth(packing, row, TEMPERATURE, LAW)
        print(f"order {row}", flush=True)
        order.append(row)
        for temperature in TEMPERATURES:
            dt = conservation.TIMESTEP
            drift.append(conservation.run(packing, temperature, dt, STEPS, LAW, BATH))
            print(f"drift {drift[-1]}", flush=True)
    result = {"command": "python benchmarks/droplet_energy.py", "order": order, "drift": drift}
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

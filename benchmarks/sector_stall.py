"""How far FIRE relaxes a packing with `sector` and `radical`, and how well energy is conserved.

    python benchmarks/sector_stall.py [--out benchmarks/results/sector_stall.json]

A packing of N = 64, jammed as soft disks and brought to phi = 0.88 and 0.92, is relaxed with each
law, and then moves at constant energy. The energy of `sector` jumps when contacts appear and
vanish, so its forces do not all vanish together, and its dynamics gains energy.
"""

from __future__ import annotations

import argparse
import json
import warnings
from pathlib import Path

import lammps_deformable as ld
import numpy as np

HERE = Path(__file__).parent
LAWS = {"sector": ld.Sector(kA=1.0), "radical": ld.Ring(contact="radical")}
TIME, TIMESTEP, TEMPERATURE, SAMPLES = 400.0, 0.025, 1e-6, 40


def run(sim: ld.Simulation) -> dict[str, float | str]:
    """A run at constant energy: last total energy over the first one, and the time it lasted."""
    sim.lmp.commands_string(
        f"velocity all create {TEMPERATURE} 1\nfix nve all nve\ntimestep {TIMESTEP}\n"
        "thermo_style custom step pe ke etotal\nthermo_modify norm no\nrun 0"
    )
    first = last = sim.lmp.get_thermo("etotal")
    stopped, samples = "", 0
    while samples < SAMPLES and not stopped:
        try:
            sim.lmp.command(f"run {round(TIME / TIMESTEP / SAMPLES)}")
        except Exception as error:  # the lammps module raises bare Exception
            stopped = str(error).splitlines()[0].rsplit(" (", 1)[0]
        else:
            last = sim.lmp.get_thermo("etotal")
            samples += 1
    lasted = TIME * samples / SAMPLES
    return {"energy_over_first": last / first, "time": lasted, "stopped_by": stopped}


def measure(jammed: ld.Packing, law: str, phi: float) -> dict[str, object]:
    """Relaxation of one packing, and a run from its end."""
    with ld.Simulation(jammed.at(phi), LAWS[law]) as sim, warnings.catch_warnings():
        warnings.simplefilter("ignore", ld.StalledWarning)
        state = sim.relax(tolerance=1e-6)
        force = np.linalg.norm(sim.lmp.numpy.extract_atom("f")[: len(jammed), :2], axis=1)
        dynamics = run(sim)
    return {
        "law": law,
        "phi": phi,
        "N": len(jammed),
        "stalled": (not state.converged),
        "largest_force": float(force.max()),
        "largest_force_over_mean_contact_force": state.residual,
        "energy": state.energy,
        "dynamics": dynamics,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "sector_stall.json")
    options = parser.parse_args()
    jammed = ld.jam(ld.bidisperse(64, seed=1)).packing
    rows = [measure(jammed, law, phi) for law in LAWS for phi in (0.88, 0.92)]
    for row in rows:
        print("  ".join(f"{key} {value}" for key, value in row.items()))
    result = {
        "command": "python benchmarks/sector_stall.py",
        "kA": 1.0,
        "timestep": TIMESTEP,
        "temperature": TEMPERATURE,
        "rows": rows,
    }
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

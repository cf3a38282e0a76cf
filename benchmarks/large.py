"""Memory per particle and time per particle-step from ten thousand to a million particles.

    python benchmarks/large.py [--largest 100000] [--out benchmarks/results/large.json]

Runs `examples/large`: 1, 10 and 100 copies of its cell of 1e4 particles are compressed by 1 % and
then move at constant energy. Soft disks of LAMMPS (`disk`) move at the same positions; the growth
of their time per step with their number is the cost of memory access. Sizes take turns, so that a
busy machine slows down all of them alike. The results are medians of processor time. Per particle
and step: seconds of a core in the run at constant energy, in its pair style and in the
minimizations (new neighbor lists included); bytes that LAMMPS and its styles allocate; and resident
bytes of the processes, beyond those of the smallest run.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from datetime import date
from pathlib import Path
from typing import Any

from lammps_deformable.common.versions import machine

ROOT = Path(__file__).parents[1]
BIN = Path(sys.executable).parent
CELL = 10_000
COPIES = ((1, 1), (5, 2), (10, 10))
SIZES = [CELL * nx * ny for nx, ny in COPIES]
RANKS = (1, 2)
# repeats of each size
REPEATS = {"disk": (5, 3, 1), "radical": (5, 3, 1), "balanced": (3, 2, 1), "curved": (3, 2, 1)}
# time steps; steps of strain and force calls in each, which disks have none of
MOTION, COMPRESSION = {"motion": 100}, {"steps": 2, "calls": 50}

DISKS = """
units lj
dimension 2
newton on
processors 1 * 1
read_data data.cell
replicate ${nx} ${ny} 1
change_box all x scale 0.99 y scale 0.99 remap
displace_atoms all random 0.005 0.005 0 1234 units box
pair_style harmonic/cut
pair_coeff 1 1 0.5 1.0
pair_coeff 1 2 0.5 1.2
pair_coeff 2 2 0.5 1.4
neighbor 0.3 bin                       # as far as the ring laws look for neighbors
neigh_modify delay 0 every 1 check yes
velocity all create 1e-8 4711 loop geom mom yes rot no
fix move all nve
fix plane all enforce2d
timestep 0.1
thermo 100
run ${motion}
info memory
"""

# MPICH's ranks wait actively; these settings help if there are more ranks than cores.
# Pages of 2 MB: with pages of 4 kB a virtual machine may spend most time on their addresses.
ENVIRONMENT = os.environ | {
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE": "1",
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE_NO_PROGRESS_COUNT": "16",
    "GLIBC_TUNABLES": "glibc.malloc.hugetlb=1",
}


def lammps(folder: Path, ranks: int, *arguments: str) -> str:
    command = [BIN / "mpiexec", "-n", str(ranks), BIN / "lmp", "-log", "none", *arguments]
    return subprocess.run(
        command, cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, check=True
    ).stdout


def run(
    folder: Path, copies: tuple[int, int], law: str, ranks: int, length: dict[str, int]
) -> dict[str, float]:
    """Seconds and bytes of one run of the example (or of soft disks), of all ranks."""
    settings = {"nx": copies[0], "ny": copies[1], "contact": law} | length
    words = [word for name, value in settings.items() for word in ("-var", name, str(value))]
    log = lammps(folder, ranks, "-in", "in.disks" if law == "disk" else "in.large", *words)
    n = CELL * copies[0] * copies[1]
    loops = re.findall(
        r"^Loop time of (\S+) on .* for ([1-9]\d*) steps(?:.*\n)+?(\S+)% CPU use", log, re.MULTILINE
    )
    *minimizations, motion = [
        ranks * float(wall) * min(1.0, float(share) / 100) / (n * int(steps))
        for wall, steps, share in loops
    ]
    (pair,) = re.findall(r"^Pair .* (\S+)$", log[log.rindex("timing breakdown") :], re.MULTILINE)
    (resident,) = re.findall(r"Maximum resident set size: (\S+) Mbyte", log)
    allocated = re.findall(r"memory allocation .* \| (\S+) \| ", log)[-1]
    return {
        "motion": motion,
        "pair": motion * float(pair) / 100,
        **({"minimization": statistics.fmean(minimizations)} if minimizations else {}),
        "allocated": float(allocated) * 2**20 * ranks,
        "resident": float(resident) * 2**20 * ranks,
    }


def measure(folder: Path, law: str, ranks: int, largest: int) -> list[Any]:
    repeats = REPEATS[law][: 1 + SIZES.index(largest)]
    length = MOTION if law == "disk" else COMPRESSION | MOTION
    samples: list[list[dict[str, float]]] = [[] for _ in COPIES]
    for turn in range(max(repeats)):
        for size, copies in enumerate(COPIES):
            if size < len(repeats) and turn < repeats[size]:
                samples[size].append(run(folder, copies, law, ranks, length))
    rows: list[dict[str, Any]] = []
    for copies, runs in zip(COPIES, filter(None, samples), strict=False):
        n = CELL * copies[0] * copies[1]
        middle = {name: statistics.median(r[name] for r in runs) for name in runs[0]}
        base = rows[0] if rows else None
        row = {
            "law": law,
            "ranks": ranks,
            "n": n,
            "repeats": len(runs),
            **length,
            "allocated": middle["allocated"],
            "resident": middle["resident"],
        }
        for name in ("motion", "pair", "minimization"):
            if name not in middle:
                continue
            row[f"ns_{name}"] = 1e9 * middle[name]
            if base is not None:
                row[f"ns_{name}_over_smallest"] = row[f"ns_{name}"] / base[f"ns_{name}"]
        if base is not None:
            for name in ("allocated", "resident"):
                row[f"{name}_per_particle"] = (row[name] - base[name]) / (n - base["n"])
        rows.append(row)
        print(" ".join(f"{k} {v:.4g}" if k != "law" else v for k, v in row.items()), flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "benchmarks/results/large.json")
    parser.add_argument("--laws", nargs="+", choices=REPEATS, default=list(REPEATS))
    parser.add_argument("--largest", type=int, choices=SIZES, default=SIZES[-1])
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(shutil.copytree(ROOT / "examples/large", Path(name, "examples/large")))
        shutil.copytree(ROOT / "potentials", Path(name, "potentials"))
        Path(folder, "in.disks").write_text(DISKS)
        lammps(folder, 1, "-in", "in.cell", "-var", "particles", str(CELL))
        for law, ranks in itertools.product(options.laws, RANKS):
            rows += measure(folder, law, ranks, options.largest)
    result = {
        "command": f"python benchmarks/large.py --laws {' '.join(options.laws)} "
        f"--largest {options.largest}",
        "date": date.today().isoformat(),
        "machine": machine()["processor"],
        "rows": rows,
    }
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

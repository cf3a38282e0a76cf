"""What do ranks send each other in a step, and how much faster are two of them than one?

    python benchmarks/ranks.py [--laws balanced curved droplet] [--sizes 10000] [--ranks 2 4]

The packings and motions of devices.py. A small library between LAMMPS and MPI counts messages,
their bytes and the sums over all ranks (MPI_Allreduce), without those of LAMMPS' own steps: less
what soft disks or spheres send in the same motion. A row has these numbers per rank and step, and
the time on the clock over that of one rank; more ranks than cores have no time.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from devices import IN_SPACE, LAWS, MOTIONS, cells, start
from lammps_deformable.common.versions import machine

HERE = Path(__file__).parent
REPEATS, PARTICLE_STEPS = 3, 400_000  # of a run, at least 20 steps
COUNTER = """
#include <mpi.h>
static long long counts[3];
const long long *counted(void) { return counts; }
static void sent(int count, MPI_Datatype type)
{
  int size;
  PMPI_Type_size(type, &size);
  ++counts[0];
  counts[1] += (long long) count * size;
}
int MPI_Send(const void *data, int count, MPI_Datatype type, int to, int tag, MPI_Comm world)
{
  sent(count, type);
  return PMPI_Send(data, count, type, to, tag, world);
}
int MPI_Isend(const void *data, int count, MPI_Datatype type, int to, int tag, MPI_Comm world,
              MPI_Request *request)
{
  sent(count, type);
  return PMPI_Isend(data, count, type, to, tag, world, request);
}
int MPI_Allreduce(const void *in, void *out, int count, MPI_Datatype type, MPI_Op op,
                  MPI_Comm world)
{
  ++counts[2];
  return PMPI_Allreduce(in, out, count, type, op, world);
}
"""


def compile_counter(folder: Path) -> Path:
    """A library whose functions of MPI count, and call those of MPI."""
    (folder / "counter.c").write_text(COUNTER)
    library = folder / "counter.so"
    compiler = Path(sys.executable).with_name("mpicc")
    words = [compiler if compiler.exists() else "mpicc", "-shared", "-fPIC", "-O2"]
    subprocess.run([*words, "-o", library, folder / "counter.c"], check=True)
    return library


def move(folder: Path, law: str, n: int, motion: str, steps: int) -> None:
    """Rank 0 prints seconds and, if they are counted, messages, bytes and sums of these steps."""
    lmp = start(folder, law, motion, n)
    counted = getattr(ctypes.CDLL(None), "counted", None)
    if counted:
        counted.restype = ctypes.POINTER(ctypes.c_longlong)
    before = counted()[:3] if counted else []
    began = time.perf_counter()
    lmp.command(f"run {steps} pre no post no")
    seconds = time.perf_counter() - began
    counts = [b - a for a, b in zip(before, counted()[:3], strict=True)] if counted else []
    if lmp.extract_setting("world_rank") == 0:
        print(json.dumps([seconds, *counts]), flush=True)


def run(words: list[str], ranks: int, preload: Path | None = None) -> list[float]:
    environment = os.environ | ({"LD_PRELOAD": str(preload)} if preload else {})
    start_ranks = [str(Path(sys.executable).with_name("mpiexec")), "-n", str(ranks)]
    done = subprocess.run(
        [*start_ranks, sys.executable, __file__, "--move", *words],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    found: list[float] = json.loads(done.stdout.splitlines()[-1])
    return found


def measure(
    folder: Path, counter: Path, law: str, n: int, motion: str, ranks: int
) -> dict[str, Any]:
    steps = max(20, PARTICLE_STEPS // n)
    words = [str(folder), law, str(n), motion, str(steps)]
    soft = "sphere" if law in IN_SPACE else "disk"
    _, *own = run(words, ranks, counter)
    _, *softs = run([str(folder), soft, *words[2:]], ranks, counter)
    row = {"law": law, "n": n, "motion": motion, "ranks": ranks}
    for name, a, b in zip(("messages", "bytes", "sums"), own, softs, strict=True):
        row[name] = round((a - b) / steps, 1)
    if ranks <= len(os.sched_getaffinity(0)):
        turns = [(run(words, 1)[0], run(words, ranks)[0]) for _ in range(REPEATS)]
        row["over_one"] = round(statistics.median(b / a for a, b in turns), 3)
    return row


def main() -> None:
    if sys.argv[1:2] == ["--move"]:
        _, _, folder, law, n, motion, steps = sys.argv
        return move(Path(folder), law, int(n), motion, int(steps))
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--laws", nargs="+", choices=LAWS, default=LAWS)
    parser.add_argument("--sizes", nargs="+", type=int, default=[10_000])
    parser.add_argument("--motions", nargs="+", choices=MOTIONS["plane"], default=["slow", "fast"])
    parser.add_argument("--ranks", nargs="+", type=int, default=[2, 4])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "ranks.json")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        counter = compile_counter(folder)
        cells(folder, options.laws)
        for law in options.laws:
            for n in options.sizes:
                for motion in options.motions:
                    for ranks in options.ranks:
                        rows.append(measure(folder, counter, law, n, motion, ranks))
                        print(json.dumps(rows[-1]), flush=True)
    options.out.write_text(json.dumps({"machine": machine(), "rows": rows}, indent=1) + "\n")
    return None


if __name__ == "__main__":
    main()

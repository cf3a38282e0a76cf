"""What does a step cost, and is it faster than before? Versions of the package and soft disks.

    python benchmarks/in_turns.py --out benchmarks/results/in_turns.json
    python benchmarks/in_turns.py BEFORE AFTER [--laws radical droplet] [--sizes 1000 10000 100000]

BEFORE, AFTER: folders that hold a compiled package; the installed one if none is given. Each
version has a process of its own with the packing of devices.py in motion, and soft disks or spheres
have one: they run a few steps in turn, so that a machine whose speed drifts does not favor one. A
row has nanoseconds of processor time per particle and step, medians of the times over disks, and of
those over the first version; and the memory of each process at its largest.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import lammps_deformable
from devices import IN_SPACE, LAWS, cells, start
from lammps_deformable.common.versions import machine
from loop_time import LEVELS, SIZES

TURNS = 30
PARTICLE_STEPS = 20_000  # of a turn, which has ten steps at least; `sector` heats up


def move(folder: Path, law: str, n: int, motion: str) -> None:
    """Steps as often as a line comes in, and tells their processor time."""
    lmp = start(folder, law, motion, n)
    for steps in sys.stdin:
        begin = time.process_time()
        lmp.command(f"run {steps.strip()} pre no post no")
        print(time.process_time() - begin, flush=True)
    (largest,) = re.findall(r"VmHWM:\s*(\d+) kB", Path("/proc/self/status").read_text())
    print(1024 * int(largest))


def compare(
    folder: Path, versions: list[str], law: str, n: int, motion: str, simd: str
) -> dict[str, object]:
    """Times of disks and of each version, in turns."""
    processes = []
    soft = "sphere" if law in IN_SPACE else "disk"
    for version, style in [(versions[0], soft), *((v, law) for v in versions)]:
        environment = os.environ | {
            "PYTHONPATH": os.pathsep.join([version, *sys.path]),
            "DEFORMABLE_SIMD": simd,
        }
        command = [sys.executable, __file__, "--move", str(folder), style, str(n), motion]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        processes.append(subprocess.Popen(command, env=environment, **pipes))
    steps = max(10, PARTICLE_STEPS // n)
    seconds: list[list[float]] = [[] for _ in processes]
    for _ in range(TURNS):
        for process, found in zip(processes, seconds, strict=True):
            print(steps, file=process.stdin, flush=True)
            found.append(float(process.stdout.readline()))
    memory = [float(process.communicate()[0]) for process in processes]
    disks, first = seconds[:2]

    def median_over(others: list[float], times: list[float]) -> float:
        return statistics.median(t / o for t, o in zip(times, others, strict=True))

    return {
        "n": n,
        "motion": motion,
        "law": law,
        "simd": simd,
        "ns": [1e9 / (n * steps) * statistics.median(times) for times in seconds],
        "over_disks": [median_over(disks, times) for times in seconds[1:]],
        "over_first": [median_over(first, times) for times in seconds[2:]],
        "bytes": memory,
    }


def main() -> None:
    if sys.argv[1:2] == ["--move"]:
        _, _, folder, law, n, motion = sys.argv
        return move(Path(folder), law, int(n), motion)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("versions", nargs="*", help="folders with a compiled package")
    parser.add_argument("--laws", nargs="+", default=["sector", "radical", *LAWS])
    parser.add_argument("--sizes", nargs="+", type=int, choices=SIZES, default=list(SIZES)[:3])
    parser.add_argument("--motions", nargs="+", default=["slow", "fast"])
    parser.add_argument("--simd", choices=LEVELS, default=LEVELS[0])
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cells(folder, options.laws)
        installed = Path(lammps_deformable.__file__).parents[1]
        versions = [str(Path(version).resolve()) for version in options.versions or [installed]]
        for n in options.sizes:
            for motion in options.motions:
                for law in options.laws:
                    rows.append(compare(folder, versions, law, n, motion, options.simd))
                    print(json.dumps(rows[-1]), flush=True)
    if options.out:
        result = {"machine": machine(), "rows": rows}
        options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

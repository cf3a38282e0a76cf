"""What do threads buy? The same packing in motion with 1, 2 ... threads, side by side.

    python benchmarks/threads.py [--threads 1 2] [--laws balanced curved] [--sizes 1000 10000]

The packings and motions of devices.py. Each number of threads has a process of its own; they run a
few steps in turn, so that a machine whose speed drifts does not favor one. A row has the medians of
the times on the clock over those of the first number, and of their smallest. Other work on the
machine spoils them: threads wait for the slowest one.
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

from devices import LAWS, MOTIONS, cells, start
from lammps_deformable.common.versions import machine

HERE = Path(__file__).parent
TURNS = 25
PARTICLE_STEPS = {"balanced": 100_000, "curved": 40_000, "droplet": 20_000}  # of a turn, at least 3


def move(folder: Path, law: str, n: int, motion: str, threads: int) -> None:
    """Steps as often as a line comes in, and tells their time."""
    lmp = start(folder, law, motion, n, f"threads={threads}")
    for steps in sys.stdin:
        begin = time.perf_counter()
        lmp.command(f"run {steps.strip()} pre no post no")
        print(time.perf_counter() - begin, flush=True)


def compare(folder: Path, law: str, n: int, motion: str, numbers: list[int]) -> dict[str, object]:
    processes = []
    for threads in numbers:
        words = ["--move", str(folder), law, str(n), motion, str(threads)]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        processes.append(subprocess.Popen([sys.executable, __file__, *words], **pipes))
    steps = max(3, PARTICLE_STEPS[law] // n)
    seconds: list[list[float]] = [[] for _ in processes]
    for _ in range(TURNS):
        for process, found in zip(processes, seconds, strict=True):
            print(steps, file=process.stdin, flush=True)
            found.append(float(process.stdout.readline()))
    for process in processes:
        process.communicate()
    one = seconds[0]
    return {
        "law": law,
        "n": n,
        "motion": motion,
        "threads": numbers,
        "us_per_step": [round(1e6 / steps * statistics.median(times), 1) for times in seconds],
        "median": [
            round(statistics.median(t / o for t, o in zip(times, one, strict=True)), 3)
            for times in seconds
        ],
        "smallest": [round(min(times) / min(one), 3) for times in seconds],
    }


def main() -> None:
    if sys.argv[1:2] == ["--move"]:
        _, _, folder, law, n, motion, threads = sys.argv
        return move(Path(folder), law, int(n), motion, int(threads))
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--threads", nargs="+", type=int, default=[1, 2])
    parser.add_argument("--laws", nargs="+", choices=LAWS, default=LAWS)
    parser.add_argument("--sizes", nargs="+", type=int, default=[1000, 10_000, 100_000])
    parser.add_argument("--motions", nargs="+", choices=MOTIONS["plane"], default=["slow", "fast"])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "threads.json")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cells(folder, options.laws)
        for law in options.laws:
            for n in options.sizes:
                for motion in options.motions:
                    rows.append(compare(folder, law, n, motion, options.threads))
                    print(json.dumps(rows[-1]), flush=True)
    options.out.write_text(json.dumps({"machine": machine(), "rows": rows}, indent=1) + "\n")
    return None


if __name__ == "__main__":
    main()

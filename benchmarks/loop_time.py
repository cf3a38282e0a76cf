"""Loop time per particle-step of the contact laws against soft disks on the same packing.

    python benchmarks/loop_time.py [--out benchmarks/results/loop_time.json]

One packing (bidisperse, 1:1.4, relaxed as soft disks at phi = 0.90, then by each law, so that no
law heats up), replicated to N = 1e3, 1e4 and 1e5 (and 1e6 by `--sizes`), is run by NVE from the
same velocities with each style in turn, on one core: in slow motion (temperature 1e-7, time step
0.05) and in a fast one (1e-5). The styles take turns in one process, and the results are medians of
processor time, so that the ratios are right on a busy machine too. The sections are LAMMPS' own
breakdown. Ring laws have reach 0.1. Each law runs at the levels of SIMD instructions that `--simd`
names; the first one is this processor's default. `bytes` is the memory that LAMMPS and its styles
allocate; at the end comes what each particle takes of it, by its growth from the smallest to the
largest packing.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import re
import statistics
import tempfile
from datetime import date
from pathlib import Path

import numpy as np
from lammps import lammps
from lammps_deformable import core
from lammps_deformable.common.versions import machine
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library
from sections import timed_run

RADII = (0.5, 0.7)
PHI = 0.90
CELL = 1000
SIZES = {1000: (1, 1), 10_000: (5, 2), 100_000: (10, 10), 1_000_000: (40, 25)}
TEMPERATURES = {"slow": 1e-7, "fast": 1e-5}
TIMESTEP = 0.05
PARTICLE_STEPS = 2_000_000
LEAST_STEPS = 60  # the first steps of a run are dearer, as forces have no history
SPECIES = "# UNITS: lj\nsmall 0.5 1.0 inf\nlarge 0.7 1.0 inf\n"
LAWS = ("disk", "sector", "radical", "balanced", "curved")
LEVELS = core.simd_levels()[::-1]  # the first one is the default
BREAKDOWN = ("Pair", "Neigh", "Comm", "Modify", "Other")


def disks() -> str:
    """Soft disks: harmonic/cut has no factor 1/2, and its energy scale is that of the contacts."""
    pairs = ((1, 1), (1, 2), (2, 2))
    coefficients = [f"pair_coeff {i} {j} 1.0 {RADII[i - 1] + RADII[j - 1]}" for i, j in pairs]
    return "\n".join(["pair_style harmonic/cut", *coefficients])


def styles(species: Path) -> dict[str, str]:
    coefficients = f"pair_coeff * * {species} small large"
    return {
        "disk": disks(),
        "sector": f"pair_style deformable/sector\n{coefficients}",
    } | {
        law: f"pair_style deformable/ring contact {law} reach 0.1\n{coefficients}"
        for law in ("radical", "balanced", "curved")
    }


def start() -> lammps:
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none"])
    lmp.commands_string("units lj\ndimension 2\nnewton on\natom_style atomic\natom_modify map yes")
    return lmp


def relaxed_cell(folder: Path) -> Path:
    """A packing of CELL disks at PHI, relaxed by FIRE from random places."""
    data = folder / "cell.data"
    area = CELL / 2 * np.pi * sum(r * r for r in RADII)
    length = np.sqrt(area / PHI)
    rng = np.random.default_rng(1)
    places = np.column_stack([rng.uniform(0, length, (CELL, 2)), np.zeros(CELL)])
    lmp = start()
    lmp.commands_string(
        f"region box block 0 {length} 0 {length} -0.5 0.5\ncreate_box 2 box\nmass * 1.0"
    )
    types = [1 + n % 2 for n in range(CELL)]
    lmp.create_atoms(CELL, list(range(1, CELL + 1)), types, places.ravel().tolist())
    lmp.commands_string(f"{disks()}\nmin_style fire\nminimize 0 1e-8 20000 20000")
    lmp.command(f"write_data {data} nofix nocoeff")
    lmp.close()
    return data


def at_rest(data: Path, law: str) -> Path:
    """The packing of `relaxed_cell`, relaxed by a law itself; `sector` as far as FIRE gets."""
    if law == "disk":
        return data
    own = data.with_name(f"{law}.data")
    if not own.exists():
        style = styles(data.with_name("species"))[law]
        minimizer = "fire" if law == "sector" else "deformable/lbfgs"
        lmp = start()
        lmp.commands_string(
            f"read_data {data}\n{style}\nneighbor 0.2 bin\nmin_style {minimizer}\n"
            f"minimize 0 1e-10 2000 4000\nwrite_data {own} nofix nocoeff"
        )
        lmp.close()
    return own


def run(
    data: Path,
    style: str,
    replicate: tuple[int, int],
    particle_steps: int = PARTICLE_STEPS,
    simd: str = LEVELS[0],
    motion: str = "slow",
) -> dict[str, float]:
    """Seconds per particle-step of a short NVE run, in all and by LAMMPS' sections, and bytes."""
    os.environ["DEFORMABLE_SIMD"] = simd
    log = data.with_name("log.run")
    lmp = start()
    lmp.commands_string(
        f"log {log}\nread_data {data}\nreplicate {replicate[0]} {replicate[1]} 1\n{style}\n"
        f"neighbor 0.2 bin\nvelocity all create {TEMPERATURES[motion]!r} 1 loop geom\n"
        f"fix nve all nve\ntimestep {TIMESTEP!r}\nthermo 0\nrun 50"
    )
    steps = max(LEAST_STEPS, particle_steps // lmp.get_natoms())
    seconds = timed_run(lmp, steps, log, BREAKDOWN)
    (megabytes,) = re.findall(
        r"^Per MPI rank memory .* \| (\S+) Mbytes", log.read_text(), re.MULTILINE
    )
    return seconds | {"bytes": float(megabytes) * 2**20}


def profile(law: str, motion: str) -> None:
    """Run one law long enough for a sampling profiler."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "species").write_text(SPECIES)
        style = styles(folder / "species")[law]
        data = at_rest(relaxed_cell(folder), law)
        run(data, style, SIZES[10_000], 10 * PARTICLE_STEPS, motion=motion)


def measure(
    repeats: int, sizes: list[int], laws: list[str], levels: list[str], particle_steps: int
) -> list[dict]:
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "species").write_text(SPECIES)
        data = relaxed_cell(folder)
        for n, motion in itertools.product(sizes, TEMPERATURES):
            samples: dict[tuple[str, str], list[dict[str, float]]] = {}
            for _ in range(repeats):
                for law in laws:
                    style = styles(folder / "species")[law]
                    for level in levels if law != "disk" else levels[:1]:
                        samples.setdefault((law, level), []).append(
                            run(at_rest(data, law), style, SIZES[n], particle_steps, level, motion)
                        )
            disks = samples["disk", levels[0]]
            for (law, level), runs in samples.items():
                ratios = [r["loop"] / d["loop"] for r, d in zip(runs, disks, strict=True)]
                row = {
                    "n": n,
                    "motion": motion,
                    "law": law,
                    "simd": level if law != "disk" else None,
                    "ns_per_particle_step": 1e9 * statistics.median(r["loop"] for r in runs),
                    "ratio_to_disks": statistics.median(ratios),
                    "ns_by_section": {
                        key: 1e9 * statistics.median(r[key] for r in runs)
                        for key in runs[0]
                        if key not in ("loop", "bytes")
                    },
                    "bytes": statistics.median(r["bytes"] for r in runs),
                }
                rows.append(row)
                print(
                    f"{n:7d} {motion} {law:8s} {row['simd'] or '':6s} "
                    f"{row['ns_per_particle_step']:8.1f} ns  "
                    f"{row['ratio_to_disks']:6.2f} x disks",
                    flush=True,
                )
    return rows


def print_memory(rows: list[dict]) -> None:
    """Bytes of a particle, by the growth from the smallest to the largest packing."""
    for motion, law in dict.fromkeys((row["motion"], row["law"]) for row in rows):
        of_law = [row for row in rows if (row["motion"], row["law"]) == (motion, law)]
        few, many = (pick(of_law, key=lambda row: row["n"]) for pick in (min, max))
        if few["n"] < many["n"]:
            each = (many["bytes"] - few["bytes"]) / (many["n"] - few["n"])
            print(f"{motion} {law:8s} {each:6.0f} bytes per particle")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out", type=Path, default=Path(__file__).parent / "results/loop_time.json"
    )
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--steps", type=int, default=PARTICLE_STEPS, help="particle-steps of a run")
    parser.add_argument("--sizes", nargs="+", type=int, choices=SIZES, default=list(SIZES)[:3])
    parser.add_argument("--laws", nargs="+", choices=LAWS, default=LAWS, help="with disk")
    parser.add_argument("--simd", nargs="+", choices=LEVELS, default=LEVELS)
    parser.add_argument("--law", choices=LAWS, help="run only this law, for a profiler")
    parser.add_argument("--motion", choices=TEMPERATURES, default="slow", help="with --law")
    options = parser.parse_args()
    if options.law:
        return profile(options.law, options.motion)
    rows = measure(options.repeats, options.sizes, options.laws, options.simd, options.steps)
    print_memory(rows)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(
        json.dumps(
            {
                "command": f"python benchmarks/loop_time.py --repeats {options.repeats} "
                f"--steps {options.steps} --sizes {' '.join(map(str, options.sizes))} "
                f"--laws {' '.join(options.laws)} --simd {' '.join(options.simd)}",
                "date": date.today().isoformat(),
                "machine": machine()["processor"],
                "packing": {"phi": PHI, "radii": RADII, "cell": CELL},
                "temperatures": TEMPERATURES,
                "timestep": TIMESTEP,
                "repeats": options.repeats,
                "rows": rows,
            },
            indent=1,
        )
        + "\n"
    )


if __name__ == "__main__":
    main()

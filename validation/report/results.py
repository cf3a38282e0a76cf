"""All measurements of a report.

The cost of options and the large packing are timed alone. Other calls run side by side on the
cores. All times are processor times.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from lammps_deformable.comparison import Comparison
from lammps_deformable.packing_rows import mixed_rows, packing_rows
from lammps_deformable.progress import progress
from lammps_deformable.report import smooth_rows

from validation.ensembles import once, over_cores
from validation.report.accuracy.pareto import pareto_means, pareto_rows
from validation.report.cost import cost_rows
from validation.report.paper import results as paper
from validation.report.roughness.crystal import crystal_row
from validation.report.roughness.friction import hysteresis, sliding
from validation.report.stability.rows import stability_rows

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from validation.report.paper.single import Squeezed
    from validation.report.plan import Plan

Rows = list[dict[str, Any]]


@dataclass(frozen=True, eq=False)
class Results:
    """Rows for tables, and the data of the figures."""

    ablation: Rows
    pareto: list[Rows]
    smooth: list[Rows]
    friction: Rows
    hysteresis: list[Rows]
    crystal: Rows
    large: tuple[Rows, dict[str, Comparison]]
    mixtures: list[Rows]
    shapes: list[Squeezed]
    stiffness: list[Squeezed]
    limits: list[paper.Limit]
    stability: Rows

    def rows(self) -> dict[str, Rows]:
        """The lists of rows of report.json, by name."""
        return {
            "single": [_single_row(result) for result in (*self.shapes, *self.stiffness)],
            "smooth": [row for rows in self.smooth for row in rows],
            "pareto": pareto_means(self.pareto),
            "friction": self.friction,
            "hysteresis": [row for rows in self.hysteresis for row in rows],
            "crystal": self.crystal,
            "packing": self.large[0],
            "stiffness_packing": [row for rows in self.mixtures for row in rows],
            "ablation": self.ablation,
            "limit": [_limit_row(limit) for limit in self.limits],
            "stability": self.stability,
        }


def measure(plan: Plan, keep: Path, print_once: Callable[[str], None]) -> Results:
    """Measure all parts of a plan, except calls whose results the folder `keep` has."""
    once_ = partial(once, keep)
    kept = partial(over_cores, keep=keep)
    parts: dict[str, Callable[[], Any]] = {
        "ablation": lambda: once_(cost_rows, **plan.ablation),
        "large": lambda: once_(packing_rows, *plan.large),
        "smooth": lambda: kept(smooth_rows, plan.smooth),
        "pareto": lambda: kept(pareto_rows, plan.pareto),
        "friction": lambda: kept(sliding, plan.friction),
        "hysteresis": lambda: kept(hysteresis, plan.hysteresis),
        "crystal": lambda: kept(crystal_row, plan.crystal),
        "mixtures": lambda: kept(mixed_rows, plan.mixtures),
        "shapes": lambda: once_(paper.shapes, **plan.shapes),
        "stiffness": lambda: once_(paper.stiffness_sweep, **plan.stiffness),
        "limits": lambda: [once_(paper.limit, *arguments) for arguments in plan.limits],
        "stability": lambda: once_(stability_rows, **plan.stability),
    }
    found = {}
    with progress("report", unit="part", total=len(parts)) as bar:
        for name, part in parts.items():
            began = time.perf_counter()
            found[name] = part()
            print_once(f"{name}: {time.perf_counter() - began:.0f} s")
            bar.update()
    return Results(**found)


def _single_row(result: Squeezed) -> dict[str, Any]:
    """A polygon between walls; if they slip, also I of the ring law about the Steiner point."""
    row: dict[str, Any] = paper.single_row(result)
    if not result.walls.stick:
        row["I_ring_kP_inf_steiner"] = paper.steiner_error(result)
    return row


def _limit_row(limit: paper.Limit) -> dict[str, Any]:
    """Convergence of S to K a^2: relative errors by number of beads and by kP, and their powers."""
    return {
        "sides": limit.sides,
        "a_over_R": limit.indentation,
        "n_v": limit.numbers.tolist(),
        "error_n_v": limit.number_error.tolist(),
        "rate_n_v": limit.number_rate,
        "kP": limit.stiffness.tolist(),
        "error_kP": limit.stiffness_error.tolist(),
        "rate_kP": limit.stiffness_rate,
    }

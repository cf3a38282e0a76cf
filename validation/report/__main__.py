"""Errors and run times of the contact laws, and the paper's results: all of the site's report.

    python -m validation.report [--quick] [--out FOLDER]

Writes report.json and its pictures, by default where the committed ones are; the site makes a page
of them. Half an hour on two cores, with --quick three minutes. Calls run side by side on the cores
of this machine, or the ranks of mpiexec, except for the cost of options and the large packing,
which are timed alone. All times are processor times. Results of single calls are kept in `parts`
or `quick_parts` of the folder until the report is complete: an interrupted report goes on when the
command is repeated.
"""

from __future__ import annotations

import argparse
import json
import math
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from lammps_deformable.common.files import make_folder
from lammps_deformable.common.ranks import print_once, progress
from lammps_deformable.common.versions import machine, versions
from lammps_deformable.particles.polygons import DeformablePolygon
from lammps_deformable.reference.comparison import standard_polygons
from matplotlib.figure import Figure

from validation.ensembles import once, over_cores
from validation.report import accuracy, cost, packings, paper, roughness
from validation.report.accuracy import pareto_means, pareto_rows, smooth_rows
from validation.report.cost import cost_rows
from validation.report.packings import AtCenters, mixed_rows, packing_rows
from validation.report.paper import Squeezed
from validation.report.roughness import crystal_row, hysteresis, sliding
from validation.report.stability import stability_rows

FOLDER = Path(__file__).parent
Rows = list[dict[str, Any]]


@dataclass(frozen=True)
class Plan:
    """Arguments of the measurements of a report."""

    ablation: dict[str, Any]
    pareto: list[tuple[Any, ...]]
    smooth: list[tuple[int, int, int] | tuple[int, int, int, float, int]]
    friction: list[tuple[DeformablePolygon]]
    hysteresis: list[tuple[int, int, DeformablePolygon, float, int]]
    crystal: list[tuple[DeformablePolygon, float]]
    large: tuple[int, int, float, DeformablePolygon]
    mixtures: list[tuple[Any, ...]]
    shapes: dict[str, Any]
    stiffness: dict[str, Any]
    limits: list[tuple[Any, ...]]
    stability: dict[str, Any]


# kA and kP of the small and of the large particles.
_MIXTURES = (
    ((1.0, 10.0), (0.1, math.inf)),
    ((10.0, 1.0), (math.inf, 0.1)),
    ((1.0, 10.0), (math.inf, math.inf)),
    ((1.0, 1.0), (0.1, math.inf)),
)

# Packings of 16 that stay rigid to 5 %. Seed 2 loses its rigidity between 2 and 4 % strain.
_RIGID = (1, 3, 4)

# Small and large polygons have perimeters of the ratio 19:27 at rest, so that multiples of 19 give
# both the same kP at every number of vertices.
FULL = Plan(
    ablation={},
    pareto=[(16, seed, 171, 0.02, 2, (38, 57, 76, 114), (38, 57, 76)) for seed in _RIGID],
    smooth=[
        *((16, seed, count) for count in (80, 160) for seed in _RIGID),
        *((16, seed, 320, 0.05, 5) for seed in _RIGID),
        *((16, seed, 320, 0.005, 1) for seed in _RIGID),
    ],
    friction=[
        (standard_polygons(n, smooth=kind),) for kind in (True, False) for n in (40, 80, 160)
    ],
    hysteresis=[(16, 1, standard_polygons(80, smooth=kind), 0.03, 6) for kind in (True, False)],
    crystal=[(standard_polygons(n), a) for a in (0.01, 0.03) for n in (40, 80, 160)],
    large=(128, 1, 0.01, DeformablePolygon(50, smooth=False)),
    mixtures=[(16, seed, 0.02, 76, kA, kP) for kA, kP in _MIXTURES for seed in _RIGID[:2]],
    shapes={},
    stiffness={},
    limits=[(sides,) for sides in (3, 4, 6)],
    stability={},
)

QUICK = Plan(
    ablation={"repeats": 3},
    pareto=[(8, 1, 76, 0.02, 2, (38, 57), (38,))],
    smooth=[(8, 1, 57, 0.03, 3)],
    friction=[(standard_polygons(40, smooth=kind),) for kind in (True, False)],
    hysteresis=[(8, 1, standard_polygons(40, smooth=kind), 0.02, 2) for kind in (True, False)],
    crystal=[(standard_polygons(n), 0.03) for n in (40, 80)],
    large=(48, 1, 0.01, DeformablePolygon(50, smooth=False)),
    mixtures=[(8, 1, 0.02, 57, kA, kP) for kA, kP in _MIXTURES],
    shapes={"indentations": (0.01, 0.02, 0.03), "number": 96},
    stiffness={"indentations": (0.01, 0.02, 0.03), "number": 94, "kL": (1.0, 1e2, 1e4)},
    limits=[(6, 0.05, (24, 48, 96))],
    stability={"packings": 10, "steps": 10_000},
)


@dataclass(frozen=True, eq=False)
class Results:
    """Rows for tables, and the data of the figures."""

    ablation: Rows
    pareto: list[Rows]
    smooth: list[Rows]
    friction: Rows
    hysteresis: list[Rows]
    crystal: Rows
    large: tuple[Rows, dict[str, AtCenters]]
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


def pictures(results: Results) -> dict[str, Figure]:
    """The pictures of the page by file name."""
    rows = results.rows()
    compared = {
        law: each
        for law, each in results.large[1].items()
        if law in ("sector", "radical", "balanced")  # others lie on top of these
    }
    return {
        "accuracy.png": accuracy.accuracy_figure(rows["smooth"], rows["pareto"]),
        "pareto.png": accuracy.pareto_figure(rows["pareto"]),
        "compressions.png": accuracy.compressions_figure(rows["smooth"]),
        "roughness.png": roughness.figure(rows["friction"], rows["hysteresis"], rows["crystal"]),
        "packing.png": packings.packing(compared),
        "shapes_stick.png": paper.shapes_figure(results.shapes, stick=True),
        "shapes_slip.png": paper.shapes_figure(results.shapes, stick=False),
        "deviation.png": paper.deviation_figure(results.stiffness),
        "stiffness.png": paper.error_by_indentation(results.stiffness),
        "limit.png": paper.limits_figure(results.limits),
        "cost.png": cost.figure(rows["ablation"]),
    }


def report(folder: Path, quick: bool, overwrite: bool) -> None:
    """Measure everything, and write report.json and its pictures."""
    if (folder / "report.json").exists() and not overwrite:
        raise SystemExit(f"'{folder}' holds a report: give --overwrite, or another --out")
    parts = make_folder(folder / ("quick_parts" if quick else "parts"))
    results = measure(QUICK if quick else FULL, parts, print_once)
    content = results.rows() | {"machine": machine(), "versions": versions(), "quick": quick}
    for name, figure in pictures(results).items():
        figure.savefig(folder / name, dpi=150)
    (folder / "report.json").write_text(json.dumps(content, indent=1, allow_nan=False) + "\n")
    shutil.rmtree(parts)


def main() -> None:
    parser = argparse.ArgumentParser("validation.report", description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="measure less, in a few minutes")
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder")
    parser.add_argument("--overwrite", action="store_true", help="replace the report in the folder")
    options = parser.parse_args()
    began = time.perf_counter()
    report(options.out, options.quick, options.overwrite)
    print_once(f"wrote {options.out} ({time.perf_counter() - began:.0f} s)")


if __name__ == "__main__":
    main()

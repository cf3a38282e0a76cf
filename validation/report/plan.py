"""Extent of a report: arguments of every measurement, of the full report and of the quick one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from lammps_deformable.polygons import PolygonModel
from lammps_deformable.report import standard_polygons


@dataclass(frozen=True)
class Plan:
    """Arguments of the measurements of a report."""

    ablation: dict[str, Any]
    pareto: list[tuple[Any, ...]]
    smooth: list[tuple[int, int, int] | tuple[int, int, int, float, int]]
    friction: list[tuple[PolygonModel]]
    hysteresis: list[tuple[int, int, PolygonModel, float, int]]
    crystal: list[tuple[PolygonModel, float]]
    large: tuple[int, int, float, PolygonModel]
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
    large=(128, 1, 0.01, PolygonModel()),
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
    large=(48, 1, 0.01, PolygonModel()),
    mixtures=[(8, 1, 0.02, 57, kA, kP) for kA, kP in _MIXTURES],
    shapes={"indentations": (0.01, 0.02, 0.03), "number": 94},
    stiffness={"indentations": (0.01, 0.02, 0.03), "number": 94, "kL": (1.0, 1e2, 1e4)},
    limits=[(6, 0.05, (24, 48, 96))],
    stability={"packings": 10, "steps": 10_000},
)

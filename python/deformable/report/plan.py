"""Extent of a report: arguments of every measurement, of the full report and of the quick one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from ..model.beads import Beads


@dataclass(frozen=True)
class Plan:
    """Arguments of the measurements of a report."""

    ablation: dict[str, Any]
    pareto: dict[str, Any]
    large: tuple[int, int, float, Beads]
    packings: list[tuple[int, int, float, Beads]]
    compression: list[tuple[int, int, Beads, float, int]]
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
    mixtures=[
        (16, seed, strain, 150, kA, kP)
        for kA, kP in _MIXTURES
        for seed, strain in ((1, 0.01), (1, 0.02), (2, 0.02))
    ],
    shapes={},
    stiffness={},
    limits=[(sides,) for sides in (3, 4, 6)],
    stability={},
)

QUICK = Plan(
    ablation={"repeats": 3},
    pareto={"number": 16, "seeds": (1,), "strain": 0.02, "bead_numbers": [25, 35, 50]},
    large=(48, 1, 0.01, Beads()),
    packings=[(16, seed, 0.01, Beads()) for seed in (1, 2, 3)],
    compression=[(16, 3, Beads(), 0.03, 2)],
    mixtures=[(8, 1, 0.02, 50, kA, kP) for kA, kP in _MIXTURES],
    shapes={"indentations": (0.01, 0.02, 0.03), "number": 94},
    stiffness={"indentations": (0.01, 0.02, 0.03), "number": 94, "kL": (1.0, 1e2, 1e4)},
    limits=[(6, 0.05, (24, 48, 96))],
    stability={"packings": 10, "steps": 10_000},
)

"""Columns that several tables of the page share, and means over packings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from .numbers import percent, show, span
from .page import Column

Row = dict[str, Any]

STRAIN = Column("strain", "strain", "linear strain beyond jamming", show=percent)
SEED = Column("seed", "packing", "seed of the random start")
LAW = Column("law", "law", text=True)
SHAPE = Column("I", "shape error I", "mean distance of the outline from the rings over the radius")
AREA = Column("S_rms", "area error", "rms error of the area deficits over their rms")
ENERGY = Column("energy_ratio", "energy", "of the law over that of the rings, at their centers")
PRESSURE = Column(
    "pressure_ratio", "pressure", "of the law over that of the rings, at their centers"
)
OWN_ENERGY = Column(
    "own_energy_ratio",
    "own energy",
    "of the packing that the law relaxes to itself, over that of the rings",
)
RESIDUAL = Column(
    "residual", "residual", "largest force on a particle over the mean contact force at the end"
)
SECONDS = Column("seconds", "time", "processor time of the law", "s")


def grouped(rows: Iterable[Row], by: Sequence[str], values: Sequence[str]) -> list[Row]:
    """A row for each combination of the keys `by`, with the ranges of the values as text."""
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(repr([row[key] for key in by]), []).append(row)
    return [
        {key: same[0][key] for key in by}
        | {key: span((row[key] for row in same), 2 + key.endswith("_ratio")) for key in values}
        | {"packings": len({row["seed"] for row in same})}
        for same in groups.values()
    ]


def stiffness(values: Any) -> str:
    """kA or kP of small and large particles; none for laws that have none."""
    return show(values).replace(", ", " | ")

"""Error against run time: laws and polygons compressed from the same start, on one core."""

from __future__ import annotations

import math
from itertools import pairwise
from statistics import mean
from typing import TYPE_CHECKING, Any

from lammps_deformable.compression import compress
from lammps_deformable.jamming import jam
from lammps_deformable.packing import Packing
from lammps_deformable.random import bidisperse
from lammps_deformable.report import smooth_rows, standard_polygons, timed
from lammps_deformable.soft_disks import Disks

from validation.report.accuracy.errors import of_many_vertices

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

Row = dict[str, Any]


def pareto_rows(
    number: int,
    seed: int,
    reference: int,
    strain: float,
    steps: int,
    smooth: Sequence[int],
    bead: Sequence[int],
) -> list[Row]:
    """One packing compressed from jamming by every method, each relaxed on its own, on one core.

    Args:
        number: of particles.
        seed: of the random start.
        reference: N_v of the smooth polygons that errors refer to.
        strain: total linear strain.
        steps: number of steps.
        smooth: N_v of other smooth polygons, which take part like a law.
        bead: N_v of bead polygons.

    Returns:
        A row for each method at the last strain: `method`, `vertices` (N_v, or None), `seconds` of
        processor time of all steps, and the values of `smooth_rows`. Energies are over those of
        polygons of very many vertices, extrapolated from the finest smooth ones and the reference;
        `limit_error` of the reference is the change of that limit from the next coarser ones. The
        sector law does not come to rest and is taken at the centers of the reference, without a
        time.
    """
    rivals = [standard_polygons(count) for count in smooth]
    rivals += [standard_polygons(count, smooth=False) for count in bead]
    paths: dict[tuple[str, int | None], list[Row]] = {}
    for row in smooth_rows(number, seed, reference, strain, steps, rivals):
        if row["own"] or row["law"] == "sector":
            paths.setdefault((row["law"], row["vertices"]), []).append(row)
    found = []
    for (method, _), path in paths.items():
        times = [row["seconds"] for row in path]
        seconds = None if None in times else math.fsum(times)
        found.append(path[-1] | {"method": method, "seconds": seconds})
    last = path[-1]
    # a disk keeps its area, S = 0; its stiffness is free, so that its energy says nothing
    disk = dict.fromkeys(last) | {key: last[key] for key in ("n", "seed", "strain", "n_v")}
    spent = _seconds_of_disks(jam(bidisperse(number, seed=seed)), strain, steps)
    of_reference = math.fsum(row["seconds_polygons"] for row in path)
    exact = {"method": "reference", "vertices": reference, "seconds": of_reference}
    rows = [
        disk | {"method": "disk", "S_rms": 1.0, "seconds": spent},
        *found,
        disk | exact | {"S_rms": 0.0, "energy_ratio": 1.0, "pressure_ratio": 1.0},
    ]
    smooth_ones = [row for row in rows if row["method"] in ("smooth", "reference")]
    finest = sorted(smooth_ones, key=lambda row: int(row["vertices"]))[-3:]
    limits = [
        of_many_vertices(a["energy_ratio"], b["energy_ratio"], b["vertices"] / a["vertices"])
        for a, b in pairwise(finest)
    ]
    for row in rows:
        if row["energy_ratio"] is not None:
            row["energy_ratio"] /= limits[-1]
    rows[-1]["limit_error"] = abs(limits[0] / limits[-1] - 1.0)
    return rows


def _seconds_of_disks(start: Packing, strain: float, steps: int) -> float:
    return math.fsum(seconds for _, seconds in timed(compress(Disks(start), strain, steps)))


def pareto_means(packings: Iterable[Sequence[Row]]) -> list[Row]:
    """A row for each method of `pareto_rows`, with means over the packings.

    Keys: `method`; `vertices`, N_v or None; `reference`, N_v; `n`, `strain`, `seeds`;
    `energy_error` and `pressure_error`, means of |ratio - 1|; `error`, of `S_rms`; `shape_error`,
    of I; `seconds`; the largest `residual` of the method; and `limit_error` of the reference.
    """
    rows = []
    for same in zip(*packings, strict=True):
        first = same[0]
        rows.append(
            {key: first[key] for key in ("method", "vertices", "n", "strain")}
            | {
                "reference": first["n_v"],
                "seeds": [row["seed"] for row in same],
                "energy_error": _mean(same, "energy_ratio", 1.0),
                "pressure_error": _mean(same, "pressure_ratio", 1.0),
                "error": _mean(same, "S_rms"),
                "shape_error": _mean(same, "I"),
                "seconds": _mean(same, "seconds"),
                "residual": _most([row["law_residual"] for row in same]),
            }
        )
        if first["method"] == "reference":
            rows[-1]["limit_error"] = _mean(same, "limit_error")
    return rows


def _mean(rows: Sequence[Row], key: str, right: float = 0.0) -> float | None:
    """Mean distance from the right value; None if a row has none."""
    values = [row[key] for row in rows]
    return None if None in values else mean(abs(value - right) for value in values)


def _most(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return max(known, default=None)

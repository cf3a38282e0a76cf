"""How right each method is, how long it takes, and where the balanced law misses its bar."""

from __future__ import annotations

import math
from statistics import median
from typing import TYPE_CHECKING, Any

from lammps_deformable.relax import TOLERANCE

from validation.report.law_styles import POLYGON_NAMES, STYLES
from validation.report.section import percent

if TYPE_CHECKING:
    from collections.abc import Sequence

Row = dict[str, Any]

# The balanced law has the energy of smooth polygons to this part, up to this strain.
BARS = {0.03: 0.01, 0.045: 0.02}

# Residual above which smooth polygons have not converged.
CONVERGED = 1e-6

_ROUNDING = 1e-9  # of strains, which are multiples of a step


def bar(strain: float) -> float | None:
    """The energy error that is allowed at a strain; None beyond the last bar."""
    return next((part for most, part in BARS.items() if strain <= most + _ROUNDING), None)


def whole(rows: Sequence[Row]) -> list[Row]:
    """Rows of the references that are compressed to the largest strain."""
    last = max(row["strain"] for row in rows)
    numbers = {row["n_v"] for row in rows if row["strain"] == last}
    return [row for row in rows if row["n_v"] in numbers]


def exceptions(rows: Sequence[Row]) -> list[Row]:
    """Rows of `smooth_rows` of the balanced law, relaxed on its own, that miss their bar.

    Each has a `reason`, the first of these that holds: the reference has not converged; the law has
    not; law and reference are apart by more than the mean overlap, 2 strain R, so that one of them
    has rearranged; the reference has too few vertices, if the bar is met against finer polygons of
    the same packing; the law itself, if it is missed in the limit of many vertices, extrapolated in
    1/N_v^2 from the two finest polygons. It is empty if there is none of these.
    """
    own = [row for row in rows if row["law"] == "balanced" and row["own"]]
    found = []
    for row in own:
        if _meets(row) and row["residual"] <= CONVERGED:
            continue
        same = [
            other
            for other in own
            if (other["seed"], other["strain"]) == (row["seed"], row["strain"])
            and other["residual"] <= CONVERGED
        ]
        limit = _limit(same)
        reasons = {
            "the reference has not converged": row["residual"] > CONVERGED,
            "the law has not converged": row["law_residual"] > TOLERANCE,
            "one of both has rearranged": (
                row["distance"] is None or row["distance"] > 2.0 * row["strain"]
            ),
            "the reference has too few vertices": any(
                _meets(other) for other in (*same, *limit) if other["n_v"] > row["n_v"]
            ),
            "the law itself is off": bool(limit),
        }
        reason = next((text for text, holds in reasons.items() if holds), "")
        found.append(row | {"bar": bar(row["strain"]), "reason": reason})
    return found


def of_many_vertices(coarse: float, fine: float, times: float) -> float:
    """The limit of an energy of polygons, which differs from it by a part of 1/N_v^2.

    Args:
        coarse: energy of polygons of N_v vertices.
        fine: that of `times` as many.
        times: above 1.
    """
    return fine + (fine - coarse) / (times**2 - 1.0)


def _limit(same: Sequence[Row]) -> list[Row]:
    """A row of polygons of very many vertices, from the two finest; none if there is one."""
    by_number = {row["n_v"]: row for row in same}
    if len(by_number) < 2:
        return []
    coarse, fine = (by_number[count] for count in sorted(by_number)[-2:])
    energy = of_many_vertices(
        1.0 / coarse["energy_ratio"], 1.0 / fine["energy_ratio"], fine["n_v"] / coarse["n_v"]
    )
    return [fine | {"n_v": math.inf, "energy_ratio": 1.0 / energy}]


def _meets(row: Row) -> bool:
    allowed, ratio = bar(row["strain"]), row["energy_ratio"]
    return allowed is None or (ratio is not None and abs(ratio - 1.0) <= allowed)


def label(row: Row) -> str:
    """Name of a method of `pareto_means` in words."""
    if row["method"] == "reference":
        return f"smooth polygons, {row['vertices']}"
    if row["vertices"]:
        return f"{POLYGON_NAMES[row['method']]}, {row['vertices']}"
    return str(row["method"])


def whole_percents(rows: Sequence[Row]) -> list[float]:
    """The strains that are whole per cent, or all if none is."""
    strains = sorted({row["strain"] for row in rows})
    return [strain for strain in strains if round(100.0 * strain, 6) % 1 == 0] or strains


def energy_errors(rows: Sequence[Row], law: str) -> dict[float, list[float]]:
    """|E/E(polygons) - 1| of a law at each strain, of all packings.

    The energy of the polygons is extrapolated from the two finest that have converged, where there
    are two. The sector law does not converge, and is evaluated at the polygons' centers.

    Args:
        rows: of `smooth_rows`.
        law: its name.
    """
    rows = whole(rows)
    finest = {row["strain"] for row in rows if row["n_v"] == max(row["n_v"] for row in rows)}
    by_state: dict[tuple[float, int], list[Row]] = {}
    for row in rows:
        chosen = row["law"] == law and (row["own"] or law == "sector") and row["strain"] in finest
        if chosen and row["residual"] <= CONVERGED and row["energy_ratio"] is not None:
            by_state.setdefault((row["strain"], row["seed"]), []).append(row)
    found: dict[float, list[float]] = {}
    for (strain, _), same in sorted(by_state.items()):
        (best,) = _limit(same) or same
        found.setdefault(strain, []).append(abs(best["energy_ratio"] - 1.0))
    return found


def summary(rows: Sequence[Row], pareto: Sequence[Row]) -> list[Row]:
    """A row for each method: energy errors by strain, area error and time.

    Args:
        rows: of `smooth_rows`; the errors of the laws are medians over the packings.
        pareto: of `pareto_means`; areas, times, and the energy errors of polygons.

    Returns:
        Rows `name`, the energy error at each strain under its name, as "2 %", `error` of the area
        deficits and `seconds`.
    """
    at = pareto[0]["strain"]
    found = []
    for row in pareto:
        if row["method"] in STYLES:
            errors = energy_errors(rows, row["method"])
            energy = {percent(s): median(errors[s]) for s in whole_percents(rows) if s in errors}
        else:
            energy = {percent(at): row["energy_error"]}
        found.append(
            {"name": label(row), "error": row["error"], "seconds": row["seconds"]} | energy
        )
    return sorted(found, key=lambda row: row["seconds"] or 0.0)


def fastest_as_good(pareto: Sequence[Row]) -> dict[str, Row]:
    """The fastest polygons of each kind whose energy is at least as right as the balanced law's."""
    (balanced,) = (row for row in pareto if row["method"] == "balanced")
    found: dict[str, Row] = {}
    for row in sorted(pareto, key=lambda row: row["seconds"] or 0.0):
        error = row["energy_error"]
        known = error is not None and row["method"] in ("smooth", "bead")
        if known and error <= balanced["energy_error"]:
            found.setdefault(row["method"], row)
    return found

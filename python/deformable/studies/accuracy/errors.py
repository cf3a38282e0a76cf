"""How right each method is, how long it takes, and where the balanced law misses its bar."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import median
from typing import Any

from ...engine.relaxation import TOLERANCE
from ..law_styles import POLYGON_NAMES, STYLES
from ..section import percent

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
        limit = _of_many_vertices(same)
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


def _of_many_vertices(same: Sequence[Row]) -> list[Row]:
    """A row of polygons of very many vertices, from those of two numbers; none if there is one."""
    by_number = {row["n_v"]: row for row in same}
    if len(by_number) < 2:
        return []
    coarse, fine = (by_number[count] for count in sorted(by_number)[-2:])
    step = (fine["energy_ratio"] - coarse["energy_ratio"]) / (
        (fine["n_v"] / coarse["n_v"]) ** 2 - 1
    )
    return [fine | {"n_v": math.inf, "energy_ratio": fine["energy_ratio"] + step}]


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
    """|E/E(polygons) - 1| of a law at each strain, of all packings, against the finest polygons.

    The sector law does not converge, and is evaluated at the polygons' centers. Rows whose
    reference has not converged are left out.

    Args:
        rows: of `smooth_rows`.
        law: its name.
    """
    rows = whole(rows)
    finest = max(row["n_v"] for row in rows)
    found: dict[float, list[float]] = {}
    for row in rows:
        chosen = (row["law"], row["n_v"]) == (law, finest) and (row["own"] or law == "sector")
        if chosen and row["residual"] <= CONVERGED and row["energy_ratio"] is not None:
            found.setdefault(row["strain"], []).append(abs(row["energy_ratio"] - 1.0))
    return dict(sorted(found.items()))


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


def reference_error(pareto: Sequence[Row]) -> float:
    """Relative error of the energy of the reference polygons themselves.

    The energy of polygons of N_v vertices is off by a part c/N_v^2, and the next finest polygons
    differ from the reference by e. So the reference is off by e/((N_ref/N_v)^2 - 1).

    Args:
        pareto: of `pareto_means`.
    """
    fine = max((r for r in pareto if r["method"] == "smooth"), key=lambda row: row["vertices"])
    return fine["energy_error"] / ((fine["reference"] / fine["vertices"]) ** 2 - 1.0)


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

"""How right each method is at each strain, and how long it takes: one table."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median
from typing import Any

from ..studies.law_styles import STYLES
from .bars import CONVERGED, whole
from .numbers import percent

Row = dict[str, Any]


def label(row: Row) -> str:
    """Name of a method of `pareto_means` in words."""
    if row["method"] == "reference":
        return f"smooth rings, {row['rings']}"
    return f"{row['method']} rings, {row['rings']}" if row["rings"] else str(row["method"])


def whole_percents(rows: Sequence[Row]) -> list[float]:
    """The strains that are whole per cent, or all if none is."""
    strains = sorted({row["strain"] for row in rows})
    return [strain for strain in strains if round(100.0 * strain, 6) % 1 == 0] or strains


def energy_errors(rows: Sequence[Row], law: str) -> dict[float, list[float]]:
    """|E/E(rings) - 1| of a law at each strain, of all packings, against the finest whole rings.

    The sector law does not come to rest, and is taken at the centers of the rings. Rows whose
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
        pareto: of `pareto_means`; areas, times, and the energy errors of rings.

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
    """The fastest rings of each kind whose energy is at least as right as the balanced law's."""
    (balanced,) = (row for row in pareto if row["method"] == "balanced")
    found: dict[str, Row] = {}
    for row in sorted(pareto, key=lambda row: row["seconds"] or 0.0):
        error = row["energy_error"]
        known = error is not None and row["method"] in ("smooth", "rough")
        if known and error <= balanced["energy_error"]:
            found.setdefault(row["method"], row)
    return found

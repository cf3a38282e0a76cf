"""Limits of each law, as rows of the report."""

from __future__ import annotations

from typing import Any

from ..model.packing import bidisperse
from ..protocols.jamming import jam
from .stability_cases import (
    convergence_rows,
    density_rows,
    kernel_rows,
    size_rows,
    stiffness_rows,
)
from .stability_runs import energy_rows, error_rows, rank_rows


def stability_rows(
    packings: int = 100, steps: int = 1_000_000, ranks: int = 4, densest: float = 1.2
) -> list[dict[str, Any]]:
    """All cases, of 16 particles.

    Args:
        packings: number relaxed by each law.
        steps: of the longest run at constant energy.
        ranks: largest number that share a packing.
        densest: largest packing fraction; past confluence tilted contacts take minutes.

    Returns:
        Rows `case`, `law`, `quantity`, `value` (None after an error), `limit`, `ok` and `reason`,
        see `stability_cases`.
    """
    jammed = jam(bidisperse(16, seed=1))
    return [
        *energy_rows(jammed.at(0.88), steps),
        *error_rows(jammed.at(0.88)),
        *stiffness_rows(jammed),
        *density_rows(jammed, densest),
        *size_rows(),
        *kernel_rows(),
        *rank_rows(jammed.at(0.88), ranks),
        *convergence_rows(packings),
    ]

"""How right the balanced law is to be, and where it is not, with the reason."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..engine.relaxation import TOLERANCE

Row = dict[str, Any]

# The balanced law has the energy of smooth rings to this part, up to this strain.
BARS = {0.03: 0.01, 0.045: 0.02}

# Residual above which smooth rings have not converged.
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

    Each has a `reason`, in this order: the reference has not converged; the law has not; law and
    reference are apart by more than the mean overlap, 2 strain R, so that one of them has
    rearranged; the reference has too few vertices, if the bar is met against finer rings of the
    same packing. It is empty if there is none of these.
    """
    own = [row for row in rows if row["law"] == "balanced" and row["own"]]
    found = []
    for row in own:
        if _meets(row) and row["residual"] <= CONVERGED:
            continue
        finer = [
            other
            for other in own
            if other["n_v"] > row["n_v"]
            and (other["seed"], other["strain"]) == (row["seed"], row["strain"])
        ]
        reasons = {
            "the reference has not converged": row["residual"] > CONVERGED,
            "the law has not converged": row["law_residual"] > TOLERANCE,
            "one of both has rearranged": (
                row["distance"] is None or row["distance"] > 2.0 * row["strain"]
            ),
            "the reference has too few vertices": any(
                _meets(other) and other["residual"] <= CONVERGED for other in finer
            ),
        }
        reason = next((text for text, holds in reasons.items() if holds), "")
        found.append(row | {"bar": bar(row["strain"]), "reason": reason})
    return found


def _meets(row: Row) -> bool:
    allowed, ratio = bar(row["strain"]), row["energy_ratio"]
    return allowed is None or (ratio is not None and abs(ratio - 1.0) <= allowed)

"""How right the balanced law is to be, and where it is not, with the reason."""

from __future__ import annotations

import math
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

    Each has a `reason`, the first of these that holds: the reference has not converged; the law has
    not; law and reference are apart by more than the mean overlap, 2 strain R, so that one of them
    has rearranged; the reference has too few vertices, if the bar is met against finer rings of the
    same packing; the law itself, if it is missed in the limit of many vertices, extrapolated in
    1/N_v^2 from the two finest rings. It is empty if there is none of these.
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
    """A row of rings of very many vertices, from those of two numbers; none if there is one."""
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

"""The section on stability."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lammps_deformable.laws import LAWS

from validation.report.section import Column, Row, Section, Table, listed, show, span

if TYPE_CHECKING:
    from collections.abc import Sequence


def section(rows: Sequence[Row]) -> Section:
    missed = [row for row in rows if not row["ok"]]
    by_law = {name: sum(row["law"] == name for row in missed) for name in LAWS}
    kept = [name for name, count in by_law.items() if count == 0]
    reasons = dict.fromkeys(
        f"`{row['law']}`: {row['reason'].split(': LAMMPS')[0]}" for row in missed if row["reason"]
    )
    return Section(
        "Stability",
        (
            "Each case varies one thing, such as the time step, the stiffness, the density or the "
            "ratio of sizes, and measures a quantity that must not exceed a limit: rounding, the "
            "tolerance of a relaxation, or a derived bound.",
            f"{len(rows) - len(missed)} of {len(rows)} measurements stay within their limits (✓). "
            + (f"All measurements of {listed(f'`{name}`' for name in kept)} do. " if kept else "")
            + (
                "The others (✗) are "
                + listed(f"{count} of `{name}`" for name, count in by_law.items() if count)
                + ". Reasons: "
                + "; ".join(reasons)
                + "."
                if missed
                else ""
            ),
        ),
        tables=[
            Table(
                "Measured values and their limits",
                [
                    Column("case", "case", text=True),
                    Column("quantity", "quantity", text=True),
                    *(Column(name, name) for name in LAWS),
                    Column("limit", "limit", "the value must not exceed it"),
                ],
                _by_case(rows),
            )
        ],
    )


def _by_case(rows: Sequence[Row]) -> list[Row]:
    """A row for each case and quantity, with a value and a mark for each law."""
    found: list[Row] = []
    for case, quantity in dict.fromkeys((row["case"], row["quantity"]) for row in rows):
        same = [row for row in rows if (row["case"], row["quantity"]) == (case, quantity)]
        values = {row["law"]: f"{show(row['value'])} {'✓' if row['ok'] else '✗'}" for row in same}
        limit = span(row["limit"] for row in same if row["value"] is not None)
        found.append({"case": case, "quantity": quantity, "limit": limit} | values)
    return found

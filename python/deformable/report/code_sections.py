"""Sections on the code itself: stability, and the cost of options."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..model.laws import LAWS
from .numbers import listed, show, span
from .page import Column, Picture, Section, Table

Row = dict[str, Any]


def stability(rows: Sequence[Row]) -> Section:
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


def cost(rows: Sequence[Row]) -> Section:
    plain = {row["law"]: row["on"] for row in rows if row["option"] == "none"}
    options = list(dict.fromkeys(row["option"] for row in rows if row["option"] != "none"))
    by_law = [
        {"law": law, "bare": bare}
        | {row["option"]: row["extra"] for row in rows if row["law"] == law and "extra" in row}
        for law, bare in plain.items()
    ]
    return Section(
        "Cost of a step",
        (
            "Processor time per particle and step in a bare scene, and the extra time of each "
            "option if it is asked for at every step. A scene pays only for the options that it "
            "uses.",
            "A step of one particle costs "
            + listed(f"{bare:.0f} ns (`{law}`)" for law, bare in plain.items())
            + ". Differences of a few ns are noise, also negative ones.",
        ),
        pictures=[
            Picture(
                "cost.png",
                "Left: bare scenes. Right: extra time of each option, a marker for each law.",
                "Bars of the time per particle and step for each law, and points of the extra time "
                "of five options.",
            )
        ],
        tables=[
            Table(
                "Time in ns per particle and step",
                [
                    Column("law", "law", text=True),
                    Column("bare", "bare scene", show=_whole),
                    *(Column(option, f"+ {option}", show=_whole) for option in options),
                ],
                by_law,
            )
        ],
    )


def _whole(value: float | None) -> str:
    return "–" if value is None else show(float(round(value)))

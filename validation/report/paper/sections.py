"""Sections on one particle between walls: shapes, stiffness, and the exact limit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from validation.report.section import Column, Picture, Section, Table, listed, show, span

if TYPE_CHECKING:
    from collections.abc import Sequence

Row = dict[str, Any]

_MAGNIFIED = (
    "Each law is drawn with its distance from the beads magnified by the factor in the panel; "
    "without that the lines would lie on top of each other."
)


def polygons(rows: Sequence[Row]) -> Section:
    """The rows of `paper.shapes`: walls that stick, and walls that slip."""
    asymmetric = [row for row in rows if row["polygon"] == "irregular"]
    stick = [row for row in asymmetric if row["walls"] == "stick"]
    slip = [row for row in asymmetric if row["walls"] == "slip"]
    return Section(
        "One particle in a polygon",
        (
            f"A ring of {rows[0]['n_v']} beads is squeezed between the walls of a polygon, as in "
            "the paper. Beads stick to the walls, or slip along them. The sector law describes "
            "contacts that stick, the ring law contacts that slip. Both keep the perimeter here "
            "(kP inf).",
            "In regular polygons both laws agree by symmetry. In asymmetric ones each is right in "
            f"its regime. With walls that stick, I of sector is {_span(stick, 'I_sector')}, of "
            f"ring {_span(stick, 'I_ring_kP_inf')}. With walls that slip, I of ring is "
            f"{_span(slip, 'I_ring_kP_inf')}, of sector {_span(slip, 'I_sector')}.",
            "The rest of I of the ring law comes from the center: the laws get the mean of the "
            "beads, but the law's own center is the Steiner point. About that point I is "
            f"{_span(slip, 'I_ring_kP_inf_steiner')}.",
        ),
        pictures=[
            Picture(
                "shapes_stick.png",
                f"Walls that stick. {_MAGNIFIED} In asymmetric polygons (last two panels) the "
                "sector law stays on the beads.",
                "Six polygons with a ring of beads in each and the magnified outlines of the "
                "sector law and of the ring law.",
            ),
            Picture(
                "shapes_slip.png",
                "Walls that slip, magnified in the same way. In asymmetric polygons the ring law "
                "stays on the beads.",
                "The same six polygons with walls along which beads slip.",
            ),
        ],
        tables=[
            Table(
                "Ranges of the shape error I over all indentations",
                [
                    Column("polygon", "polygon", text=True),
                    Column("walls", "walls", text=True),
                    Column("I_sector", "sector"),
                    Column("I_ring_kP_inf", "ring, kP inf"),
                    Column("I_ring", "ring", "with the stiffness of the springs"),
                ],
                _ranges(rows),
            )
        ],
    )


def _ranges(rows: Sequence[Row]) -> list[Row]:
    laws = ("I_sector", "I_ring_kP_inf", "I_ring")
    cases = dict.fromkeys((row["walls"], row["polygon"], row["sides"]) for row in rows)
    found = []
    for case in cases:
        same = [row for row in rows if (row["walls"], row["polygon"], row["sides"]) == case]
        kind = "regular" if case[1] == "regular" else "asymmetric"
        found.append(
            {"polygon": f"{kind}, {case[2]} sides", "walls": case[0]}
            | {law: _span(same, law) for law in laws}
        )
    return found


def _span(rows: Sequence[Row], key: str) -> str:
    return span(row[key] for row in rows)


def stiffness(rows: Sequence[Row]) -> Section:
    """The rows of `paper.stiffness_sweep`."""
    softest, stiffest = (f(row["kL"] for row in rows) for f in (min, max))
    depths = sorted({row["a_over_R"] for row in rows})
    a = depths[len(depths) // 2]
    soft, stiff = (_at(rows, kL, a) for kL in (softest, stiffest))
    return Section(
        "Stiffness of the perimeter",
        (
            f"A ring of {rows[0]['n_v']} beads in a hexagon whose walls stick, with springs from "
            "soft to stiff. The sector law keeps its perimeter; real rings stretch, so that their "
            "beads lie outside its outline.",
            f"At a/R₀ = {a:g} the shape error of the sector law falls from "
            f"{show(soft['I_sector'])} at kL = {show(softest)} to {show(stiff['I_sector'])} at kL "
            f"= {show(stiffest)}, where the spacing of the beads is all that is left. The ring law "
            "with the stiffness of the springs (kP = kL/N) needs no stiff springs: there it has "
            f"{show(soft['I_ring'])} and {show(stiff['I_ring'])}. It lets contacts slip, "
            "though, and these stick: soft rings that are pressed deeper deviate from it.",
        ),
        pictures=[
            Picture(
                "deviation.png",
                "Distance of the beads from the outline of the sector law against the direction. "
                "It vanishes at the six walls and is largest in the middle of the free arcs. The "
                "lower panel magnifies the stiff rings.",
                "Curves with six equal bumps, lower for stiffer springs.",
            ),
            Picture(
                "stiffness.png",
                "Shape error of the sector law against indentation (left) and against the "
                "stiffness of the springs (right). Dashed: the ring law, which has that stiffness "
                "itself.",
                "Rising curves of the shape error against indentation; curves that fall with "
                "stiffness down to the line of the spacing of the beads.",
            ),
        ],
    )


def _at(rows: Sequence[Row], kL: float, a: float) -> Row:
    return next(row for row in rows if (row["kL"], row["a_over_R"]) == (kL, a))


def limits(rows: Sequence[Row]) -> Section:
    powers = listed(
        f"{show(row['rate_n_v'], 3)} and {show(row['rate_kP'])} for {row['sides']} sides"
        for row in rows
    )
    return Section(
        "The exact limit",
        (
            "In a regular polygon whose walls slip, the area deficit of the ring law is exactly "
            "S = K a². Rings of beads tend to it with more beads and stiffer springs.",
            "Expected are errors that fall as the power −2 of the number of beads and as the power "
            f"−1 of the perimeter stiffness kP. The measured powers are {powers}.",
        ),
        pictures=[
            Picture(
                "limit.png",
                "Relative error of the beads' area deficit against their number (left) and against "
                "the stiffness (right). Points: measured. Lines: expected.",
                "Two logarithmic plots with points along straight falling lines.",
            )
        ],
    )

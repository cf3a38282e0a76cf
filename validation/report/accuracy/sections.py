"""Sections that measure the laws with smooth polygons: in short, against run time, compressions."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING, Any

from validation.report import section as c
from validation.report.accuracy.errors import (
    BARS,
    CONVERGED,
    exceptions,
    fastest_as_good,
    label,
    summary,
    whole,
    whole_percents,
)
from validation.report.law_styles import POLYGON_NAMES
from validation.report.section import Column, Picture, Section, Table, listed, percent, show, span

if TYPE_CHECKING:
    from collections.abc import Sequence

Row = dict[str, Any]


def in_short(rows: Sequence[Row], pareto: Sequence[Row]) -> Section:
    """How right and how fast each law is: one table and one picture."""
    finest = max(row["n_v"] for row in whole(rows))
    strains = [percent(strain) for strain in whole_percents(rows)]
    return Section(
        "In short",
        (
            f"Laws and smooth polygons compress the same packings of {rows[0]['n']} particles from "
            "jamming, and each relaxes on its own. The table has the error of the energy: of the "
            f"laws against polygons of up to {finest} vertices, extrapolated to very many, the "
            "median over the packings. The sector law does not converge; it is evaluated at the "
            "polygons' centers.",
            _as_good(pareto),
        ),
        pictures=[
            Picture(
                "accuracy.png",
                "Left: error of the energy of each law; points are packings, lines their medians. "
                "Right: processor time of a whole compression.",
                "A logarithmic plot of energy errors against strain, a line for each law, and bars "
                "of the processor time of each method.",
            )
        ],
        tables=[
            Table(
                "Error of the energy by strain, error of the area deficits, and time",
                [
                    Column("name", "method", "polygons: number of vertices", text=True),
                    *(Column(s, s, "error of the energy at this strain") for s in strains),
                    Column("error", f"areas, {percent(pareto[0]['strain'])}", c.AREA.note),
                    Column("seconds", "time", f"to {percent(pareto[0]['strain'])} strain", "s"),
                ],
                summary(rows, pareto),
            )
        ],
    )


def _converged(rows: Sequence[Row], strain: float, key: str) -> list[float]:
    """Values at a strain where the reference has converged."""
    return [
        row[key]
        for row in rows
        if row["strain"] == strain and row["residual"] <= CONVERGED and row[key] is not None
    ]


def _as_good(pareto: Sequence[Row]) -> str:
    polygons = fastest_as_good(pareto)
    (balanced,) = (row for row in pareto if row["method"] == "balanced")
    text = (
        f"At {percent(balanced['strain'])} strain the energy of `balanced` is wrong by "
        f"{show(balanced['energy_error'])} and its area deficits by {show(balanced['error'])}; "
        f"the compression takes {show(balanced['seconds'])} s. "
    )
    for kind in ("smooth", "bead"):
        if kind in polygons:
            row = polygons[kind]
            text += (
                f"The fastest {POLYGON_NAMES[kind]} with an energy that is as right have "
                f"{row['vertices']} vertices and take {show(row['seconds'])} s, "
                f"{row['seconds'] / balanced['seconds']:.0f} times as long. "
            )
        else:
            text += f"No {POLYGON_NAMES[kind]} of the report are as right. "
    return text.strip()


def pareto(rows: Sequence[Row]) -> Section:
    first = rows[0]
    return Section(
        "Error against run time",
        (
            f"Every method compresses the same packings of {first['n']} particles (seeds "
            f"{show(first['seeds'])}) from jamming to {percent(first['strain'])} strain, and "
            "relaxes on its own. "
            f"Errors are against smooth polygons of {first['reference']} vertices, energies "
            "extrapolated from there to very many; errors and times are means. That limit changes "
            f"by {show(rows[-1]['limit_error'])} if it is taken from coarser polygons. Polygons of "
            "different numbers of vertices stand for the same particles: radii and kP agree.",
            "Bead polygons catch on each other: more vertices do not make them as right as smooth "
            "polygons. With few vertices both are wrong: a contact then has hardly more than one.",
        ),
        pictures=[
            Picture(
                "pareto.png",
                "Lower left is better: more accurate and faster. Numbers: vertices of a small "
                "polygon. Dotted: the error of `balanced`.",
                "Two logarithmic scatter plots of the errors of energies and of area deficits "
                "against processor time, a marker for each law and lines for polygons.",
            )
        ],
        tables=[
            Table(
                "Errors and times of all methods, means over the packings",
                [
                    Column("name", "method", text=True),
                    Column("energy_error", "energy error", "mean of |ratio − 1|"),
                    Column("pressure_error", "pressure error", "mean of |ratio − 1|"),
                    Column("error", "area error", "rms error of the area deficits over their rms"),
                    Column(
                        "shape_error", "shape error", "mean error of the outline over the radius"
                    ),
                    Column("seconds", "time", "processor time of all steps", "s"),
                    c.RESIDUAL,
                ],
                [row | {"name": label(row)} for row in rows],
            )
        ],
    )


def compressions(rows: Sequence[Row]) -> Section:
    """The rows of `smooth_rows`: laws along compressions, and where the balanced one is off."""
    missed = exceptions(rows)
    numbers = sorted({row["n_v"] for row in whole(rows)})
    own = [row for row in rows if row["own"] and row["law"] == "balanced"]
    bars = listed(
        f"{percent(part)} up to {percent(strain)} strain" for strain, part in BARS.items()
    )
    return Section(
        "Whole compressions",
        (
            f"The law `balanced` over smooth polygons of {numbers[-1]} vertices: "
            f"{_along(rows, 'balanced', numbers[-1])}. "
            "At the centers of the polygons it has "
            f"{span(_at_centers(rows, numbers[-1]), 4)} times their energy.",
            f"Its energy is to be right to {bars}, wherever the polygons have converged (residual "
            f"at most {show(CONVERGED)}). {len(own) - len(missed)} of {len(own)} steps are. "
            + (_reasons(missed) if missed else ""),
            f"The law `curved`: {_along(rows, 'curved', numbers[-1])}.",
            "The laws `radical` have contact lines on the radical axis. Their energies are off by "
            f"factors: {_medians(rows, numbers[-1])}.",
        ),
        pictures=[
            Picture(
                "compressions.png",
                "Each column is a packing. Top: the law balanced over smooth polygons that have "
                "converged; gray: the error that is allowed. Bottom: distances of the laws' "
                "centers from those of the finest polygons; above the dotted line one of both has "
                "rearranged.",
                "Lines of energy and pressure ratios near one, and of distances of centers, "
                "against strain, for each packing.",
            )
        ],
        tables=[
            Table(
                "Steps at which the energy of the balanced law is off, with the reason",
                [*_STEP, _BAR, c.RESIDUAL, _REASON],
                missed,
            ),
            Table(
                f"All {len(rows)} rows",
                [*_STEP[:2], c.LAW, _OWN, *_STEP[2:], c.AREA, c.SHAPE, c.RESIDUAL],
                rows,
                folded=True,
            ),
        ],
    )


_OWN = Column("own", "on its own", "relaxed alone, else at the centers of the polygons")
_BAR = Column("bar", "allowed", "error of the energy")
_REASON = Column("reason", "reason", text=True, show=lambda reason: reason or "none found")
_STEP = (
    c.SEED,
    c.STRAIN,
    Column("n_v", "vertices", "of a small polygon of the reference"),
    Column("energy_ratio", "energy", "over that of the polygons", show=lambda x: show(x, 4)),
    Column("pressure_ratio", "pressure", "over that of the polygons", show=lambda x: show(x, 4)),
    Column("distance", "distance", "of the centers, rms, over the mean radius"),
)


def _along(rows: Sequence[Row], law: str, count: int) -> str:
    """Energies and pressures of a law on its own over those of converged polygons, by strain."""
    own = [row for row in rows if (row["law"], row["n_v"], row["own"]) == (law, count, True)]
    return "; ".join(
        f"{percent(strain)}: energy {span(_converged(own, strain, 'energy_ratio'), 4)}, "
        f"pressure {span(_converged(own, strain, 'pressure_ratio'), 4)}"
        for strain in whole_percents(own)
    )


def _at_centers(rows: Sequence[Row], count: int) -> list[float]:
    return [
        row["energy_ratio"]
        for row in rows
        if row["law"] == "balanced"
        and not row["own"]
        and row["n_v"] == count
        and row["residual"] <= CONVERGED
    ]


def _reasons(missed: Sequence[Row]) -> str:
    counts = {row["reason"]: 0 for row in missed}
    for row in missed:
        counts[row["reason"]] += 1
    texts = [f"{count} ({why or 'no reason found'})" for why, count in counts.items()]
    return f"The others are listed: {listed(texts)}."


def _medians(rows: Sequence[Row], count: int) -> str:
    found = []
    for law in ("radical", "radical, kP inf"):
        ratios = [
            row["energy_ratio"]
            for row in rows
            if (row["law"], row["n_v"], row["own"]) == (law, count, True)
            and row["energy_ratio"] is not None
        ]
        found.append(f"{show(median(ratios), 3)} in the median (`{law}`)")
    return listed(found)

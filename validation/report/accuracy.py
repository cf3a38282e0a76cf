"""How right each law is, and how fast: laws and polygons compress the same packings."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from statistics import mean, median
from typing import Any

import numpy as np
from lammps_deformable.engine.jamming import jam
from lammps_deformable.engine.relax import TOLERANCE
from lammps_deformable.particles.generators import bidisperse
from lammps_deformable.particles.polygons import DeformablePolygon
from lammps_deformable.reference.comparison import (
    compare,
    compression_rows,
    of_many_vertices,
    standard_polygons,
)
from lammps_deformable.reference.error_plot import (
    POLYGON_NAMES,
    POLYGONS,
    SMOOTH,
    STYLES,
    Style,
    plot_errors,
)
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from validation.report import section as c
from validation.report.section import (
    Column,
    Picture,
    Row,
    Section,
    Table,
    legend_below,
    listed,
    percent,
    show,
    span,
)

# Keys of the rows of `ld.compare`, and of the means over packings.
_MEANS = {
    "energy_error": "energy_error",
    "pressure_error": "pressure_error",
    "area_error": "error",
    "shape_error": "shape_error",
    "seconds": "seconds",
}


def smooth_rows(
    number: int,
    seed: int,
    count: int,
    strain: float = 0.05,
    steps: int = 10,
    rivals: Sequence[DeformablePolygon] = (),
    model: DeformablePolygon | None = None,
) -> list[Row]:
    """`compression_rows` of a bidisperse packing.

    Args:
        number: of particles.
        seed: of the random start.
        count: N_v of the reference, vertices of a small polygon, see `standard_polygons`.
        strain: total linear strain.
        steps: number of steps.
        rivals: other polygons.
        model: of the reference, with `count` vertices; `standard_polygons` if not given.
    """
    start = jam(bidisperse(number, seed=seed)).packing
    model = model or standard_polygons(count)
    rows = compression_rows(start, model, strain, steps, rivals, workers=1)
    return [{"n": number, "seed": seed} | row for row in rows]


def pareto_rows(
    number: int,
    seed: int,
    reference: int,
    strain: float,
    steps: int,
    smooth: Sequence[int],
    bead: Sequence[int],
) -> list[Row]:
    """Rows of `ld.compare` for a bidisperse packing, and `n`, `seed`, `reference`.

    Args:
        number: of particles.
        seed: of the random start.
        reference: N_v of the smooth polygons that errors refer to.
        strain: total linear strain.
        steps: number of steps.
        smooth: N_v of other smooth polygons, which take part like a law.
        bead: N_v of bead polygons.
    """
    start = jam(bidisperse(number, seed=seed)).packing
    counts = (*smooth, reference)
    found = compare(start, vertices=counts, beads=bead, strain=strain, steps=steps, workers=1)
    return [{"n": number, "seed": seed, "reference": reference} | row for row in found.rows]


def pareto_means(packings: Iterable[Sequence[Row]]) -> list[Row]:
    """A row for each method of `pareto_rows`, with means over the packings.

    Keys: `method`; `vertices`, N_v or None; `reference`, N_v; `n`, `strain`, `seeds`;
    `energy_error`, `pressure_error`, `shape_error`; `error`, of the area deficits; `seconds`; the
    largest `residual` of the method; and `limit_error` of the reference.
    """
    rows = []
    for same in zip(*packings, strict=True):
        first = same[0]
        row = {key: first[key] for key in ("method", "vertices", "n", "strain", "reference")}
        row["seeds"] = [each["seed"] for each in same]
        row |= {name: _mean(same, key) for key, name in _MEANS.items()}
        known = [each["residual"] for each in same if each["residual"] is not None]
        row["residual"] = max(known, default=None)
        if first["method"] == "reference":
            row["limit_error"] = _mean(same, "limit_error")
        rows.append(row)
    return rows


def _mean(rows: Sequence[Row], key: str) -> float | None:
    """The mean; None if a row has none."""
    values = [row[key] for row in rows]
    return None if None in values else mean(values)


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


def accuracy_figure(rows: Sequence[Row], pareto: Sequence[Row]) -> Figure:
    """How wrong the energy of each law is at each strain, and how long each method takes.

    Left: a point for each packing, a line through their medians. Right: bars.
    """
    figure = Figure(figsize=(10.0, 4.4), layout="constrained")
    error, time = figure.subplots(1, 2, width_ratios=(3, 2))
    for law, style in STYLES.items():
        wrong = energy_errors(rows, law)
        if not wrong:
            continue
        x = [100.0 * strain for strain in wrong]
        middle = [np.median(each) for each in wrong.values()]
        error.plot(x, middle, linestyle=style.line, color=style.color, linewidth=1.2)
        for strain, each in zip(x, wrong.values(), strict=True):
            error.plot([strain] * len(each), each, style.marker, color=style.color, markersize=4.5)
        name = law if law != "sector" else "sector, at the polygons' centers"
        error.plot([], [], style.marker, color=style.color, linestyle=style.line, label=name)
    error.set(
        xlabel="strain beyond jamming [%]",
        ylabel="error of the energy",
        yscale="log",
    )
    for part in sorted(set(BARS.values())):
        error.axhline(part, color="0.6", linewidth=0.8, linestyle=":")
        error.text(0.02, part, f" {100 * part:g} %", fontsize=8, color="0.4", va="bottom")
    error.set_xlim(left=0.0)
    error.grid(alpha=0.3)

    timed = [row for row in pareto if row["seconds"] is not None]
    timed.sort(key=lambda row: row["seconds"])
    y = np.arange(len(timed))[::-1]
    seconds = [row["seconds"] for row in timed]
    bars = time.barh(y, seconds, color=[_style(row["method"]).color for row in timed])
    time.bar_label(bars, [f"{s:.2g} s" for s in seconds], padding=3, fontsize=8)
    time.set_yticks(y, [label(row) for row in timed], fontsize=8)
    time.set(
        xscale="log",
        xlabel=f"processor time, compressed by {100 * timed[0]['strain']:g} % [s]",
    )
    time.set_xlim(0.5 * min(seconds), 8.0 * max(seconds))
    legend_below(figure, error)
    return figure


def _style(method: str) -> Style:
    return SMOOTH if method == "reference" else (POLYGONS | STYLES)[method]


def pareto_figure(rows: Sequence[Row]) -> Figure:
    """Errors of energies and of areas against seconds, one point per law, polygons joined."""
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    panels = figure.subplots(1, 2, sharex=True)
    rows = [row | {"area_error": row["error"]} for row in rows]
    for ax, key in zip(panels, ("energy_error", "area_error"), strict=True):
        plot_errors(rows, ax, key)
        balanced = next(row for row in rows if row["method"] == "balanced")
        ax.axhline(balanced[key], color=STYLES["balanced"].color, linewidth=0.8, linestyle=":")
    legend_below(figure, panels[1])
    return figure


def compressions_figure(rows: Sequence[Row]) -> Figure:
    """The balanced law along compressions, a column for each packing, and all laws' centers.

    Steps at which the reference has not converged are left out.
    """
    rows = whole(rows)
    seeds = sorted({row["seed"] for row in rows})
    numbers = sorted({row["n_v"] for row in rows})
    figure = Figure(figsize=(max(3.4 * len(seeds), 6.0), 6.4), layout="constrained")
    panels = figure.subplots(3, len(seeds), sharex=True, sharey="row", squeeze=False)
    own = [row for row in rows if row["own"]]
    balanced = STYLES["balanced"]
    fills = dict(zip(numbers[::-1], (balanced.color, "white"), strict=False))
    for column, seed in zip(panels.T, seeds, strict=True):
        for ax, key in zip(column[:2], ("energy_ratio", "pressure_ratio"), strict=True):
            ax.axhline(1.0, color=SMOOTH.color, linewidth=1.0)
            for count in numbers:
                path = [
                    row
                    for row in own
                    if (row["law"], row["seed"], row["n_v"]) == ("balanced", seed, count)
                ]
                known = [row[key] is not None and row["residual"] <= CONVERGED for row in path]
                ax.plot(
                    [100.0 * row["strain"] for row in path],
                    [row[key] if there else np.nan for row, there in zip(path, known, strict=True)],
                    balanced.marker,
                    color=balanced.color,
                    markerfacecolor=fills.get(count, "0.7"),
                    linestyle="-",
                    linewidth=0.8,
                    markersize=8,
                )
            ax.set_ylim(0.985, 1.04)
            ax.grid(alpha=0.3)
        _allowed(column[0])
        these = [row for row in own if row["seed"] == seed]
        most = max(row["n_v"] for row in these)
        _distances(column[2], [row for row in these if row["n_v"] == most])
        column[0].set_title(f"packing {seed}", fontsize=10)
        column[2].set_xlabel("strain beyond jamming [%]")
    names = ("energy", "pressure")
    for ax, name in zip(panels[:2, 0], names, strict=True):
        ax.set_ylabel(f"{name}, balanced\nover smooth polygons")
    panels[2, 0].set_ylabel("distance of the centers\n(rms) over R")
    handles = [
        Line2D(
            *([], []),
            color=balanced.color,
            marker=balanced.marker,
            markerfacecolor=fills.get(count, "0.7"),
            markersize=8,
            label=f"balanced, against {count} vertices",
        )
        for count in numbers
    ]
    handles += [
        Line2D([], [], color=STYLES[law].color, marker=STYLES[law].marker, ls="-", label=law)
        for law in STYLES
        if law != "balanced" and any(row["law"] == law for row in own)
    ]
    handles.append(Line2D([], [], color="0.3", linestyle=":", label="mean overlap"))
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def _allowed(ax: Any) -> None:
    """The errors that are allowed, as a band."""
    low = 0.0
    for strain, part in BARS.items():
        ax.fill_between([100 * low, 100 * strain], 1 - part, 1 + part, color="0.9", linewidth=0)
        low = strain


def _distances(ax: Any, rows: Sequence[Row]) -> None:
    strains = np.array(sorted({row["strain"] for row in rows}))
    for law in dict.fromkeys(row["law"] for row in rows):
        style, path = STYLES[law], [row for row in rows if row["law"] == law]
        y = [np.nan if row["distance"] is None else row["distance"] for row in path]
        x = [100.0 * row["strain"] for row in path]
        ax.semilogy(x, y, style.marker, color=style.color, linestyle="-", lw=0.8, markersize=5)
    ax.plot(100.0 * strains, 2.0 * strains, ":", color="0.3")
    ax.grid(alpha=0.3)


def in_short_section(rows: Sequence[Row], pareto: Sequence[Row]) -> Section:
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


def pareto_section(rows: Sequence[Row]) -> Section:
    first = rows[0]
    return Section(
        "Error against run time",
        (
            f"Every method compresses the same packings of {first['n']} particles (seeds "
            f"{show(first['seeds'])}) from jamming to {percent(first['strain'])} strain, and "
            "relaxes on its own. "
            f"Errors are against smooth polygons of {first['reference']} vertices, energies "
            "extrapolated from there to very many; errors and times are means. That limit is "
            f"uncertain by {show(rows[-1]['limit_error'])}. Polygons of "
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


def compressions_section(rows: Sequence[Row]) -> Section:
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

"""The parts of the report: what each measurement shows, with its picture and its table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .. import paper_figures
from . import figures
from .page import Section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from . import Results


def sections(results: Results) -> tuple[dict[str, Figure], list[Section]]:
    """Pictures by file name, and the parts of the page that show them."""
    pictures = {
        "pareto.png": figures.pareto(results.pareto),
        "packing.png": paper_figures.packing(results.comparisons),
        "packings.png": figures.packings([*results.packing, *results.large]),
        "shapes_stick.png": paper_figures.shapes(results.shapes, stick=True),
        "shapes_slip.png": paper_figures.shapes(results.shapes, stick=False),
        "deviation.png": paper_figures.deviation(results.stiffness),
        "stiffness.png": paper_figures.error_by_indentation(results.stiffness),
        "number.png": paper_figures.error_by_number(results.number),
        "limit.png": paper_figures.limits(results.limits),
        "ablation.png": figures.ablation(results.ablation),
    }
    parts = [
        Section(
            "Error against run time",
            (
                _pareto_text(results.pareto),
                "The reference is what rings tend to for many beads, extrapolated in 1/N_v^2 from "
                "the two finest. Rings of every N_v stand for the same smooth particles (their "
                "effective radii and kP agree), start from the same jammed disks, and relax on "
                "their own, as every law does. Rough rings catch in each other, so the points of "
                "the beads scatter: this is the reference's own error. A disk keeps its area, "
                "which is an error of 1.",
            ),
            {"pareto.png": "Errors against processor time; numbers: beads on a small ring."},
            results.pareto,
        ),
        Section(
            "The speed-up",
            (_speed_up_text(results.large),),
            {"packing.png": "Beads (red) and the outlines of both laws for the beads' centres."},
            [_columns(row, _SPEED) for row in results.large],
        ),
        Section(
            "Packings",
            (
                "Laws are given the rings' centres and effective radii. I: mean distance of the "
                "outlines from the beads over the radius. S_rms: rms error of the area deficits "
                "over their rms. The ratios are those of a law's energy and pressure over the "
                "beads'; own: of the packing that the law relaxes to itself from the same start, "
                "which may rearrange on its way. Both laws put contact lines on the radical axis "
                "and keep perimeters, which is where most of their error in packings comes from. "
                "A particle with a single contact counts as a soft disk in the sector law, with an "
                "energy that has nothing to do with its area: it may dominate the sum.",
            ),
            {"packings.png": "Errors of each law in every packing."},
            [_columns(row, _PACKING) for row in results.packing],
        ),
        Section(
            "One particle in a polygon",
            (
                "Rings of beads between walls to which beads stick, the paper's setting, or along "
                "which they slip. The sector law is right where contacts stick, the ring law "
                "where they slip; in regular polygons they agree.",
            ),
            {
                "shapes_stick.png": "Walls that stick.",
                "shapes_slip.png": "Walls that slip; laws about the mean of the beads.",
                "deviation.png": "Distance of the beads from the law along the outline.",
                "stiffness.png": "I against the indentation and against kL.",
                "number.png": "I against the number of beads at fixed kP.",
            },
        ),
        Section(
            "The exact limit",
            (
                "S = K a^2 in regular polygons is the limit of many stiff beads. "
                + " ".join(
                    f"{limit.sides} sides: S errs with the power {limit.number_rate:.2f} of the "
                    f"number of beads and {limit.stiffness_rate:.2f} of kP."
                    for limit in results.limits
                )
                + " Expected are -2 and -1.",
            ),
            {"limit.png": "Relative error of the beads' area deficit; lines: expected."},
        ),
        Section(
            "Pay for what a scene uses",
            (
                "Processor time of a particle and a step, and what each option adds when it is "
                "asked for at every step. What is not asked for costs nothing: it is chosen at "
                "setup.",
            ),
            {"ablation.png": "Cost of a particle and a step."},
            results.ablation,
        ),
    ]
    return pictures, parts


_SPEED = ("n", "strain", "beads", "model", "I", "S_rms", "seconds_beads", "seconds", "speed_up")
_PACKING = (
    *("n", "strain", "beads", "seed", "model", "I", "S_rms", "energy_ratio", "pressure_ratio"),
    *("own_energy_ratio", "own_pressure_ratio", "seconds_beads", "seconds"),
)


def _columns(row: dict[str, Any], names: tuple[str, ...]) -> dict[str, Any]:
    return {name: row[name] for name in names}


def _pareto_text(rows: list[dict[str, Any]]) -> str:
    finest = rows[-1]
    laws = [row for row in rows if row["method"] not in ("beads", "disk")]
    return (
        f"{finest['n']} particles, {100 * finest['strain']:g} % strain in one step. "
        + " ".join(
            f"{row['method'].capitalize()}: areas to {row['error']:.2g}, outlines to "
            f"{row['shape_error']:.2g}, {row['seconds']:.2g} s."
            for row in laws
        )
        + (
            f" Rings of {finest['beads']} beads: {finest['error']:.2g}, "
            f"{finest['shape_error']:.2g}, {finest['seconds']:.3g} s."
        )
    )


def _speed_up_text(rows: list[dict[str, Any]]) -> str:
    first = rows[0]
    laws = ", ".join(
        f"{row['model']} {row['seconds']:.2g} s ({row['speed_up']:.0f} times faster)"
        for row in rows
    )
    return (
        f"{first['n']} particles, {first['beads']} beads on the small ones, "
        f"{100 * first['strain']:g} % strain in one step from jamming: beads "
        f"{first['seconds_beads']:.3g} s, {laws}. Beads relax until no force exceeds 1e-3 of what "
        "a bead in a contact bears, the laws until 1e-6 of the mean contact force. The sector law "
        "stalls before, because its energy jumps where contacts appear; its time is that of giving "
        "up."
    )

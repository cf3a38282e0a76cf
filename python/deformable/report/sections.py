"""The parts of the report: what each measurement shows, with its picture and its table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..studies import paper_figures
from . import figures
from .page import Section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from . import Results


def sections(results: Results) -> tuple[dict[str, Figure], list[Section]]:
    """Pictures by file name, and the parts of the page that show them."""
    pictures = {
        "pareto.png": figures.pareto(results.pareto),
        "packing.png": paper_figures.packing(results.large[1]),
        "packings.png": figures.packings([*results.packings, *results.large[0]]),
        "compressions.png": figures.compressions(results.compression),
        "catching.png": figures.catching(results.catching),
        "shapes_stick.png": paper_figures.shapes(results.shapes, stick=True),
        "shapes_slip.png": paper_figures.shapes(results.shapes, stick=False),
        "deviation.png": paper_figures.deviation(results.stiffness),
        "stiffness.png": paper_figures.error_by_indentation(results.stiffness),
        "any_stiffness.png": figures.any_stiffness(results.any_stiffness),
        "number.png": paper_figures.error_by_number(results.number),
        "limit.png": paper_figures.limits(results.limits),
        "ablation.png": figures.ablation(results.ablation),
    }
    parts = [
        Section(
            "Error against run time",
            (
                _pareto_text(results.pareto),
                "Rings of every N_v stand for the same smooth particles (their effective radii and "
                "kP agree), start from the same jammed disks, and relax on their own, as every law "
                "does. The reference is what they tend to for many beads, extrapolated in 1/N_v^2 "
                "from the two finest; the errors of these two (hollow) are what the extrapolation "
                "takes them to be. Rough rings catch in each other, so that the errors of the "
                "others hardly fall with N_v beyond some point: this is how well the reference "
                "itself is known. A disk keeps its area, which is an error of 1.",
            ),
            {"pareto.png": "Errors against processor time; numbers: beads on a small ring."},
            results.pareto,
        ),
        Section(
            "The speed-up",
            (_speed_up_text(results.large[0]),),
            {"packing.png": "Beads and the outlines of the laws for the beads' centers."},
            [_columns(row, _SPEED) for row in results.large[0]],
        ),
        Section(
            "Packings",
            (
                "Laws are given the rings' centers and effective radii. I: mean distance of the "
                "outlines from the beads over the radius. S_rms: rms error of the area deficits "
                "over their rms. The ratios are those of a law's energy and pressure over the "
                "beads'; own: of the packing that the law relaxes to itself from the same start, "
                "which may rearrange on its way, or lose its rigidity (unjammed: no ratios). The "
                "soft ring has the beads' stiffness of the perimeter, sector and ring keep it; "
                "all three put contact lines on the radical axis. Balanced is the soft ring with "
                "contact lines where both sides press with the same force. A particle with a "
                "single contact counts as a soft disk in the sector law, with an energy that has "
                "nothing to do with its area: it may dominate the sum. Sector does not converge "
                "(residual: of its own relaxation). Packings are farmed over the cores, which "
                "their times may show.",
            ),
            {"packings.png": "Errors of each law, a point for each packing."},
            [_columns(row, _PACKING) for row in results.packings],
        ),
        *_compressions(results),
        Section(
            "Mixtures of unequal stiffness",
            (
                "The same for particles whose species differ in stiffness: kA and kP are those of "
                "the small and of the large rings of beads, kP_law what a law has in the place of "
                "kP. No spring is rigid: a kP of 10 kA R^2 stands for an infinite one, which the "
                "last law has there; it is off by what these springs give way, of the order of "
                "kA q^2/kP in the area deficits, and balanced is not. The sector law has a single "
                "kA. Rings relax to 3e-3 of what a bead in a contact bears.",
            ),
            {},
            [_columns(row, _MIXTURE) for row in results.mixtures],
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
            "Particles of any stiffness",
            (
                "One ring in a hexagon along whose walls it slips. The ring law of finite "
                "stiffness, with kP = kL/N_v and the beads as its skin, has the shape at every kL; "
                "the one that keeps its perimeter is its limit.",
            ),
            {"any_stiffness.png": "I against kL, a line for each indentation."},
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
            "Stability",
            (
                "What was varied, for which law, and how far a measured quantity stays within its "
                "limit: rounding, the tolerance of a relaxation, or a bound. "
                + _failures_text(results.stability),
            ),
            table=results.stability,
        ),
        Section(
            "Pay for what a scene uses",
            (
                "Processor time of a particle and a step, and what each option adds when it is "
                "asked for at every step. The first row of each law is the bare scene.",
            ),
            {"ablation.png": "Cost of a particle and a step."},
            results.ablation,
        ),
    ]
    return pictures, parts


def _compressions(results: Results) -> list[Section]:
    return [
        Section(
            "Whole compressions",
            (
                "Beads and laws start from the same jammed disks and are compressed side by side, "
                "each relaxed on its own after each step. The ratios are a law's own energy and "
                "pressure over the beads'; energy_ratio_at_centers is that of the law at the "
                "beads' centers. centers_rms: rms distance of the centers over the mean radius, "
                "of particles that are rattlers in neither, a common drift taken out. Law and "
                "beads count as on the same branch while that is no more than twice the strain, "
                "the mean overlap of two particles: who is moved by more loses contacts or finds "
                "others. Where a law's packing comes loose, and caught rings do not, the ratios "
                "are next to 0 and the centers have no distance. S_rms: rms difference of the "
                "area deficits over the beads' rms. "
                "net_force: the largest force on a ring as a whole over the mean contact force, "
                "which for the laws is below 1e-6.",
                _compression_text(results.compression),
            ),
            {
                "compressions.png": "Laws over beads along compressions, a line a packing; hollow: "
                "on different branches."
            },
            [_columns(row, _COMPRESSION) for row in results.compression],
        ),
        Section(
            "Where rings of beads come to rest",
            (
                "Rings of more and more beads that stand for the same smooth particles, relaxed "
                "at one strain: strained from jamming, and placed along the outlines of the "
                "balanced law where that has come to rest. The ratio is the law's energy over "
                "theirs.",
                _catching_text(results.catching),
                "A bead in a contact bears little, and the forces on the many beads of a ring add "
                "up: relaxed to 1e-2 of what a bead bears, a ring as a whole still is pushed by a "
                "good part of a contact force, and the energy is far too high (right). Relaxed "
                "further, rings that begin at the law's packing stay there, the nearer the more "
                "beads they have (left). Strained ones come to rest before they get there, at "
                "other centers and mostly at a higher energy: rough rings catch in each other. "
                "How many beads they have matters little for that. From there smooth particles "
                "slide on: slide_rms is the rms distance over R between where the law relaxes to "
                "from the rings' centers and where it is by itself, none if it comes loose on the "
                "way.",
            ),
            {
                "catching.png": "Left: relaxed to 1e-3, by number of beads. Right: while they "
                "relax. Hollow: rings on another branch than the law."
            },
            [_columns(row, _CATCHING) for row in results.catching],
        ),
    ]


def _compression_text(rows: list[dict[str, Any]]) -> str:
    together = [row for row in rows if row["same_branch"]]
    return f"{rows[0]['n']} particles of {rows[0]['beads']} beads (the small ones). " + " ".join(
        f"{law.capitalize()}: on the same branch in {len(these)} of "
        f"{sum(row['law'] == law for row in rows)} steps"
        + (f", there energies of {_range(these)} of the beads'." if these else ".")
        for law in dict.fromkeys(row["law"] for row in rows)
        for these in [[row for row in together if row["law"] == law]]
    )


def _catching_text(rows: list[dict[str, Any]]) -> str:
    last = min(row["tolerance"] for row in rows)
    return " ".join(
        f"{number} beads: {_range(these['strained'])} strained, {_range(these['placed'])} placed."
        for number in dict.fromkeys(row["beads"] for row in rows)
        for these in [
            {
                start: [
                    row
                    for row in rows
                    if (row["beads"], row["start"], row["tolerance"]) == (number, start, last)
                ]
                for start in ("strained", "placed")
            }
        ]
    )


def _range(rows: list[dict[str, Any]]) -> str:
    ratios = [row["energy_ratio"] for row in rows if row["energy_ratio"] is not None]
    low, high = f"{min(ratios):.2f}", f"{max(ratios):.2f}"
    return low if low == high else f"{low} to {high}"


_SPEED = ("n", "strain", "beads", "law", "I", "S_rms", "seconds_beads", "seconds", "residual")
_PACKING = (
    *("n", "strain", "beads", "seed", "law", "I", "S_rms", "energy_ratio", "pressure_ratio"),
    *("own_energy_ratio", "own_pressure_ratio", "unjammed", "residual"),
    *("seconds_beads", "seconds"),
)
_COMPRESSION = (
    *("n", "seed", "beads", "strain", "law", "energy_ratio", "pressure_ratio"),
    *("energy_ratio_at_centers", "centers_rms", "S_rms", "same_branch", "net_force"),
    *("seconds_beads", "seconds"),
)
_CATCHING = (
    *("seed", "beads", "start", "tolerance", "net_force", "energy_ratio"),
    *("energy_ratio_at_centers", "centers_rms", "same_branch", "slide_rms", "seconds_beads"),
)
_MIXTURE = ("n", "strain", "beads", "kA", "kP", "seed", "law", "kP_law", *_PACKING[5:])


def _columns(row: dict[str, Any], names: tuple[str, ...]) -> dict[str, Any]:
    return {name: row[name] for name in names}


def _pareto_text(rows: list[dict[str, Any]]) -> str:
    first = rows[0]
    laws = [row for row in rows if row["method"] not in ("beads", "disk")]
    free = [row for row in rows if row["method"] == "beads" and not row["reference"]]
    return (
        f"{first['n']} particles, {100 * first['strain']:g} % strain in one step, means over "
        f"{len(first['seeds'])} packings. "
        + " ".join(
            f"{row['method'].capitalize()}: areas to {row['error']:.2g}, outlines to "
            f"{row['shape_error']:.2g}, {row['seconds']:.2g} s" + _unless_converged(row) + "."
            for row in laws
        )
        + "".join(
            f" {row['beads']} beads: {row['error']:.2g}, {row['shape_error']:.2g}, "
            f"{row['seconds']:.3g} s."
            for row in free
        )
    )


def _speed_up_text(rows: list[dict[str, Any]]) -> str:
    first = rows[0]
    laws = ", ".join(
        f"{row['law']} {row['seconds']:.2g} s"
        + (_unless_converged(row) or f" ({first['seconds_beads'] / row['seconds']:.0f} times less)")
        for row in rows
    )
    return (
        f"{first['n']} particles, {first['beads']} beads on the small ones, "
        f"{100 * first['strain']:g} % strain in one step from jamming: beads "
        f"{first['seconds_beads']:.3g} s, {laws}. Beads relax until no force exceeds 1e-3 of what "
        "a bead in a contact bears, the laws until 1e-6 of the mean contact force. The energy of "
        "the sector law jumps where contacts appear: it may stop before."
    )


def _failures_text(rows: list[dict[str, Any]]) -> str:
    missed = [row for row in rows if not row["ok"]]
    sector = sum(row["parameter"] == "sector" for row in missed)
    return (
        f"{len(rows) - len(missed)} of {len(rows)} do. Of the {len(missed)} others {sector} are "
        "of the sector law, for the reason beside them."
    )


def _unless_converged(row: dict[str, Any]) -> str:
    converged = row.get("residual") is None or row["residual"] <= figures.CONVERGED
    return "" if converged else f" (not converged, residual {row['residual']:.2g})"

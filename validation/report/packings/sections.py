"""Sections on packings: the paper's one of bead polygons, and mixtures of unequal stiffness."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING, Any

from lammps_deformable.relax import TOLERANCE

from validation.report import section as c
from validation.report.law_styles import STYLES
from validation.report.section import Column, Picture, Section, Table, listed, percent, show, span

if TYPE_CHECKING:
    from collections.abc import Sequence

Row = dict[str, Any]


def large(rows: Sequence[Row]) -> Section:
    first = rows[0]
    laws = [row for row in rows if row["law"] != "disk" and _converged(row)]
    faster = listed(
        f"`{row['law']}` {first['seconds_polygons'] / row['seconds']:.0f} times faster "
        f"({show(row['seconds'])} s)"
        for row in laws
    )
    return Section(
        "The packing of the paper",
        (
            f"{first['n']} bead polygons, {first['n_v']} beads on the small ones, are strained "
            f"by {percent(first['strain'])} in one step from jamming. The laws are compared at "
            "their centers. Few beads are rough, which limits the comparison. The polygons relax "
            f"in {show(first['seconds_polygons'], 3)} s, until no force on a bead exceeds 10⁻³ of "
            "the force on a bead in a contact. The laws relax until no force exceeds "
            f"{show(TOLERANCE, 1)} of the mean contact force: {faster}." + _stalled(rows),
        ),
        pictures=[
            Picture(
                "packing.png",
                "Left: the packing. Right: the part in the frame, where each law is drawn with its "
                "distance from the beads magnified by the factor above it. Deviations are largest "
                "at contacts.",
                "Circles of beads in a periodic box, and an enlarged part with the outlines of "
                "three laws around the beads.",
            )
        ],
        tables=[
            Table(
                "The laws in this packing",
                [c.LAW, c.SHAPE, c.AREA, c.ENERGY, c.PRESSURE, c.SECONDS, c.RESIDUAL],
                rows,
            )
        ],
    )


_RATIOS = ("I", "S_rms", "energy_ratio", "pressure_ratio", "own_energy_ratio")


def mixtures(rows: Sequence[Row]) -> Section:
    best, laws = _by_error(rows)
    energies, own = (
        span((row[key] for row in rows if row["law"] == best), 3)
        for key in ("energy_ratio", "own_energy_ratio")
    )
    return Section(
        "Mixtures of unequal stiffness",
        (
            "The same comparison for particles whose two species differ in the stiffness of the "
            "area (kA) or of the perimeter (kP). A contact line then moves into the softer "
            "particle. The polygons are smooth; errors are at their centers, and the own energy is "
            "that of the law relaxed alone.",
            "Medians of the area error are "
            + listed(f"{show(laws[law])} (`{law}`)" for law in laws)
            + ". "
            f"The most accurate law, `{best}`, has energies of {energies} of the polygons', and "
            f"{own} if it relaxes alone.",
            "No spring is rigid: polygons have kP = 10 kA R² where kP is to be infinite. The law "
            "`balanced, kP inf` has the infinite value there, and is off by about kA q²/kP in the "
            "area deficits, q being the radius of the free arcs. The sector law has a single kA "
            "and takes part where the species agree in it.",
        ),
        tables=[
            Table(
                "Ranges over the packings of each mixture; small | large particles",
                [
                    Column("kA", "kA", "area stiffness of the polygons", show=c.stiffness),
                    Column("kP", "kP", "perimeter stiffness of the polygons", show=c.stiffness),
                    Column("packings", "packings"),
                    *(c.LAW, c.SHAPE, c.AREA, c.ENERGY, c.OWN_ENERGY),
                ],
                c.grouped(rows, ("kA", "kP", "law"), _RATIOS),
            )
        ],
    )


def _by_error(rows: Sequence[Row]) -> tuple[str, dict[str, float]]:
    """The law with the least median area error, and the medians of all laws but disks."""
    medians = {}
    for law in STYLES:
        found = [row["S_rms"] for row in rows if row["law"] == law and row["S_rms"] is not None]
        if found and law != "disk":
            medians[law] = median(found)
    return min(medians, key=medians.__getitem__), medians


def _converged(row: Row) -> bool:
    return row.get("residual") is None or bool(row["residual"] <= TOLERANCE)


def _stalled(rows: Sequence[Row]) -> str:
    """A sentence on laws that did not converge, if there are any."""
    names = [row.get("law", row.get("method")) for row in rows if not _converged(row)]
    if not names:
        return ""
    return (
        f" The energy of the {listed(f'`{name}`' for name in names)} law jumps where contacts "
        "appear, so that its relaxation does not converge; its time is that until it stopped."
    )

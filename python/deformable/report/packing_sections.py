"""Sections on packings: error against time, laws at the beads' centers, compressions, mixtures."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median
from typing import Any

from ..engine.relaxation import TOLERANCE
from ..studies.law_styles import STYLES
from . import columns as c
from .numbers import listed, percent, show, span
from .page import Column, Picture, Section, Table

Row = dict[str, Any]


def pareto(rows: Sequence[Row]) -> Section:
    first = rows[0]
    laws = [row for row in rows if row["method"] not in ("beads", "disk")]
    beads = [row for row in rows if row["method"] == "beads"]
    free = [row for row in beads if not row["reference"]]
    reference = [str(row["beads"]) for row in beads if row["reference"]]
    return Section(
        "Error against run time",
        (
            f"Every method relaxes the same {_packings(len(first['seeds']))} of {first['n']} "
            f"particles on its own after one strain step of {percent(first['strain'])} from "
            "jamming; errors and times are means. Rings of different numbers of beads stand for "
            "the same smooth particles: their effective radii and the stiffness of their "
            "perimeters agree.",
            _best_law([row for row in laws if _converged(row)], free)
            + "A disk keeps its area, which is an error of 1."
            + _stalled(laws),
            f"The reference is the limit of many beads, extrapolated in 1/N² from rings of "
            f"{listed(reference)} beads (hollow points: their own errors follow from the "
            "extrapolation). Rings of beads are rough and have friction, so that they come to rest "
            "short of the smooth minimum. This limits how well the reference is known.",
        ),
        pictures=[
            Picture(
                "pareto.png",
                "Lower left is better: more accurate and faster. Numbers: beads on a small ring. "
                "Hollow: not converged, or part of the reference.",
                "Two logarithmic scatter plots of area error and shape error against processor "
                "time, a marker for each law and a falling line for rings of beads.",
            )
        ],
        tables=[
            Table(
                "Errors and times of all methods, means over the packings",
                [
                    Column("method", "method", text=True),
                    c.BEADS,
                    Column("error", "area error", "rms error of the area deficits over their rms"),
                    Column(
                        "shape_error", "shape error", "mean error of the outline over the radius"
                    ),
                    Column("seconds", "time", "processor time of the strain step", "s"),
                    c.RESIDUAL,
                ],
                rows,
            )
        ],
    )


def _best_law(laws: Sequence[Row], beads: Sequence[Row]) -> str:
    """The most accurate of the laws, and the rings of beads that are as accurate."""
    if not laws:
        return "No law converges. "
    best = min(laws, key=lambda row: row["error"])
    as_good = [row for row in beads if row["error"] <= best["error"]]
    against = min(as_good, key=lambda row: row["seconds"]) if as_good else beads[-1]
    return (
        f"The most accurate law that converges is `{best['method']}`: its areas are right to "
        f"{show(best['error'])} in {show(best['seconds'])} s. "
        + (
            f"The fastest rings of at least this accuracy have {against['beads']} beads"
            if as_good
            else "No rings beside the reference are that accurate; those of "
            f"{against['beads']} beads have an error of {show(against['error'])}"
        )
        + f" and take {show(against['seconds'])} s, {against['seconds'] / best['seconds']:.0f} "
        "times as long. "
    )


def large(rows: Sequence[Row]) -> Section:
    first = rows[0]
    laws = [row for row in rows if row["law"] != "disk" and _converged(row)]
    faster = listed(
        f"`{row['law']}` {first['seconds_beads'] / row['seconds']:.0f} times faster "
        f"({show(row['seconds'])} s)"
        for row in laws
    )
    return Section(
        "A larger packing",
        (
            f"{first['n']} particles, {first['beads']} beads on the small ones, are strained by "
            f"{percent(first['strain'])} in one step from jamming. The rings of beads relax in "
            f"{show(first['seconds_beads'], 3)} s, until no force on a bead exceeds 10⁻³ of the "
            "force on a bead in a contact. The laws relax until no force exceeds "
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


def packings(rows: Sequence[Row], small: Sequence[Row]) -> Section:
    best, laws = _by_error(small)
    relaxed = [row for row in small if row["law"] != "disk"]
    unjammed = sum(row["unjammed"] for row in relaxed)
    return Section(
        "Packings at the beads' centers",
        (
            "Each law gets the centers and the effective radii of relaxed rings of beads, so that "
            "only the law itself differs. The shape error compares outlines with beads, the area "
            "error compares area deficits.",
            "Medians of the area error are "
            + listed(f"{show(laws[law])} (`{law}`)" for law in laws)
            + ". "
            f"So `{best}` is the most accurate law here. The laws `radical` and `balanced` differ "
            "only in the place of the contact lines, `radical` and `radical, kP inf` only in the "
            "stiffness of the perimeter.",
            "The own energy is that of the packing to which the law itself relaxes from the same "
            "start. It differs more, because a packing may rearrange on its way. "
            + (
                f"In {unjammed} of {len(relaxed)} cases the packing lost its rigidity, and there "
                "is no own energy. "
                if unjammed
                else ""
            )
            + "In the sector law a particle with a single contact counts as a soft disk; its "
            "energy has nothing to do with its area and may dominate the sum.",
        ),
        pictures=[
            Picture(
                "packings.png",
                "Errors of each law, one point for each packing. Lower is better.",
                "Two plots with logarithmic axes: shape errors and area errors of the laws in "
                "groups of packings of equal size, beads and strain.",
            )
        ],
        tables=[
            Table(
                "Ranges over the packings of each kind",
                [
                    c.PARTICLES,
                    c.BEADS,
                    c.STRAIN,
                    Column("packings", "packings"),
                    *(c.LAW, c.SHAPE, c.AREA, c.ENERGY, c.OWN_ENERGY),
                ],
                c.grouped(rows, ("n", "beads", "strain", "law"), _RATIOS),
            ),
            Table(
                f"All {len(rows)} rows",
                [
                    *(c.PARTICLES, c.BEADS, c.STRAIN, c.SEED, c.LAW, c.SHAPE, c.AREA, c.ENERGY),
                    *(c.PRESSURE, c.SECONDS, c.SECONDS_BEADS),
                ],
                rows,
                folded=True,
            ),
        ],
    )


def compressions(rows: Sequence[Row]) -> Section:
    laws = list(dict.fromkeys(row["law"] for row in rows))
    sentences = []
    for law in laws:
        steps = [row for row in rows if row["law"] == law]
        together = [row["energy_ratio"] for row in steps if row["same_branch"]]
        sentence = f"`{law}` is on the branch of the beads in {len(together)} of {len(steps)} steps"
        if together:
            sentence += f", with {span(together)} times their energy"
        sentences.append(sentence)
    at_centers = {
        law: span(row["energy_ratio_at_centers"] for row in rows if row["law"] == law)
        for law in laws
    }
    return Section(
        "Whole compressions",
        (
            f"Beads and laws start from the same jammed disks, {rows[0]['n']} particles with "
            f"{rows[0]['beads']} beads on the small ones. Both are compressed in the same steps, "
            "and each relaxes on its own. Law and beads are on the same branch while their centers "
            "are no further apart than particles overlap (rms distance at most twice the strain "
            "times R). A particle that moves by more loses contacts or gains others.",
            "In numbers: " + "; ".join(sentences) + ".",
            "At the beads' own centers, where a rearrangement cannot matter, energies over those "
            "of the beads are "
            + listed(f"{at_centers[law]} (`{law}`)" for law in laws)
            + ". Other differences come from rearrangements: law and beads may rearrange at "
            "different strains. Rough rings also have friction. Where the packing of a law loses "
            "its rigidity, its energy is 0 and its centers have no distance.",
        ),
        pictures=[
            Picture(
                "compressions.png",
                "Each column is a packing. Top: energies, 1 is that of the beads. Bottom: below "
                "the dotted line, the mean overlap, law and beads are on the same branch. Hollow: "
                "on different branches.",
                "Lines of energy ratios and of distances of centers against strain, for each "
                "packing and ring law.",
            )
        ],
        tables=[
            Table(
                f"All {len(rows)} steps",
                [
                    *(c.SEED, c.STRAIN, c.LAW),
                    Column("energy_ratio", "energy", "of the law over that of the beads"),
                    Column(
                        "energy_ratio_at_centers",
                        "energy at beads' centers",
                        "of the law at the beads' centers over that of the beads",
                    ),
                    Column("centers_rms", "distance of centers", "rms, over the mean radius"),
                    Column("same_branch", "same branch"),
                    Column(
                        "net_force",
                        "net force",
                        "largest total force on a ring of beads over the mean contact force",
                    ),
                ],
                rows,
                folded=True,
            )
        ],
    )


def mixtures(rows: Sequence[Row]) -> Section:
    best, laws = _by_error(rows)
    energies = span(row["energy_ratio"] for row in rows if row["law"] == best)
    return Section(
        "Mixtures of unequal stiffness",
        (
            "The same comparison for particles whose two species differ in the stiffness of the "
            "area (kA) or of the perimeter (kP). A contact line then moves into the softer "
            "particle.",
            "Medians of the area error are "
            + listed(f"{show(laws[law])} (`{law}`)" for law in laws)
            + ". "
            f"The most accurate law, `{best}`, has energies of {energies} of the beads'.",
            "No spring is rigid: rings have kP = 10 kA R² where kP is to be infinite. The law "
            "`balanced, kP inf` has the infinite value there, and is off by about kA q²/kP in the "
            "area deficits, q being the radius of the free arcs. The sector law has a single kA "
            "and takes part where the species agree in it. Rings relax until no force exceeds 3 × "
            "10⁻³ of the force on a bead in a contact.",
        ),
        tables=[
            Table(
                "Ranges over the packings of each mixture; small | large particles",
                [
                    Column("kA", "kA", "area stiffness of the rings", show=c.stiffness),
                    Column("kP", "kP", "perimeter stiffness of the rings", show=c.stiffness),
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


def _packings(count: int) -> str:
    return "packing" if count == 1 else f"{count} packings"

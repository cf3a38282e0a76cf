"""The sections of the page in their order, and their pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.report import cost
from validation.report.accuracy import figures as accuracy_figures
from validation.report.accuracy import sections as accuracy
from validation.report.packings import sections as packings
from validation.report.packings.figure import packing
from validation.report.paper import figures as paper_figures
from validation.report.paper import sections as paper
from validation.report.roughness import section as roughness_section
from validation.report.roughness.figure import roughness
from validation.report.section import Section
from validation.report.stability import section as stability

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from validation.report.results import Results

_TERMS = Section(
    "What is compared",
    (
        "Particles in two dimensions that touch and deform. The reference are smooth polygons: "
        "springs join the vertices of a polygon, each polygon resists a change of its area, and "
        "vertices slide along the edges of other polygons. The contact laws replace each polygon "
        "by one point: its outline follows from the contacts.",
    ),
    terms={
        "smooth polygons": "polygons whose vertices touch the edges of others; the reference",
        "bead polygons": "polygons of beads, as in the paper: beads touch beads and interlock, "
        "so that polygons have friction",
        "disk": "soft disks that overlap and keep their shape; shown for comparison",
        "sector": "contacts stick: the arc between two contacts keeps its length",
        "radical": "ring law, contacts slip: contact lines on the radical axis, through the points "
        "where the undeformed circles cross",
        "balanced": "ring law, contacts slip: contact lines where the forces of both sides "
        "are equal; the default",
        "curved": "ring law, contacts slip: the exact law, whose contact lines tilt and bend until "
        "torques and pressures of both sides are balanced too",
        "ring": "the ring law of a particle between walls, where contact lines are given",
        "kP inf": "the same law with the perimeter conserved; without it the perimeter has the "
        "stiffness kP of the springs",
        "kA, kL": "stiffness of the area of a polygon, and of the springs between its N vertices; "
        "kP = kL/N",
        "shape error I": "mean distance of the outline from the polygons, over the radius",
        "area error": "rms error of the area deficits over their rms; 1 for particles that keep "
        "their area",
        "energy, pressure": "of the law over that of the polygons; 1 is right",
        "residual": "largest force over that in contacts: what is left after a relaxation",
        "jamming": "the onset of rigidity, from which strains count",
    },
)


def pictures(results: Results) -> dict[str, Figure]:
    """The pictures of the page by file name."""
    rows = results.rows()
    compared = {
        law: each
        for law, each in results.large[1].items()
        if law in ("sector", "radical", "balanced")  # others lie on top of these
    }
    return {
        "accuracy.png": accuracy_figures.accuracy(rows["smooth"], rows["pareto"]),
        "pareto.png": accuracy_figures.pareto(rows["pareto"]),
        "compressions.png": accuracy_figures.compressions(rows["smooth"]),
        "roughness.png": roughness(rows["friction"], rows["hysteresis"], rows["crystal"]),
        "packing.png": packing(compared),
        "shapes_stick.png": paper_figures.shapes(results.shapes, stick=True),
        "shapes_slip.png": paper_figures.shapes(results.shapes, stick=False),
        "deviation.png": paper_figures.deviation(results.stiffness),
        "stiffness.png": paper_figures.error_by_indentation(results.stiffness),
        "limit.png": paper_figures.limits(results.limits),
        "cost.png": cost.figure(rows["ablation"]),
    }


def sections(results: Results) -> list[Section]:
    """The sections of the page."""
    rows = results.rows()
    single, shapes = rows["single"], len(results.shapes)
    return [
        _TERMS,
        accuracy.in_short(rows["smooth"], rows["pareto"]),
        accuracy.pareto(rows["pareto"]),
        accuracy.compressions(rows["smooth"]),
        roughness_section.roughness(rows["friction"], rows["hysteresis"], rows["crystal"]),
        packings.large(results.large[0]),
        packings.mixtures(rows["stiffness_packing"]),
        paper.polygons(single[:shapes]),
        paper.stiffness(single[shapes:]),
        paper.limits(rows["limit"]),
        stability.section(rows["stability"]),
        cost.section(rows["ablation"]),
    ]

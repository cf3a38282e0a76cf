"""The sections of the page in their order, and their pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..studies import paper_figures
from ..studies.packing_figure import packing
from . import code_sections, figures, packing_sections, ring_sections, single_sections
from .page import Section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .results import Results

_TERMS = Section(
    "What is compared",
    (
        "Particles in two dimensions that touch and deform. The reference are smooth rings: "
        "springs join the vertices of a ring, each ring resists a change of its area, and vertices "
        "slide along the edges of other rings. The contact laws replace each ring by one point: "
        "its outline follows from the contacts.",
    ),
    terms={
        "smooth rings": "rings whose vertices touch the edges of others; the reference",
        "rough rings": "rings of beads, as in the paper: beads touch beads and interlock, so that "
        "rings have friction",
        "disk": "soft disks that overlap and keep their shape; shown for comparison",
        "sector": "contacts stick: the arc between two contacts keeps its length",
        "radical": "ring law, contacts slip: contact lines on the radical axis, through the points "
        "where the undeformed circles cross",
        "balanced": "ring law, contacts slip: contact lines where the forces of both sides "
        "are equal; the default",
        "tilted": "as balanced, and the lines turn until the torques of both sides are equal",
        "ring": "the ring law of a particle between walls, where contact lines are given",
        "kP inf": "the same law with the perimeter conserved; without it the perimeter has the "
        "stiffness kP of the springs",
        "kA, kL": "stiffness of the area of a ring, and of the springs between its N vertices; "
        "kP = kL/N",
        "shape error I": "mean distance of the outline from the rings, over the radius",
        "area error": "rms error of the area deficits over their rms; 1 for particles that keep "
        "their area",
        "energy, pressure": "of the law over that of the rings; 1 is right",
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
        "accuracy.png": figures.accuracy(rows["smooth"], rows["pareto"]),
        "pareto.png": figures.pareto(rows["pareto"]),
        "compressions.png": figures.compressions(rows["smooth"]),
        "roughness.png": figures.roughness(rows["friction"], rows["hysteresis"], rows["crystal"]),
        "packing.png": packing(compared),
        "shapes_stick.png": paper_figures.shapes(results.shapes, stick=True),
        "shapes_slip.png": paper_figures.shapes(results.shapes, stick=False),
        "deviation.png": paper_figures.deviation(results.stiffness),
        "stiffness.png": paper_figures.error_by_indentation(results.stiffness),
        "limit.png": paper_figures.limits(results.limits),
        "cost.png": figures.cost(rows["ablation"]),
    }


def sections(results: Results) -> list[Section]:
    """The sections of the page."""
    rows = results.rows()
    single, shapes = rows["single"], len(results.shapes)
    return [
        _TERMS,
        ring_sections.in_short(rows["smooth"], rows["pareto"]),
        ring_sections.pareto(rows["pareto"]),
        ring_sections.compressions(rows["smooth"]),
        ring_sections.roughness(rows["friction"], rows["hysteresis"], rows["crystal"]),
        packing_sections.large(results.large[0]),
        packing_sections.mixtures(rows["stiffness_packing"]),
        single_sections.polygons(single[:shapes]),
        single_sections.stiffness(single[shapes:]),
        single_sections.limits(rows["limit"]),
        code_sections.stability(rows["stability"]),
        code_sections.cost(rows["ablation"]),
    ]

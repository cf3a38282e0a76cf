"""The sections of the page in their order, and their pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..studies import paper_figures
from ..studies.packing_figure import packing
from . import code_sections, figures, packing_sections, single_sections
from .page import Section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .results import Results

_TERMS = Section(
    "What is compared",
    (
        "Particles in two dimensions that touch and deform. The reference are rings of beads: "
        "springs join the beads, and each ring resists a change of its area. The contact laws "
        "replace each ring by one point: its outline follows from the contacts.",
    ),
    terms={
        "beads": "rings of beads, the reference (the deformable-polygon model)",
        "disk": "soft disks that overlap and keep their shape; shown for comparison",
        "sector": "contacts stick: the arc between two contacts keeps its length",
        "radical": "ring law, contacts slip: contact lines on the radical axis, through the points "
        "where the undeformed circles cross",
        "balanced": "ring law, contacts slip: contact lines where the forces of both sides "
        "are equal; the default",
        "ring": "the ring law of a particle between walls, where contact lines are given",
        "kP inf": "the same law with the perimeter conserved; without it the perimeter has the "
        "stiffness kP of the springs",
        "kA, kL": "stiffness of the area of a ring, and of the springs between its N beads; "
        "kP = kL/N",
        "shape error I": "mean distance of the outline from the beads, over the radius",
        "area error": "rms error of the area deficits over their rms; 1 for particles that keep "
        "their area",
        "energy, pressure": "of the law over that of the beads; 1 is right",
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
        "pareto.png": figures.pareto(rows["pareto"]),
        "packing.png": packing(compared),
        "packings.png": figures.packings(rows["packing"]),
        "compressions.png": figures.compressions(rows["compression"]),
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
        packing_sections.pareto(rows["pareto"]),
        packing_sections.large(results.large[0]),
        packing_sections.packings(
            rows["packing"], [row for these, _ in results.packings for row in these]
        ),
        packing_sections.compressions(rows["compression"]),
        packing_sections.mixtures(rows["stiffness_packing"]),
        single_sections.polygons(single[:shapes]),
        single_sections.stiffness(single[shapes:]),
        single_sections.limits(rows["limit"]),
        code_sections.stability(rows["stability"]),
        code_sections.cost(rows["ablation"]),
    ]

"""The report as a page in Markdown, from report.json: the site shows it, docs/site/report.py."""

from __future__ import annotations

import html
import re
from collections.abc import Mapping
from typing import Any

import pandas

from validation.report import accuracy, cost, packings, paper, roughness, stability
from validation.report.section import Section, Table

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


def sections(report: Mapping[str, Any]) -> list[Section]:
    """The sections of the page, from report.json."""
    beads = report["single"][0]["n_v"]  # the stiffness of the perimeter is that of other rings
    shapes, stiffness = (
        [row for row in report["single"] if (row["n_v"] == beads) == kind] for kind in (True, False)
    )
    smooth, pareto = report["smooth"], report["pareto"]
    return [
        _TERMS,
        accuracy.in_short_section(smooth, pareto),
        accuracy.pareto_section(pareto),
        accuracy.compressions_section(smooth),
        roughness.section(report["friction"], report["hysteresis"], report["crystal"]),
        packings.large(report["packing"]),
        packings.mixtures(report["stiffness_packing"]),
        paper.polygons_section(shapes),
        paper.stiffness_section(stiffness),
        paper.limits_section(report["limit"]),
        stability.section(report["stability"]),
        cost.section(report["ablation"]),
    ]


def page(report: Mapping[str, Any]) -> str:
    """The page. Text is Markdown, tables are HTML from pandas."""
    quick = " --quick" if report["quick"] else ""
    made, lammps = report["machine"], report["versions"]["lammps"]
    parts = [
        "# Contact laws against smooth polygons",
        f"Measured by `python -m validation.report{quick}` on {made['cores']} cores "
        f"({made['processor']}) with LAMMPS {lammps}. All seconds are seconds of processor time. "
        "The rows of all tables are in [report.json](report.json).",
    ]
    for section in sections(report):
        anchor = re.sub(r"[^a-z]+", "-", section.title.lower()).strip("-")
        parts += [f"## {section.title} {{#{anchor}}}", *section.text]
        if section.terms:
            parts.append("\n".join(f"* **{term}**: {what}" for term, what in section.terms.items()))
        for picture in section.pictures:
            parts += [f"![{picture.alt}]({picture.file})", f"*{picture.caption}*"]
        parts += [_table(table) for table in section.tables]
    return "\n\n".join(parts) + "\n"


def _table(table: Table) -> str:
    """A table with its caption; a folded one opens on a click on it."""
    columns = {
        column.head + (f" [{column.unit}]" if column.unit else ""): [
            column.show(row.get(column.key)) for row in table.rows
        ]
        for column in table.columns
    }
    text = pandas.DataFrame(columns).to_html(index=False, border=0, justify="left")
    notes = "; ".join(f"{column.head}: {column.note}" for column in table.columns if column.note)
    text += f"\n<small>{html.escape(notes)}</small>" if notes else ""
    caption = html.escape(table.caption)
    if table.folded:
        return f"<details><summary>{caption}</summary>\n{text}\n</details>"
    return f"**{caption}**\n\n{text}"

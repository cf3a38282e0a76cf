"""Errors of methods against their processor times, and how each is drawn in all figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..common.errors import ParameterError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_QUANTITIES = {
    "energy_error": "error of the energy",
    "pressure_error": "error of the pressure",
    "area_error": "error of area deficits, or of surfaces (rms)",
    "shape_error": "error of the outline over the radius",
}

# One color, marker and line for each contact law in all figures, in the order of the legends.


@dataclass(frozen=True)
class Style:
    """Color, marker and line of one law; laws differ in each of the three."""

    color: str
    marker: str
    line: Any  # a line style of Matplotlib


# Colors that differ for color-blind readers and in gray.
BEAD = Style("#c22026", "o", "-")
SMOOTH = Style("#6a3d9a", "v", "-")
ELEMENTS = Style("#56b4e9", "v", "-")
STYLES = {
    "disk": Style("0.55", "o", (0, (1, 3))),
    "sphere": Style("0.55", "o", (0, (1, 3))),
    "droplet": Style("#e69f00", "*", "-."),
    "sector": Style("black", "s", "-"),
    "radical, kP inf": Style("#0072b2", "D", "--"),
    "radical": Style("#009e73", "^", (0, (1, 1))),
    "balanced": Style("#e69f00", "*", "-."),
    "curved": Style("#56b4e9", "X", (0, (5, 1))),
    "balanced, kP inf": Style("#cc79a7", "P", (0, (4, 1, 1, 1, 1, 1))),
}
# Between walls there is no choice of contact lines: one style for the ring law.
STYLES["ring, kP inf"] = STYLES["radical, kP inf"]
STYLES["ring"] = STYLES["radical"]

# Polygons, and finite elements, by kind.
POLYGONS = {"smooth": SMOOTH, "bead": BEAD, "elements": ELEMENTS}
POLYGON_NAMES = {
    "smooth": "smooth polygons",
    "bead": "bead polygons",
    "elements": "finite elements",
}


def plot_errors(rows: Sequence[Mapping[str, Any]], ax: Axes, quantity: str) -> None:
    """Draw errors against processor time, see `Comparison.plot`."""
    if quantity not in _QUANTITIES:
        raise ParameterError(f"quantity must be one of {', '.join(_QUANTITIES)}, not {quantity}")
    known = [row for row in rows if row[quantity] and row["seconds"] is not None]
    if not known:
        raise ParameterError("no method has a time and this error: laws at given centers have none")
    kinds = ["smooth" if row["method"] == "reference" else row["method"] for row in known]
    for kind, style in POLYGONS.items():
        line = [row for row, its in zip(known, kinds, strict=True) if its == kind]
        if not line:
            continue
        x, y = [row["seconds"] for row in line], [row[quantity] for row in line]
        ax.loglog(x, y, style.marker, color=style.color, linestyle="-", label=POLYGON_NAMES[kind])
        side = -1 if kind == "smooth" else 1
        for row in line:
            ax.annotate(
                f"{row['vertices']}",
                (row["seconds"], row[quantity]),
                textcoords="offset points",
                xytext=(5 * side, 4 * side),
                ha="right" if kind == "smooth" else "left",
                va="top" if kind == "smooth" else "bottom",
                color=style.color,
                fontsize=8,
            )
    for row, kind in zip(known, kinds, strict=True):
        if kind not in POLYGONS:
            style = STYLES[kind]
            ax.loglog(
                row["seconds"],
                row[quantity],
                style.marker,
                color=style.color,
                markersize=11 if style.marker == "*" else 7,
                linestyle="none",
                label=kind,
            )
    uncertain = rows[-1].get("limit_error")
    if quantity == "energy_error" and uncertain:
        ax.axhspan(0.0, uncertain, color="0.9", zorder=0, label="uncertainty of the reference")
    ax.set(xlabel="processor time [s]", ylabel=_QUANTITIES[quantity])
    ax.margins(0.12)
    ax.grid(which="major", alpha=0.3)

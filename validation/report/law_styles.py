"""One color, marker and line for each contact law in all figures, in the order of the legends.

`BEAD` is the style of bead polygons, `SMOOTH` that of smooth ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Style:
    """Color, marker and line of one law; laws differ in each of the three."""

    color: str
    marker: str
    line: Any  # a line style of Matplotlib


# Colors that differ for color-blind readers and in gray.
BEAD = Style("#c22026", "o", "-")
SMOOTH = Style("#6a3d9a", "v", "-")
STYLES = {
    "disk": Style("0.55", "o", (0, (1, 3))),
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

# Polygons by kind.
POLYGONS = {"smooth": SMOOTH, "bead": BEAD}
POLYGON_NAMES = {"smooth": "smooth polygons", "bead": "bead polygons"}


def legend_below(figure: Any, ax: Any) -> None:
    """Name the lines of these axes below the whole figure."""
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=4)

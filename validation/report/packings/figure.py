"""A packing of bead polygons, and the magnified deviations of the laws in a part of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from lammps_deformable.comparison import Comparison, polygon_outlines
from lammps_deformable.shape_error import deviation
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import NDArray

from validation.report.law_styles import BEAD, STYLES
from validation.report.paper.figures import magnification, short

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from matplotlib.axes import Axes

# This part of the deviations of each law is to stay small after magnification.
_MOST = 0.97


def packing(comparisons: Mapping[str, Comparison]) -> Figure:
    """The whole box, and a few polygons of it with the deviations of the laws magnified.

    Each law is drawn at |v| + m (g - |v|) in the direction of each bead v: m times as far from the
    beads as it is. The factor m stands in the title.

    Args:
        comparisons: of one packing with laws, by name.
    """
    reference = next(iter(comparisons.values())).reference
    box, radii = reference.packing.box, reference.packing.radii
    figure = Figure(figsize=(8.0, 4.8), dpi=150, layout="constrained")
    whole, zoom = figure.subplots(1, 2)

    polygons = _images(reference.outlines, box)
    whole.add_collection(
        PolyCollection(polygons, facecolor="0.92", edgecolor=BEAD.color, linewidth=0.5)
    )
    frame = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) @ box
    whole.add_patch(Polygon(frame, fill=False, edgecolor="0.5", linewidth=0.8))
    middle = 0.5 * box.sum(axis=0)
    half = min(1.7 * float(radii.max()), 0.5 * float(box.diagonal().min()))
    corner = (middle[0] - half, middle[1] - half)
    window = Rectangle(corner, 2 * half, 2 * half, fill=False, linewidth=1.3, zorder=5)
    whole.add_patch(window)
    margin = 1.05 * float(radii.max())
    low, high = frame.min(axis=0) - margin, frame.max(axis=0) + margin
    whole.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    whole.set_title(f"{len(reference.packing)} bead polygons", fontsize=10)
    whole.set_axis_off()

    factor = _deviations(zoom, comparisons)
    zoom.set(
        xlim=(middle[0] - half, middle[0] + half),
        ylim=(middle[1] - half, middle[1] + half),
        aspect="equal",
        xticks=[],
        yticks=[],
    )
    zoom.set_title(rf"the part in the frame, deviations $\times$ {factor:g}", fontsize=10)
    means = ", ".join(
        f"{name} {short(float(each.shape_error.mean()))}" for name, each in comparisons.items()
    )
    figure.suptitle(f"mean shape error $I$: {means}", fontsize=9)
    figure.legend(*zoom.get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


def _deviations(ax: Axes, comparisons: Mapping[str, Comparison]) -> float:
    """Draw beads, and the laws at magnified distances from them; returns the factor."""
    reference = next(iter(comparisons.values())).reference
    centers, box = reference.packing.positions, reference.packing.box
    about = [polygon - center for polygon, center in zip(reference.outlines, centers, strict=True)]
    found = {
        name: [
            deviation(polygon, line)
            for polygon, line in zip(about, polygon_outlines(reference, each.state), strict=True)
        ]
        for name, each in comparisons.items()
    }
    large = max(np.quantile(np.abs(np.concatenate(each)), _MOST) for each in found.values())
    factor = magnification(float(large), float(reference.packing.radii.min()))
    dots = np.vstack(_images(reference.outlines, box))
    ax.plot(*dots.T, color=BEAD.color, linestyle="none", marker=".", markersize=4.0, label="beads")
    for name, each in found.items():
        magnified = [
            center + polygon * (1.0 - factor * off / np.hypot(*polygon.T))[:, None]
            for center, polygon, off in zip(centers, about, each, strict=True)
        ]
        closed = [np.vstack([line, line[:1]]) for line in _images(magnified, box)]
        style = STYLES[name]
        lines = LineCollection(
            closed, linewidths=1.2, color=style.color, linestyle=style.line, label=name, zorder=4
        )
        ax.add_collection(lines)
    return factor


def _images(
    outlines: Iterable[NDArray[np.float64]], box: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """All periodic images of closed lines that reach into the box."""
    to_fraction = np.linalg.inv(box)
    images = []
    for outline in outlines:
        fraction = outline @ to_fraction
        low = np.floor(fraction.min(axis=0)).astype(int)
        high = np.floor(fraction.max(axis=0)).astype(int)
        for a in range(low[0], high[0] + 1):
            for b in range(low[1], high[1] + 1):
                images.append(outline - np.array([a, b]) @ box)
    return images

"""The picture of a state."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.collections import PolyCollection
from matplotlib.patches import Polygon

from .errors import ParameterError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .state import State

_LABELS = {
    "particle_pressure": "pressure in the particle",
    "area_deficit": "area deficit $A_0 - A$",
    "arc_radius": "smallest radius of curvature",
}


def draw(state: State, ax: Axes | None, color_by: str) -> Axes:
    """See `State.plot`."""
    values = np.asarray(getattr(state, color_by, None))
    if values.shape != (len(state.packing),) or values.dtype.kind not in "bif":
        raise ParameterError(
            f"color_by must name an attribute with one number a particle, not '{color_by}'"
        )
    if ax is None:
        _, ax = plt.subplots(figsize=(6.4, 5.6), layout="constrained")

    box = state.packing.box
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) @ box
    frame = Polygon(corners, closed=True, fill=False, edgecolor="0.25", linewidth=1.0, zorder=3)
    ax.add_patch(frame)

    outlines, colors = [], []
    to_fraction = np.linalg.inv(box)
    for outline, value in zip(state.outlines, values, strict=True):
        fraction = outline @ to_fraction
        low = np.floor(fraction.min(axis=0)).astype(int)
        high = np.floor(fraction.max(axis=0)).astype(int)
        for a in range(low[0], high[0] + 1):  # as many images as reach into the box
            for b in range(low[1], high[1] + 1):
                outlines.append(outline - np.array([a, b]) @ box)
                colors.append(value)
    particles = PolyCollection(
        outlines, array=np.array(colors), cmap="YlGnBu", edgecolors="0.2", linewidths=0.6
    )
    particles.set_clim(min(0.0, values.min()), values.max() or 1.0)
    ax.add_collection(particles)
    particles.set_clip_path(frame)

    ax.figure.colorbar(particles, ax=ax, label=_LABELS.get(color_by, color_by), shrink=0.85)
    ax.set_title(f"$\\phi$ = {state.phi:.4f},  $p$ = {state.pressure:.3g}", fontsize=11)
    margin = 0.01 * np.ptp(corners, axis=0)
    ax.set(
        xlim=(corners[:, 0].min() - margin[0], corners[:, 0].max() + margin[0]),
        ylim=(corners[:, 1].min() - margin[1], corners[:, 1].max() + margin[1]),
        aspect="equal",
    )
    ax.set_axis_off()
    return ax

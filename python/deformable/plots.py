"""The picture of a state."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from .errors import ParameterError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .state import State

_LABELS = {
    "particle_pressure": "pressure in the particle",
    "area_deficit": "area deficit $A_0 - A$",
    "arc_radius": "smallest radius of curvature",
}


# Points of an outline this near to a contact line, over R, lie on it: rounding is less, and an arc
# has left the line within 1e-4 R.
_ON_LINE = 1e-9


def draw(state: State, ax: Axes | None, color_by: str, contacts: bool) -> Axes:
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

    outlines, colors, flats = [], [], []
    to_fraction = np.linalg.inv(box)
    pressed = _flats(state) if contacts else [[]] * len(values)
    for outline, value, pressed_here in zip(state.outlines, values, pressed, strict=True):
        fraction = outline @ to_fraction
        low = np.floor(fraction.min(axis=0)).astype(int)
        high = np.floor(fraction.max(axis=0)).astype(int)
        for a in range(low[0], high[0] + 1):  # as many images as reach into the box
            for b in range(low[1], high[1] + 1):
                outlines.append(outline - np.array([a, b]) @ box)
                colors.append(value)
                flats += [flat - np.array([a, b]) @ box for flat in pressed_here]
    particles = PolyCollection(
        outlines, array=np.array(colors), cmap="YlGnBu", edgecolors="0.2", linewidths=0.6
    )
    particles.set_clim(min(0.0, values.min()), values.max() or 1.0)
    ax.add_collection(particles)
    particles.set_clip_path(frame)
    if contacts:
        lines = LineCollection(flats, colors="tab:red", linewidths=1.8, capstyle="butt")
        ax.add_collection(lines)
        lines.set_clip_path(frame)

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


def _flats(state: State) -> list[list[NDArray[np.float64]]]:
    """The straight parts of each outline, where its contacts are, arrays of two ends (2, 2)."""
    flats = []
    for outline, radius, seen in zip(
        state.outlines, state.packing.radius, state.contacts_seen, strict=True
    ):
        seen = seen[seen["length"] > 0.0]
        out = np.column_stack([np.cos(seen["angle"]), np.sin(seen["angle"])])
        beyond = np.sum(seen["position"] * out, axis=1) - outline @ out.T
        along = outline @ (out[:, ::-1] * [-1.0, 1.0]).T
        on = [np.flatnonzero(column <= _ON_LINE * radius) for column in beyond.T]
        flats.append(
            [
                outline[points[[column[points].argmin(), column[points].argmax()]]]
                for points, column in zip(on, along.T, strict=True)
            ]
        )
    return flats

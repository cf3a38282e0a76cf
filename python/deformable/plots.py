"""The picture of a state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
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
    "shape_parameter": r"shape parameter $P^2 / 4 \pi A$",
}

# Values of circles, where scales of colour begin; 0 if not here.
_ROUND = {"shape_parameter": 1.0}

# Width of the line of the largest force [points].
_WIDEST = 5.0

# Points of an outline this near to a contact line, over R, lie on it: rounding is less, and an arc
# has left the line within 1e-4 R.
_ON_LINE = 1e-9


@dataclass(frozen=True)
class Scale:
    """What colours and widths stand for.

    Attributes:
        low: value of the first colour.
        high: value of the last one.
        force: of the widest line.
    """

    low: float
    high: float
    force: float


def scale(states: Sequence[State], color_by: str) -> Scale:
    """The scale on which pictures of all these states fit."""
    values = np.concatenate([_values(state, color_by) for state in states])
    begin = _ROUND.get(color_by, 0.0)
    low, high = min(begin, values.min()), max(begin, values.max())
    force = max(state.contact_table["force"].max(initial=0.0) for state in states)
    return Scale(low, high if high > low else low + 1.0, force or 1.0)


def draw(
    state: State,
    ax: Axes | None,
    color_by: str,
    contacts: bool,
    forces: bool,
    on: Scale | None = None,
) -> Axes:
    """See `State.plot`; `on` is a scale of several pictures."""
    on = scale([state], color_by) if on is None else on
    if ax is None:
        _, ax = plt.subplots(figsize=(6.4, 5.6), layout="constrained")

    box = state.packing.box
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) @ box
    frame = Polygon(corners, closed=True, fill=False, edgecolor="0.25", linewidth=1.0, zorder=3)
    ax.add_patch(frame)

    outlines, colors, flats, halves, widths = [], [], [], [], []
    to_fraction = np.linalg.inv(box)
    values = _values(state, color_by)
    pressed = _flats(state) if contacts else [[]] * len(values)
    for outline, value, pressed_here, centre, seen in zip(
        state.outlines,
        values,
        pressed,
        state.packing.positions,
        state.contacts_seen,
        strict=True,
    ):
        fraction = outline @ to_fraction
        low = np.floor(fraction.min(axis=0)).astype(int)
        high = np.floor(fraction.max(axis=0)).astype(int)
        for a in range(low[0], high[0] + 1):  # as many images as reach into the box
            for b in range(low[1], high[1] + 1):
                shift = np.array([a, b]) @ box
                outlines.append(outline - shift)
                colors.append(value)
                flats += [flat - shift for flat in pressed_here]
                if forces:  # each particle draws the half within its outline
                    halves += [np.array([centre, met]) - shift for met in seen["position"]]
                    widths += (_WIDEST * seen["force"] / on.force).tolist()
    particles = PolyCollection(
        outlines, array=np.array(colors), cmap="YlGnBu", edgecolors="0.2", linewidths=0.6
    )
    particles.set_clim(on.low, on.high)
    ax.add_collection(particles)
    particles.set_clip_path(frame)
    for lines in (
        *([LineCollection(flats, colors="tab:red", linewidths=1.8, capstyle="butt")] * contacts),
        *(
            [LineCollection(halves, colors="orangered", linewidths=widths, capstyle="round")]
            * forces
        ),
    ):
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


def _values(state: State, color_by: str) -> NDArray[np.float64]:
    """The values that colours stand for."""
    values = np.asarray(getattr(state, color_by, None))
    if values.shape != (len(state.packing),) or values.dtype.kind not in "bif":
        raise ParameterError(
            f"color_by must name an attribute with one number a particle, not '{color_by}'"
        )
    return values.astype(float)


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

"""What colors and widths of a picture mean."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.validate import finite, shown

if TYPE_CHECKING:
    from matplotlib.colors import Colormap

# Color maps of values of one sign, and of both: no red, which is that of forces and contacts.
_SEQUENTIAL, _DIVERGING = "YlGnBu", "BrBG"
_CYCLIC = "twilight"
_NO_VALUE = "0.8"

# Angles, whose scale is a whole turn.
_ANGLES = ("direction",)

# Values of circles, at which scales of color begin; 0 for all others.
_ROUND = {"shape_parameter": 1.0}

# Width of the line of the largest force [points]: at most so wide, and in packings of many
# particles so wide times sqrt(N), about a tenth of a particle.
_WIDEST, _WIDEST_OF_MANY = 3.0, 36.0

# Values that differ by less than this part of them are equal up to rounding; values are signed if
# some are below 0 by more than the other part of the largest, as solvers leave tiny ones.
_EQUAL, _SIGNED = 1e-12, 1e-6


@dataclass(frozen=True)
class Scale:
    """Meaning of colors and widths.

    Attributes:
        low: value of the first color.
        high: value of the last color; `low` if all values are equal.
        force: force of the widest line.
        widest: its width [points].
        cyclic: whether the first and last color are the same.
    """

    low: float
    high: float
    force: float
    widest: float
    cyclic: bool = False

    @property
    def signed(self) -> bool:
        """Whether 0 is in the middle of the colors."""
        return self.low < 0.0 and self.low == -self.high


def scale(
    values: Sequence[NDArray[np.float64]], forces: Sequence[NDArray[np.float64]], color_by: object
) -> Scale:
    """One scale for several pictures, from the values of the particles and the forces of each.

    It begins at 0, and at 1 for shape parameters. If some values are negative, 0 is in the middle.
    For directions it is a whole turn.
    """
    begin = _ROUND.get(color_by, 0.0) if isinstance(color_by, str) else 0.0
    low = min(begin, *(float(np.nanmin(each)) for each in values))
    high = max(begin, *(float(np.nanmax(each)) for each in values))
    force = max((np.abs(each).max(initial=0.0) for each in forces), default=0.0)
    cyclic = isinstance(color_by, str) and color_by in _ANGLES
    if cyclic:
        low, high = -np.pi, np.pi
    elif low < -_SIGNED * high:
        high = max(-low, high)
        low = -high
    elif high - low <= _EQUAL * max(abs(low), abs(high)):
        high = low
    widest = min(_WIDEST, _WIDEST_OF_MANY / np.sqrt(len(values[0])))
    return Scale(low, high, float(force) or 1.0, float(widest), cyclic)


def per_particle(
    color_by: object, found: object, number: int, names: Iterable[str]
) -> NDArray[np.float64]:
    """What is found for the colors, as one number for each particle, shape (N,).

    Args:
        color_by: what the user has asked for.
        found: the numbers, of which some may be nan, or anything else.
        number: of particles.
        names: that the user may ask for.

    Raises:
        ParameterError: they are no such numbers.
    """
    try:
        values = np.asarray(found)
    except ValueError:  # rows of unequal length
        values = np.asarray(None)
    fits = values.shape == (number,) and values.dtype.kind in "biuf"
    if not fits or np.isinf(values).any() or np.isnan(values).all():
        kind = "real " if np.iscomplexobj(values) else ""
        raise ParameterError(
            f"color_by must name a value of each particle, such as {', '.join(sorted(names))}, or "
            f"be {number} {kind}numbers, not {shown(color_by)}"
        )
    return values.astype(np.float64)


def limited(on: Scale, vmin: float | None, vmax: float | None) -> Scale:
    """A scale with other values of the first and last color, where these are given.

    Where 0 is in the middle it stays there, unless both are given.

    Raises:
        ParameterError: they are no numbers, or the first is not below the second.
    """
    if vmin is None and vmax is None:
        return on
    low = on.low if vmin is None else finite("vmin", vmin)
    high = on.high if vmax is None else finite("vmax", vmax)
    if on.signed and vmin is None and high > 0.0:
        low = -high
    if on.signed and vmax is None and low < 0.0:
        high = -low
    if not low < high:
        raise ParameterError(f"vmin must be below vmax, not {low:g} and {high:g}")
    return replace(on, low=low, high=high)


def color_map(cmap: str | None, on: Scale) -> Colormap:
    """The color map of this name; if none is given, one for angles or for the signs of values.

    Raises:
        ParameterError: matplotlib has no color map of this name.
    """
    from matplotlib import colormaps

    if cmap is None:
        cmap = _CYCLIC if on.cyclic else _DIVERGING if on.signed else _SEQUENTIAL
    if not (isinstance(cmap, str) and cmap in colormaps):
        raise ParameterError(f"cmap must be one of matplotlib's color maps, not {shown(cmap)}")
    return colormaps[cmap].with_extremes(bad=_NO_VALUE)

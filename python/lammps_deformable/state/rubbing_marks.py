"""Friction in pictures: contacts that slide, forces along contacts, and spins."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..core import unit_vectors
from ..model.marks import Mark
from ..model.packing import Packing
from .contact_table import ContactTable
from .flats import flats_of

Floats = NDArray[np.float64]

# Colors of contacts that slide and stick, and their width [points].
_SLIDES, _STICKS, _CONTACT = "lime", "orangered", 2.0

# Length of the bar of a friction that is as large as the force, over the radius.
_BAR = 1.0

# An arrow of a spin: its radius over that of the particle, the angle of the fastest one, the size
# of its head over its radius, the points of its arc; widths and colors, first the lower one.
_PLACE, _FASTEST, _HEAD, _POINTS = 0.45, 1.6 * np.pi, 0.45, 24
_ARROW = ((2.8, "white"), (1.0, "black"))


def sliding_contacts(
    outlines: Sequence[Floats], packing: Packing, tables: Sequence[ContactTable]
) -> Mark:
    """The contacts that slide, as the outlines share them."""
    sliding = [table[table["sliding"]] for table in tables]
    lines = flats_of(outlines, packing.radius, sliding)
    return Mark(lines, [[_CONTACT] * len(each) for each in lines], _SLIDES)


def friction_bars(packing: Packing, tables: Sequence[ContactTable]) -> list[Mark]:
    """A bar along each contact, the longer the larger its friction is, compared with its force."""
    marks = []
    for slides, color in ((False, _STICKS), (True, _SLIDES)):
        lines, widths = [], []
        for radius, table in zip(packing.radius, tables, strict=True):
            rows = table[(table["sliding"] == slides) & (table["friction"] != 0.0)]
            part = np.minimum(np.abs(rows["friction"] / rows["force"]), 1.0)
            across = 0.5 * _BAR * radius * part[:, None] * unit_vectors(rows["angle"] + 0.5 * np.pi)
            ends = np.stack([rows["position"] - across, rows["position"] + across], axis=1)
            lines.append(list(ends))
            widths.append([_CONTACT] * len(rows))
        marks.append(Mark(lines, widths, color))
    return marks


def spin_arrows(packing: Packing, spins: Floats) -> list[Mark]:
    """An arc with a head in each particle, the longer the faster it turns."""
    fastest = float(np.abs(spins).max(initial=0.0)) or 1.0
    arrows = [
        _arrow(center, _PLACE * radius, _FASTEST * spin / fastest)
        for center, radius, spin in zip(packing.positions, packing.radius, spins, strict=True)
    ]
    return [
        Mark(arrows, [[width] * len(each) for each in arrows], color) for width, color in _ARROW
    ]


def _arrow(center: Floats, radius: float, angle: float) -> list[Floats]:
    """An arc from above by this angle, positive to the left, and the head at its end."""
    arc = center + radius * unit_vectors(0.5 * np.pi + angle * np.linspace(0.0, 1.0, _POINTS))
    back = 0.5 * np.pi + angle - np.copysign(0.5 * np.pi, angle)
    head = min(_HEAD, abs(angle)) * radius * unit_vectors(np.array([back - 0.5, back, back + 0.5]))
    head[1] = 0.0
    return [arc, arc[-1] + head]

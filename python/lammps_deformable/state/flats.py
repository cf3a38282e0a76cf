"""The contacts of deformable particles, as pictures show them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .contact_table import ContactTable

Floats = NDArray[np.float64]

# Points of an outline closer to the chord of a contact than this, over R, are its ends: forces are
# balanced to 1e-8, and an arc has left the line within 1e-4 R.
_ON_LINE = 1e-7


def flats_of(
    outlines: Sequence[Floats], radii: Floats, contacts: Sequence[ContactTable]
) -> list[list[Floats]]:
    """The part of each outline at its contacts, a straight line or an arc, arrays (m, 2)."""
    flats: list[list[Floats]] = []
    for outline, radius, table in zip(outlines, radii, contacts, strict=True):
        table = table[table["length"] > 0.0]
        out = np.column_stack([np.cos(table["angle"]), np.sin(table["angle"])])
        half = 0.5 * table["length"] * np.sinc(table["half_angle"] / np.pi)  # of the chord
        height = np.sum(table["position"] * out, axis=1) - half * np.tan(0.5 * table["half_angle"])
        inward = height - outline @ out.T
        along = outline @ (out[:, ::-1] * [-1.0, 1.0]).T
        flats.append([])
        for off, place in zip(np.abs(inward).T, along.T, strict=True):
            if (on := np.flatnonzero(off <= _ON_LINE * radius)).size:
                begin, end = on[place[on].argmin()], on[place[on].argmax()]
                flats[-1].append(np.roll(outline, -begin, 0)[: (end - begin) % len(outline) + 1])
    return flats

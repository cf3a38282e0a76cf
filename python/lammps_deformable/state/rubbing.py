"""Contacts that rub in the table of a state: their friction, damping and springs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..core import unit_vectors
from ..model.packing import Packing
from .contact_table import COLUMNS, ContactTable, other_sides, react, sides_of

Floats = NDArray[np.float64]

# They follow those of contacts that slip freely. Forces are those on i, [energy/length].
RUBBING = np.dtype(
    [
        ("friction", float),  # f_t, along the line: in the direction of its normal, turned left
        ("damping", float),  # f_d, along the normal
        ("spring", float),  # its length xi [length]
        ("sliding", bool),  # whether the friction has its largest value
    ]
)
_WITH_RUBBING = np.dtype(COLUMNS.descr + RUBBING.descr)

# Those of fix deformable/friction: a row for each contact, with radical lines for each side.
RUBBING_ROWS = (
    *("i", "j", "x", "y", "angle", "force"),
    *("friction", "damping", "spring", "sliding", "wall"),
)


def rubbing_table(
    rows: Floats, packing: Packing, rubbing_rows: Floats
) -> tuple[ContactTable, Floats, Floats]:
    """As `contact_table`, with the columns of `RUBBING`, and the springs of the contacts.

    Args:
        rows: of compute deformable/contact on all ranks.
        packing: centers and box at the same time.
        rubbing_rows: of fix deformable/friction on all ranks, shape (M, len(RUBBING_ROWS)).

    Returns:
        The table, whose `force_vector` has friction and damping too; and `springs` and `places` of
        `Rubbing`.
    """
    sides = sides_of(rows, packing)
    table = np.zeros(len(sides), _WITH_RUBBING)
    for name in COLUMNS.names or ():
        table[name] = sides[name]
    told = dict(zip(RUBBING_ROWS, np.ascontiguousarray(rubbing_rows.T), strict=True))
    at = _sides_in(table, told["i"], np.where(told["wall"] < 0, 0, told["j"]), told["angle"])
    for name in RUBBING.names or ():
        table[name][at] = told[name]
    out = unit_vectors(told["angle"])
    across = np.column_stack([-out[:, 1], out[:, 0]])
    table["force_vector"][at] += told["damping"][:, None] * out + told["friction"][:, None] * across
    react(table)
    _tell_other_sides(table, at)
    return table, *_springs(table[at], told["wall"])


def _sides_in(table: ContactTable, i: Floats, j: Floats, angle: Floats) -> NDArray[np.int64]:
    """Sides with these IDs, j = 0 for a wall; a pair in a small box has several directions."""
    out = unit_vectors(np.ascontiguousarray(table["angle"]))
    given = np.column_stack([table["i"] + 1, table["j"] + 1, out])
    _, at = cKDTree(given).query(np.column_stack([i, j, unit_vectors(angle)]))
    return np.asarray(at, np.int64)


def _tell_other_sides(table: ContactTable, known: NDArray[np.int64]) -> None:
    """Give the second side of a line what the first one has; a radical side has its own."""
    pair, other = other_sides(table)
    tell = table["force"] != 0.0
    tell[known] = False
    for name in RUBBING.names or ():
        both = table[name][pair]
        table[name][pair] = np.where(tell[pair], both[other], both)


def _springs(sides: ContactTable, wall: Floats) -> tuple[Floats, Floats]:
    """See `springs` and `places` of `Rubbing`, sorted.

    Args:
        sides: that remember.
        wall: the code below 0 of each wall, else 0.
    """
    apart = sides["distance"][:, None] * unit_vectors(sides["angle"] - sides["tilt"])
    places = np.column_stack([unit_vectors(np.ascontiguousarray(sides["angle"])), apart])
    apart[wall < 0] = 0.0
    partner = np.where(wall < 0, wall, sides["j"] + 1)
    values = (sides["spring"], sides["friction"], sides["damping"])
    springs = np.column_stack([sides["i"] + 1, partner, apart, *values])
    order = np.lexsort(springs.T[3::-1])
    return springs[order], places[order]

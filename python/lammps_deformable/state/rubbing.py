"""What contacts that rub tell of themselves: rows of fix deformable/friction as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core import unit_vectors
from ..particles.friction import rubbing_columns
from ..particles.gravity import Floats
from .contacts import ContactTable, other_side, react, sides_of, to_partner

if TYPE_CHECKING:
    from ..particles.packing import Packing

# The numbers of a contact in fix deformable/friction: a row for each contact, with radical lines
# for each side.
RUBBING_ROWS = {2: 13, 3: 22}


class _Told(NamedTuple):
    """What fix deformable/friction tells of contacts, see `rubbing_columns`."""

    i: Floats
    j: Floats
    wall: Floats
    normal: Floats
    friction: Floats
    damping: Floats
    spring: Floats
    sliding: Floats
    film: Floats  # along the contact
    squeezed: Floats  # and along its normal
    power: Floats  # (M, 4), without a ledger (M, 0)


def _told(rows: Floats) -> _Told:
    """Of both dimensions."""
    dimension = 2 if rows.shape[1] < RUBBING_ROWS[3] else 3
    rows, power = np.split(rows, [RUBBING_ROWS[dimension]], axis=1)
    c = np.ascontiguousarray(rows.T)
    if dimension == 2:
        n = unit_vectors(c[4])
        return _Told(c[0], c[1], c[10], n, c[6], c[7], c[8], c[9], c[11], c[12], power)
    n, friction, spring, film = (rows[:, k : k + 3] for k in (5, 9, 13, 18))
    return _Told(c[0], c[1], c[17], n, friction, c[12], spring, c[16], film, c[21], power)


def _normals(table: ContactTable) -> Floats:
    names = table.dtype.names or ()
    return table["normal"] if "normal" in names else unit_vectors(np.array(table["angle"]))


def rubbing_table(
    rows: Floats, packing: Packing, rubbing_rows: Floats, films: bool
) -> tuple[ContactTable, Floats, Floats]:
    """As `contact_table`, with `rubbing_columns`, and the springs of contacts.

    Args:
        rows: of compute deformable/contact on all ranks.
        packing: centers and box at the same time.
        rubbing_rows: of fix deformable/friction on all ranks, shape (M, RUBBING_ROWS), with a
            ledger 4 more.
        films: whether springs come with the forces of films.

    Returns:
        The table, whose `force_vector` has all forces; and `springs` and `places` of `Rubbing`.
    """
    plane = packing.dimension == 2
    ledger = rubbing_rows.shape[1] > RUBBING_ROWS[packing.dimension]
    sides, of_rubbing = sides_of(rows, packing), rubbing_columns(packing.dimension, ledger)
    table = np.zeros(len(sides), np.dtype(sides.dtype.descr + of_rubbing.descr))
    for name in sides.dtype.names or ():
        table[name] = sides[name]
    told = _told(rubbing_rows)
    at = _sides_in(table, told.i, np.where(told.wall < 0, 0, told.j), told.normal)
    n = told.normal
    friction, film = (
        v[:, None] * np.column_stack([-n[:, 1], n[:, 0]]) if plane else v
        for v in (told.friction, told.film)
    )
    table["friction"][at], table["spring"][at] = told.friction, told.spring
    table["damping"][at], table["sliding"][at] = told.damping, told.sliding
    table["film_vector"][at] = told.squeezed[:, None] * n + film
    if ledger:
        table["power"][at] = told.power
    table["force_vector"][at] += told.damping[:, None] * n + friction + table["film_vector"][at]
    react(table)
    _tell_other_sides(table, at)
    return table, *_springs(table[at], told, films)


def _sides_in(table: ContactTable, i: Floats, j: Floats, normal: Floats) -> NDArray[np.int64]:
    """Sides with these IDs, j = 0 for a wall; a pair in a small box has several directions."""
    given = np.column_stack([table["i"] + 1, np.maximum(table["j"] + 1, 0), _normals(table)])
    from scipy.spatial import cKDTree

    _, at = cKDTree(given).query(np.column_stack([i, j, normal]))
    return np.asarray(at, np.int64)


def _tell_other_sides(table: ContactTable, known: NDArray[np.int64]) -> None:
    """Give the second side of a line what the first one has; a radical side has its own."""
    pair = table["j"] >= 0
    other = other_side(table[pair])
    tell = table["force"] != 0.0
    tell[known] = False
    power = ["power"] * ("power" in (table.dtype.names or ()))
    for name in ("friction", "damping", "spring", "sliding", "film_vector", *power):
        both = table[name][pair]
        is_vector = both.ndim > 1 and name != "power"  # which has the other sign
        told = -both[other] if is_vector else both[other]
        chosen = tell[pair] if both.ndim == 1 else tell[pair][:, None]
        table[name][pair] = np.where(chosen, told, both)


def _springs(sides: ContactTable, told: _Told, films: bool) -> tuple[Floats, Floats]:
    """See `springs` and `places` of `Rubbing`, sorted.

    Args:
        sides: that remember.
        told: of each.
        films: whether they have films.
    """
    n = told.normal
    plane = n.shape[1] == 2
    apart = sides["distance"][:, None] * to_partner(sides)
    places = np.column_stack([_normals(sides), apart])
    apart[told.wall < 0] = 0.0
    partner = np.where(told.wall < 0, told.wall, sides["j"] + 1)
    spring, friction, film = (
        v if plane else np.cross(n, v) for v in (told.spring, told.friction, told.film)
    )
    values = [spring, friction, told.damping, *([film, told.squeezed] if films else [])]
    springs = np.column_stack([sides["i"] + 1, partner, apart, *values])
    order = np.lexsort(springs.T[1 + n.shape[1] :: -1])
    return springs[order], places[order]

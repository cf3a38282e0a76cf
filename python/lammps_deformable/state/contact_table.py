"""The table of active contacts of a state, from compute deformable/contact."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.packing import Packing

# Each contact has two rows, one for each side; a contact with a wall has one row, with j = -1.
COLUMNS = np.dtype(
    [
        ("i", np.int64),
        ("j", np.int64),
        ("image", np.int64, 2),  # periodic image of j in the contact, in lattice vectors
        ("angle", float),  # direction from i to the contact line, normal to it [rad]
        ("distance", float),  # of the centers, or of i from the wall [length]
        ("indentation", float),  # of i [length]
        ("length", float),  # of the contact on i [length]
        ("force", float),  # of this side, dU_i/da [energy/length]
        ("position", float, 2),  # of the contact line's point nearest to i [length]
        ("tilt", float),  # of the line: angle less the direction from i to j [rad]
        ("half_angle", float),  # of the line, an arc: positive where it is convex for i [rad]
        ("force_vector", float, 2),  # on i by the contact; their sum is the force on i
        ("contact_angle", float),  # at which the outline of i meets the film, 0 without [rad]
        ("attached", bool),  # whether it sticks: its force may be negative
    ]
)

# Those of compute deformable/contact. Its force vector is that of the energy of i alone.
ROWS = (
    *("i", "j", "indentation", "length", "force", "x", "y"),
    *("angle", "distance", "tilt", "half_angle", "fx", "fy"),
    *("contact_angle", "attached"),
)

ContactTable = NDArray[np.void]


def contact_table(rows: NDArray[np.float64], packing: Packing) -> ContactTable:
    """All contacts, sorted by (i, j, image), with the forces on the particles.

    Arguments as of `sides_of`.
    """
    table = sides_of(rows, packing)
    react(table)
    return table


def sides_of(rows: NDArray[np.float64], packing: Packing) -> ContactTable:
    """Both sides of all contacts, each with the force vector of its own energy.

    Args:
        rows: of compute deformable/contact on all ranks, shape (M, len(ROWS)).
        packing: centers and box at the same time.

    Returns:
        Structured array of `COLUMNS`, with both sides of each pair. A side without force has no row
        in LAMMPS; here it has one with length and force 0, and the rest of the overlap.
    """
    told = dict(zip(ROWS, rows.T, strict=True))
    table = np.zeros(len(rows), COLUMNS)
    table["i"], table["j"] = told["i"] - 1, told["j"] - 1
    for name in set(ROWS) & set(COLUMNS.names or ()) - {"i", "j"}:
        table[name] = told[name]
    table["position"] = np.column_stack([told["x"], told["y"]])
    table["force_vector"] = np.column_stack([told["fx"], told["fy"]])
    pair = table["j"] >= 0
    # an exact integer, equal for both sides in spite of rounding
    i, j = table["i"][pair], table["j"][pair]
    angle = table["angle"][pair] - table["tilt"][pair]
    out = np.column_stack([np.cos(angle), np.sin(angle)])
    apart = packing.positions[i] + table["distance"][pair, None] * out - packing.positions[j]
    table["image"][pair] = np.rint(apart @ np.linalg.inv(packing.box)).astype(np.int64)
    table = np.concatenate([table, _missing_sides(table[pair], packing)])
    return table[_order(table["i"], table["j"], table["image"])]


def react(table: ContactTable) -> None:
    """Add to the force vector of each side the opposite of that of the other side."""
    pair, other = other_sides(table)
    both = table["force_vector"][pair]
    table["force_vector"][pair] -= both[other]


def other_sides(table: ContactTable) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Which sides are those of pairs; and of each of these the number of the other one."""
    pair = table["j"] >= 0
    # in this order the other sides come in the order of their own
    return pair, _order(table["j"][pair], table["i"][pair], -table["image"][pair])


def attached(rows: NDArray[np.float64]) -> NDArray[np.int64]:
    """The contacts that stick, sorted, see `io.films`: a wall has its code in place of an ID."""
    told = dict(zip(ROWS, rows.astype(np.int64).T, strict=True))
    partner = np.where(told["attached"] < 0, told["attached"], told["j"])
    first = (told["attached"] < 0) | (told["attached"] > 0) & (told["i"] <= told["j"])
    return np.unique(np.column_stack([told["i"], partner])[first], axis=0)


def _order(i: NDArray[np.int64], j: NDArray[np.int64], image: NDArray[np.int64]) -> NDArray[Any]:
    """Indices that sort sides by (i, j, image)."""
    return np.lexsort((image[:, 1], image[:, 0], j, i))


def _missing_sides(pairs: ContactTable, packing: Packing) -> ContactTable:
    """The other side of each contact with a force on one side only."""
    found = {_key(row["i"], row["j"], row["image"]) for row in pairs}
    sides = np.array(
        [row for row in pairs if _key(row["j"], row["i"], -row["image"]) not in found], COLUMNS
    )
    overlap = packing.radius[sides["i"]] + packing.radius[sides["j"]] - sides["distance"]
    sides["i"], sides["j"] = sides["j"].copy(), sides["i"].copy()
    sides["image"] *= -1
    sides["angle"] += np.where(sides["angle"] > 0.0, -np.pi, np.pi)
    sides["indentation"] = overlap - sides["indentation"]
    sides["position"] += sides["image"] @ packing.box
    sides["length"] = sides["force"] = sides["force_vector"] = 0.0
    return sides


def _key(i: Any, j: Any, image: Any) -> tuple[int, int, int, int]:
    return int(i), int(j), int(image[0]), int(image[1])

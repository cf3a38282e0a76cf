"""The table of contacts of droplets, from compute deformable/contact in three dimensions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..model.lattice import fractional
from ..model.neighbors import forward
from ..model.packing import Packing
from .contact_forces import ContactForces
from .sides import other_sides

# Each contact has two rows, one for each side; a contact with a wall has one row, with j = -1.
COLUMNS = np.dtype(
    [
        ("i", np.int64),
        ("j", np.int64),
        ("image", np.int64, 3),  # periodic image of j in the contact, in lattice vectors
        ("distance", float),  # of the centers, or of i from the wall [length]
        ("indentation", float),  # of i [length]
        ("facet_radius", float),  # of the facet on i, sqrt(F R / (2 pi tension)) [length]
        ("force", float),  # F, the same from both sides [energy/length]
        ("position", float, 3),  # of the middle of the facet [length]
        ("normal", float, 3),  # of the facet, from i to j
        ("force_vector", float, 3),  # on i by the contact; their sum is the force on i
    ]
)

# Those of compute deformable/contact. Its force vector is that of the energy of i alone.
ROWS = (
    *("i", "j", "indentation", "facet_radius", "force"),
    *("x", "y", "z", "nx", "ny", "nz", "distance", "fx", "fy", "fz"),
)
_VECTORS = {"position": "xyz", "normal": ("nx", "ny", "nz"), "force_vector": ("fx", "fy", "fz")}

DropletTable = NDArray[np.void]


def droplet_table(rows: NDArray[np.float64], packing: Packing) -> DropletTable:
    """All contacts that bear a force, sorted by (i, j, image).

    Args:
        rows: of compute deformable/contact on all ranks, shape (M, len(ROWS)).
        packing: centers and box at the same time.

    Returns:
        Structured array of `COLUMNS`.
    """
    told = dict(zip(ROWS, rows.T, strict=True))
    table = np.zeros(len(rows), COLUMNS)
    table["i"], table["j"] = told["i"] - 1, np.maximum(told["j"] - 1, -1)
    for name in ("indentation", "facet_radius", "force", "distance"):
        table[name] = told[name]
    for name, columns in _VECTORS.items():
        table[name] = np.column_stack([told[column] for column in columns])
    pair = table["j"] >= 0
    i, j = table["i"][pair], table["j"][pair]
    to_j = table["distance"][pair, None] * table["normal"][pair]
    # an exact integer, equal for both sides in spite of rounding
    apart = packing.positions[i] + to_j - packing.positions[j]
    table["image"][pair] = np.rint(fractional(apart, packing.box)).astype(np.int64)
    table = table[np.lexsort((*table["image"].T[::-1], table["j"], table["i"]))]
    pair = table["j"] >= 0
    both = table["force_vector"][pair]
    table["force_vector"][pair] -= both[other_sides(table[pair])]
    return table


def forces_of_droplets(packing: Packing, table: DropletTable) -> ContactForces:
    """All contacts, each once."""
    i, j = table["i"], table["j"]
    rows = table[(i < j) | (j < 0) | ((i == j) & forward(table["image"]))]
    distance = rows["distance"]
    part = (packing.radius[rows["i"]] - rows["indentation"]) / distance
    return ContactForces(
        i=rows["i"],
        j=rows["j"],
        vector=distance[:, None] * rows["normal"],
        part=np.where(rows["j"] < 0, 1.0, part),
        force=rows["force_vector"],
    )

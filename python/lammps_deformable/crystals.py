"""Crystals of equal particles, in the plane and in three dimensions."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ._checks import count, numbers, positive, shown
from .errors import ParameterError
from .packing import Packing

if TYPE_CHECKING:
    from collections.abc import Sequence

# Sides of the rectangular cell, the distance of neighbors in it, and the particles, in parts of the
# sides.
_LATTICES: dict[str, tuple[tuple[float, ...], float, list[tuple[float, ...]]]] = {
    "square": ((1.0, 1.0), 1.0, [(0.0, 0.0)]),
    "hex": ((1.0, 2.0 * math.sqrt(0.75)), 1.0, [(0.0, 0.0), (0.5, 0.5)]),
    "sc": ((1.0, 1.0, 1.0), 1.0, [(0.0, 0.0, 0.0)]),
    "bcc": ((1.0, 1.0, 1.0), math.sqrt(0.75), [(0.0, 0.0, 0.0), (0.5, 0.5, 0.5)]),
    "fcc": (
        (1.0, 1.0, 1.0),
        math.sqrt(0.5),
        [(0.0, 0.0, 0.0), (0.5, 0.5, 0.0), (0.5, 0.0, 0.5), (0.0, 0.5, 0.5)],
    ),
    "hcp": (
        (1.0, 2.0 * math.sqrt(0.75), 2.0 * math.sqrt(2.0 / 3.0)),
        1.0,
        [(0.0, 0.0, 0.0), (0.5, 0.5, 0.0), (0.5, 5.0 / 6.0, 0.5), (0.0, 1.0 / 3.0, 0.5)],
    ),
}


def crystal(
    lattice: str, cells: int | Sequence[int], *, radius: float = 0.5, phi: float | None = None
) -> Packing:
    """Equal particles on a lattice that fits into its periodic box.

        crystal("hex", (16, 8), phi=0.95)
        crystal("fcc", 4, phi=0.8)

    Neighbors touch from the packing fraction pi/sqrt(12) = 0.9069 on in `hex`, pi/4 = 0.7854 in
    `square`; in three dimensions pi/sqrt(18) = 0.7405 in `fcc` and `hcp`, sqrt(3) pi/8 = 0.6802 in
    `bcc`, pi/6 = 0.5236 in `sc`.

    Args:
        lattice: in the plane `hex` (triangular; rows along x, cells of 1 by sqrt(3) diameters with
            2 particles) or `square` (1); in three dimensions `fcc` (4), `bcc` (2), `sc` (1), or
            `hcp` (layers across z, cells of 1 by sqrt(3) by sqrt(8/3) diameters with 4).
        cells: number of rectangular cells along each side of the box, or along each axis.
        radius: of the particles [length].
        phi: packing fraction of the undeformed particles, at most 10; that of particles that touch
            if not given.

    Returns:
        The packing, row by row in the plane, cell by cell in three dimensions.

    Raises:
        ParameterError: a value is out of range, or there is no such lattice.
    """
    if not isinstance(lattice, str) or lattice not in _LATTICES:
        raise ParameterError(f"lattice must be {', '.join(_LATTICES)}, not {shown(lattice)}")
    sides, distance, basis = _LATTICES[lattice]
    dimension, given = len(sides), numbers("cells", cells)
    if given.shape not in ((), (dimension,)):
        raise ParameterError(
            f"cells must be one number, or {dimension} for {lattice}, not {shown(cells)}"
        )
    along = np.array([count("cells", n) for n in np.broadcast_to(given, dimension).tolist()])
    corners = np.stack(np.meshgrid(*map(np.arange, along), indexing="ij"), axis=-1)
    places = (corners.reshape(-1, 1, dimension) + np.array(basis)).reshape(-1, dimension)
    if dimension == 2:
        places = places[np.lexsort(places.T)]  # row by row
    unit = 2.0 * positive("radius", radius) / distance
    box = unit * (np.array(sides) * along)
    touching = Packing(unit * (sides * places), np.full(len(places), radius), box)
    return touching if phi is None else touching.at(phi)

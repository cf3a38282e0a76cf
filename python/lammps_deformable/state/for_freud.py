"""Packings and contacts as freud takes them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..formats.universes import in_space
from ..model.packing import Packing
from ..model.room import closed
from .contact_forces import ContactForces


def system(freud: Any, packing: Packing) -> tuple[Any, NDArray[np.float64]]:
    """See `Analysis.to_freud`."""
    shut = closed(packing.walls, packing.dimension)
    sides = packing.box.diagonal() * np.where(shut, 2.0, 1.0)
    tilts = packing.box / packing.box.diagonal()[:, None]
    if packing.dimension == 2:
        box = freud.box.Box(*sides, xy=tilts[1, 0], is2D=True)
    else:
        box = freud.box.Box(*sides, tilts[1, 0], tilts[2, 0], tilts[2, 1])
    center = packing.origin + packing.box.sum(axis=0) / 2.0
    return box, box.wrap(in_space(packing.positions - center))


def neighbors(freud: Any, number: int, contacts: ContactForces) -> Any:
    """The contacts of so many particles as a NeighborList, from both sides."""
    pair = contacts.j >= 0
    i, j, vector, push = (
        each[pair] for each in (contacts.i, contacts.j, contacts.vector, contacts.push)
    )
    begin, end = np.append(i, j), np.append(j, i)
    order = np.lexsort((end, begin))
    both = in_space(np.concatenate([vector, -vector]))[order]
    weights = np.append(push, push)[order]
    return freud.locality.NeighborList.from_arrays(
        number, number, begin[order], end[order], both, weights
    )

"""Centers between walls: random ones, and those on the wrong side."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from .distances import Distances
from .free_room import free_room
from .lattice import cartesian
from .room import bounds, closed
from .walls import Wall

# Random places that are tried for each particle.
_TRIALS = 1000

Floats = NDArray[np.float64]


def check_centers(walls: Sequence[Wall], box: Floats, positions: Floats) -> None:
    """Refuse particles whose center is on the wrong side of a wall."""
    _, distances = Distances(walls, box)(positions)
    for n, (wall, distance) in enumerate(zip(walls, distances, strict=True), start=1):
        if (wrong := np.flatnonzero(~(distance > 0.0))).size:
            k = int(wrong[0])
            where = "within" if wall.is_obstacle else "outside of"
            raise ParameterError(
                f"the center of particle {k}, {positions[k].tolist()}, is {where} {wall.kind} {n}: "
                "`Packing.between` puts particles between walls"
            )


def random_places(
    walls: Sequence[Wall], box: Floats, number: int, rng: np.random.Generator
) -> Floats:
    """Random centers between walls, shape (number, d) [length]."""
    dimension = len(box)
    low, high = bounds(walls, box)
    free_room(walls, box)  # or there is no place
    distances, places = Distances(walls, box), np.empty((0, dimension))
    shut = any(closed(walls, dimension))
    for _ in range(_TRIALS):
        tried = rng.random((number, dimension))
        tried = low + tried * (high - low) if shut else cartesian(tried, box)
        free = (distances(tried)[1] > 0.0).all(axis=0)
        places = np.concatenate([places, tried[free]])[:number]
        if len(places) == number:
            return places
    raise ParameterError(
        f"walls leave too little room for {number} particles: take fewer or smaller obstacles"
    )

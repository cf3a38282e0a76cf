"""Distances of particles from walls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .room import closed
from .walls import Wall

Floats = NDArray[np.float64]


class Distances:
    """Distances of particles from walls: the nearest point of each wall.

    Args:
        walls: the shapes.
        box: lattice vectors as rows, shape (d, d) [length].
    """

    def __init__(self, walls: Sequence[Wall], box: Floats) -> None:
        from .. import core

        dimension = len(box)
        sides = np.where(closed(walls, dimension), 0.0, box.diagonal()).tolist()
        kind = core.Scene if dimension == 2 else core.SpaceScene
        tilts = [float(box[row, axis]) for row in range(dimension) for axis in range(row)]
        self._scene: Any = kind(*sides, *tilts)
        self._count, self._columns = len(walls), dimension + 2
        for wall in walls:
            wall.add_to(self._scene)

    def __call__(self, positions: Floats) -> tuple[Floats, Floats]:
        """Directions to the walls and distances of these N positions.

        Returns:
            Unit vectors, shape (number of walls, N, d), and distances, shape (number of walls, N)
            [length]; negative beyond a plane or round container and inside of an obstacle.
        """
        found = self._nearest(positions)
        return found[..., :-2], found[..., -2]

    def turns(self, positions: Floats) -> Floats:
        """Angle by which each direction turns for a sideways step, (number of walls, N) [1/length].

        It is 0 on a side, 1/h at a corner, 1/(rho + h) outside of a disk of radius rho, and
        -1/(rho - h) inside of a circle or sphere. It is nan in a cylinder, where it differs by the
        direction of the step.
        """
        return self._nearest(positions)[..., -1]

    def _nearest(self, positions: Floats) -> Floats:
        shape = self._count, len(positions), self._columns
        found: Floats = self._scene.nearest(*positions.T).reshape(shape)
        return found

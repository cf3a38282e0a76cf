"""Soft disks in LAMMPS, with the calls of `Simulation`: particles that overlap, not deform."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.validate import expect
from ..model.packing import Packing
from ..model.plane import refuse_space
from ..model.room import Distances, check_fit
from ..model.walls import Wall
from ..state.disk_state import DiskState
from .followed import setup
from .lammps import run
from .relaxation import Forces
from .soft_particles import SoftParticles

# Walls repel disks as other disks do, U = k/2 (R - h)^2 at the distance h.
_WALLS = """
fix deformable_walls all external pf/callback 1 1
fix_modify deformable_walls virial yes
"""


class Disks(SoftParticles[DiskState]):
    """Soft disks in LAMMPS, U = k/2 (R_i + R_j - d)^2 of each pair that overlaps, k = 1.

    A wall at the distance h adds k/2 (R - h)^2. It does not stop a disk whose center has passed it.

    Every rank of an MPI run does the same work: relaxation near jamming is chaotic, so that results
    of shared work would depend on the number of ranks.

    Args:
        packing: where the disks start, and walls; overlaps are allowed. Centers at one place are
            separated.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS, as that of a `Simulation`.

    Raises:
        ParameterError: no packing, or an obstacle that does not fit into the periodic box.
    """

    _kind = "soft disks"

    def __init__(self, packing: Packing) -> None:
        expect("packing", packing, Packing)
        refuse_space("Disks", packing.dimension, "take `Spheres`")
        super().__init__(packing)
        if self._walls:
            run(self.lmp, _WALLS)
            self.lmp.set_fix_external_callback("deformable_walls", self._repel)
            self._setup = setup(self.lmp)

    def _follow(self, walls: tuple[Wall, ...], box: NDArray[np.float64]) -> None:
        check_fit(walls, box, float(self._radius.max()))
        self._walls, self._distances = walls, Distances(walls, box)

    def _overlaps(
        self, x: NDArray[np.float64], number: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Overlaps with each wall, distances, both (W, n), and directions to it, (W, n, 2).

        Args:
            x: positions, shape (n, 2) [length].
            number: of the disks at these positions, from 0, shape (n,).
        """
        out, distance = self._distances(x)
        return np.maximum(self._radius[number] - distance, 0.0), distance, out

    def _repel(self, _caller: Any, _step: int, _n: int, tag: Any, x: Any, f: Any) -> None:
        """Forces of the walls and their virial, for LAMMPS."""
        overlap, distance, out = self._overlaps(x[:, :2], tag - 1)
        forces = -overlap[..., None] * out
        f[:] = 0.0
        f[:, :2] = forces.sum(axis=0)
        lever = -distance[..., None] * out
        xx, yy = np.sum(lever * forces, axis=(0, 1)).tolist()
        xy = float(np.sum(lever[..., 0] * forces[..., 1]))
        self.lmp.fix_external_set_virial_global("deformable_walls", [xx, yy, 0.0, xy, 0.0, 0.0])

    def _forces_of_contacts(self) -> NDArray[np.float64]:
        positions = self._positions()
        overlap, *_ = self._overlaps(positions, np.arange(len(positions)))
        self._wall_pairs = np.argwhere(overlap.T > 0.0)
        return np.append(super()._forces_of_contacts(), overlap[overlap > 0.0])

    def _snapshot(self, forces: Forces, stalled: bool) -> DiskState:
        return DiskState(**self._values(forces, stalled), wall_pairs=self._wall_pairs)

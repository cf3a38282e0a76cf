"""Soft disks in LAMMPS, with the calls of `Simulation`: particles that overlap, not deform."""

from __future__ import annotations

from ..common.validate import expect
from ..model.packing import Packing
from ..model.plane import refuse_space
from ..state.disk_state import DiskState
from .relaxation import Forces
from .soft_particles import SoftParticles


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

    def _snapshot(self, forces: Forces, stalled: bool) -> DiskState:
        return DiskState(**self._values(forces, stalled))

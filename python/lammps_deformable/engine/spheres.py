"""Soft spheres in LAMMPS."""

from __future__ import annotations

from ..common.errors import ParameterError
from ..common.validate import expect
from ..model.packing import Packing
from ..state.sphere_state import SphereState
from .relaxation import Forces
from .soft_particles import SoftParticles


class Spheres(SoftParticles[SphereState]):
    """Soft spheres in LAMMPS, U = k/2 (R_i + R_j - d)^2 of each pair that overlaps, k = 1.

    Every rank of an MPI run does the same work, as with `Disks`.

    Args:
        packing: where the spheres start; overlaps are allowed. Centers at one place are separated.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS, as that of a `Simulation`.

    Raises:
        ParameterError: no packing, or one in the plane.
    """

    _kind = "soft spheres"

    def __init__(self, packing: Packing) -> None:
        expect("packing", packing, Packing)
        if packing.dimension == 2:
            raise ParameterError("Spheres is for three dimensions, and this packing has two: Disks")
        super().__init__(packing)

    def _snapshot(self, forces: Forces, stalled: bool) -> SphereState:
        return SphereState(**self._values(forces, stalled))

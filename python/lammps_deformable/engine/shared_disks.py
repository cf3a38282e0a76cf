"""Soft disks that many ranks relax together, by conjugate gradients in LAMMPS."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from mpi4py import MPI

from ..model.packing import Packing
from .lammps import gather, run
from .relaxation import force_rounding, largest_force, minimize_command, stress
from .relaxed_disks import RelaxedDisks, Report, relax_in_box
from .soft_particles import open_disks

# Iterations between looks at the pressure, and after which a relaxation counts as stalled.
_LOOK, _PATIENCE = 100, 50_000

# Largest step in smallest radii.
_LARGEST_STEP = 0.1

_CONJUGATE_GRADIENTS = """
min_style cg
min_modify line quadratic dmax {dmax!r} norm max
"""


def relax_on_ranks(
    packing: Packing, tolerance: float, loose: float, report: Report, comm: MPI.Comm
) -> RelaxedDisks:
    """As `relax_in_box`, shared by the ranks; the result depends on their number only.

    Walls and disks with radii of their own have no energy in LAMMPS: each rank relaxes them by
    itself.
    """
    if packing.walls or packing.particle_radii is not None:
        return relax_in_box(packing, tolerance, loose, report)
    smallest = float(packing.radius.min())
    facet = smallest ** (packing.dimension - 1)  # about that of a contact
    rounding = force_rounding(packing.box, stiffness=1.0)
    lmp = open_disks(packing, comm)
    try:
        run(lmp, _CONJUGATE_GRADIENTS.format(dmax=_LARGEST_STEP * smallest))
        run(lmp, "run 0 post no")
        for iterations in range(0, _PATIENCE + 1, _LOOK):
            pressure = float(np.trace(stress(lmp))) / packing.dimension
            largest = largest_force(lmp)
            bears = largest > rounding and pressure > 0.0
            residual = largest / (facet * pressure) if bears else 0.0
            relaxed = pressure <= loose or residual <= tolerance
            if relaxed or iterations == _PATIENCE:
                break
            run(lmp, minimize_command(0.0, _LOOK))
            report(_LOOK, packing.phi, pressure, residual)
        positions = gather(lmp, "x", 3)[:, : packing.dimension]
    finally:
        lmp.close()
    return RelaxedDisks(replace(packing, positions=positions), pressure, residual, not relaxed)

"""Jamming: the packing at the onset of rigidity, of soft disks or of deformable particles."""

from __future__ import annotations

import warnings

import numpy as np
from mpi4py import MPI

from ..common.errors import ParameterError, StalledWarning, UnjammedWarning
from ..common.progress import progress
from ..common.renamed import former_arguments
from ..common.validate import expect, positive
from ..engine.disks import Disks
from ..engine.simulation import Simulation
from ..model.laws import Law, Ring, Sector
from ..model.packing import Packing
from ..state.disk_state import DiskState
from ..state.state import State

# Energies only fall in a relaxation: one that is loose at a coarser tolerance need not go on, which
# saves time where forces fall slowly. Those of disks do not.
_STAGES = (1000.0, 100.0, 10.0, 1.0)

# Pressure of soft disks at which the start of a deformable packing counts as pushed apart.
_APART = 1e-6

# `push_off` ends at forces of 1e-3 of this pressure times the smallest radius: far below those of
# disks that touch at random.
_PUSHED_OFF = 1e-3

# A rearrangement may leave the pressure no value in the window: the bisection ends at this step.
_SMALLEST_STEP = 1e-10


@former_arguments(model="law")
def jam(
    packing: Packing,
    law: Law | None = None,
    pressure: float = 1e-6,
    step: float = 0.02,
    tolerance: float = 1e-3,
) -> Packing:
    """Compress particles from a loose start to the onset of rigidity.

    Overlaps of the start are pushed apart as soft disks. The packing is then compressed
    isotropically in steps of packing fraction and relaxed by FIRE after each one. Once the pressure
    exceeds the threshold, the last loose packing is taken up again with half the step, until the
    rigid one lies within a factor two above the threshold (bisection to the onset).

    Every rank of an MPI run does the same work: where a packing jams is chaotic, so sharing it out
    would make the result depend on the number of ranks.

    Args:
        packing: a packing below jamming, e.g. from `bidisperse`; overlaps are pushed apart.
        law: contact law; soft disks of the energy k/2 (R_i + R_j - d)^2 if not given.
        pressure: threshold of rigidity, in units of `natural_pressure`. How near to the onset that
            is depends on the law: disks have p ~ phi - phi_J, rings p ~ (phi - phi_J)^3.
        step: first step of packing fraction.
        tolerance: largest force on a particle over that of a contact at the threshold. To count
            contacts take 1e-6: the weakest ones bear little.

    Returns:
        The jammed packing; phi is about 0.84 for an equal mixture of sizes 1 : 1.4.

    Warns:
        StalledWarning: relaxations did not end; large packings of disks, and the sector law.

    Raises:
        ParameterError: the start is rigid already, or a value is out of range.

    Source: O'Hern, Silbert, Liu, Nagel, Phys. Rev. E 68, 011306 (2003); FIRE: Bitzek et al., Phys.
    Rev. Lett. 97, 170201 (2006).
    """
    expect("packing", packing, Packing)
    if law is not None:
        expect("law", law, Ring, Sector)
    positive("pressure", pressure)
    positive("step", step)
    positive("tolerance", tolerance)
    apart = _APART if law else pressure
    start = _relaxed(packing, None, apart, tolerance)
    if start.pressure > apart:
        raise ParameterError(
            f"packing is rigid already at phi = {packing.phi:.4f}: start from a lower phi"
        )
    loose, threshold = start.packing, pressure * natural_pressure(packing, law)
    stalled = start.stalled
    with progress("jamming", unit="trial") as bar:
        while True:
            trial = _relaxed(loose.at(loose.phi + step), law, threshold, tolerance)
            stalled |= trial.stalled
            bar.set_postfix(phi=f"{trial.phi:.6f}")
            bar.update()
            if trial.pressure <= threshold:
                loose = trial.packing
            elif trial.pressure <= 2.0 * threshold or step < _SMALLEST_STEP:
                break
            else:
                step /= 2.0
    if stalled:
        warnings.warn(
            f"relaxations stalled on the way to phi = {trial.phi:.6f}, the last one at a largest "
            f"force of {trial.residual:.2g} of the mean contact force: the onset of jamming is "
            "uncertain",
            StalledWarning,
            stacklevel=3,
        )
    return trial.packing


def push_off(packing: Packing) -> Packing:
    """Push overlapping disks apart, as soft ones, at the packing fraction that they have.

    Random places overlap deeper than a deformable particle can be dented. Soft disks have no such
    limit: what is left of the overlaps, at any packing fraction, is a start for `Simulation`.

    Args:
        packing: e.g. from `bidisperse`, with any overlaps.

    Returns:
        The packing with its disks at rest, where their forces balance.

    Warns:
        StalledWarning: forces are left that do not.
    """
    expect("packing", packing, Packing)
    pushed = _relaxed(packing, None, _PUSHED_OFF, 1e-3)
    if pushed.stalled:
        warnings.warn(
            f"disks were not parted to the end: the largest force is {pushed.residual:.2g} of the "
            "mean contact force",
            StalledWarning,
            stacklevel=2,
        )
    return pushed.packing


def natural_pressure(packing: Packing, law: Law | None) -> float:
    """The unit of pressure of a contact law [energy/length^2].

    It is k for soft disks, 1 here, and kA R0^2 kP/(kA R0^2 + kP) for deformable particles, the mean
    over them, with the mean radius R0. That is kA R0^2 where the perimeter is conserved, kP where
    the area is.
    """
    if law is None:
        return 1.0
    r0 = float(packing.radius.mean())
    kA, kP, _ = np.array(law.species(packing.radii.tolist())).T[:, packing.species]
    return float(np.mean(1.0 / (1.0 / (kA * r0**2) + 1.0 / kP)))


def simulate(packing: Packing, law: Law | None) -> Disks | Simulation:
    """Particles of a contact law, or soft disks, on this rank alone."""
    return Disks(packing) if law is None else Simulation(packing, law, MPI.COMM_SELF)


def _relaxed(
    packing: Packing, law: Law | None, pressure: float, tolerance: float
) -> DiskState | State:
    """The packing relaxed until it is loose, below a pressure, or else to the tolerance."""
    # contacts of a packing at this pressure bear about so much
    minimum_contact_force = pressure * float(packing.radius.min())
    with simulate(packing, law) as sim, warnings.catch_warnings():
        warnings.simplefilter("ignore", StalledWarning)  # `jam` says it once for all of them
        warnings.simplefilter("ignore", UnjammedWarning)  # as it should be below the onset
        for part in _STAGES if law else _STAGES[-1:]:
            state = sim.relax(part * tolerance, minimum_contact_force)
            if state.pressure <= pressure or state.stalled:
                break
    return state

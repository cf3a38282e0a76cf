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

# Factors of the tolerance in stages of a relaxation. The energy only falls: a packing that is loose
# after one stage needs no other one. This saves time for deformable particles, whose forces fall
# slowly; it does not for disks.
_STAGES = (1000.0, 100.0, 10.0, 1.0)

# Pressure of soft disks below which the start of a deformable packing counts as separated.
_SEPARATED = 1e-6

# Pressure of soft disks for `push_off`. It ends at forces of 1e-3 of this pressure times the
# smallest radius, far below those of disks at random positions.
_PUSHED_OFF = 1e-3

# A rearrangement may leave no packing between one and two thresholds: bisection ends at this step.
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

    The particles of the start are separated as soft disks. Then the packing is compressed
    isotropically in steps of packing fraction and relaxed by FIRE after each one. If the pressure
    exceeds the threshold, the step is halved and repeated from the last loose packing, until the
    pressure is above the threshold by at most a factor two (bisection to the onset).

    Every rank of an MPI run does the same work: relaxation near jamming is chaotic, so that results
    of shared work would depend on the number of ranks.

    Args:
        packing: a packing below jamming, e.g. from `bidisperse`, or from `Packing.between` with
            walls, which are scaled with the box; particles may overlap.
        law: contact law; soft disks of the energy k/2 (R_i + R_j - d)^2 if not given.
        pressure: threshold of rigidity, in units of `natural_pressure`. The distance to the onset
            depends on the law: p ~ phi - phi_J for disks, p ~ (phi - phi_J)^3 for rings.
        step: first step of packing fraction.
        tolerance: largest force on a particle over that of a contact at the threshold. Take 1e-6 to
            count contacts, because the weakest ones have small forces.

    Returns:
        The jammed packing; phi is about 0.84 for an equal mixture of sizes 1 : 1.4.

    Warns:
        StalledWarning: relaxations stalled, as in large packings of disks and with the sector law.

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
    separated = _SEPARATED if law else pressure
    start = _relaxed(packing, None, separated, tolerance)
    if start.pressure > separated:
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
            f"relaxations stalled on the way to phi = {trial.phi:.6f}, the last one with a largest "
            f"force of {trial.residual:.2g} of the mean contact force: the onset of jamming is "
            "uncertain",
            StalledWarning,
            stacklevel=3,
        )
    return trial.packing


def push_off(packing: Packing) -> Packing:
    """Relax particles as soft disks, at constant packing fraction, to reduce their overlaps.

    Disks at random positions overlap too deeply for contact lines in front of their centers. Soft
    disks have no such limit. The result is a start for `Simulation`, at any packing fraction.

    Args:
        packing: e.g. from `bidisperse`, with any overlaps; or from `Packing.between`, its walls
            repel the disks.

    Returns:
        The packing with balanced forces between its disks.

    Warns:
        StalledWarning: the forces are not balanced.
    """
    expect("packing", packing, Packing)
    pushed = _relaxed(packing, None, _PUSHED_OFF, 1e-3)
    if pushed.stalled:
        warnings.warn(
            f"separating the disks stalled: the largest force is {pushed.residual:.2g} of the mean "
            "contact force",
            StalledWarning,
            stacklevel=2,
        )
    return pushed.packing


def natural_pressure(packing: Packing, law: Law | None) -> float:
    """The unit of pressure of a contact law [energy/length^2].

        <kA R0^2 kP / (kA R0^2 + kP) + tension/R0>

    is the mean over deformable particles, with their mean radius R0: kA R0^2 if the perimeter is
    conserved, kP if the area is, tension/R0 of droplets. For soft disks it is their stiffness, 1.
    """
    if law is None:
        return 1.0
    r0 = float(packing.radius.mean())
    kA, kP, _, tension = law.species_parameters(packing.radii).of(packing.species)
    compliance = 1.0 / (kA * r0**2) + 1.0 / np.where(kP > 0.0, kP, np.inf)
    stiffness = np.where(kP > 0.0, 1.0 / np.where(compliance > 0.0, compliance, 1.0), 0.0)
    return float(np.mean(stiffness + tension / r0))


def simulate(packing: Packing, law: Law | None) -> Disks | Simulation:
    """A simulation of a contact law, or of soft disks, on this rank alone."""
    return Disks(packing) if law is None else Simulation(packing, law, MPI.COMM_SELF)


def _relaxed(
    packing: Packing, law: Law | None, pressure: float, tolerance: float
) -> DiskState | State:
    """The packing, relaxed until its pressure is below the given one, or else to the tolerance."""
    # about the contact force at this pressure
    minimum_contact_force = pressure * float(packing.radius.min())
    with simulate(packing, law) as sim, warnings.catch_warnings():
        warnings.simplefilter("ignore", StalledWarning)  # `jam` warns once for all
        warnings.simplefilter("ignore", UnjammedWarning)  # expected below the onset
        for part in _STAGES if law else _STAGES[-1:]:
            state = sim.relax(part * tolerance, minimum_contact_force)
            if state.pressure <= pressure or state.stalled:
                break
    return state

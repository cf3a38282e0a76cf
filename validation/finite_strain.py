"""Shear and bulk modulus of a packing, from its response to small strains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from lammps_deformable.common.box import refuse_space
from lammps_deformable.common.checks import expect, positive
from lammps_deformable.engine.moduli import following, tolerance_under, unbalanced_modulus
from lammps_deformable.engine.simulation import Simulation
from lammps_deformable.particles.laws import root
from lammps_deformable.protocols.shearing import sheared
from lammps_deformable.state.hessian import check_at_rest
from lammps_deformable.state.state import State
from mpi4py import MPI
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Callable

# Values at two strains, one twice the other, agree if they differ by at most this part of the
# modulus or of the pressure. A modulus below this part of the pressure counts as zero.
_AGREEMENT = 0.01

# Tolerance of relaxations at most.
_TOLERANCE = 1e-8

# Number of times that the strain is halved before the response counts as not linear.
_HALVINGS = 6


@dataclass(frozen=True)
class Modulus:
    """A modulus of linear response.

    Attributes:
        value: the modulus at the smallest strain [energy/length^d].
        strain: that strain.
        error: difference to the value at twice the strain, or what forces that remain may add if
            that is more [energy/length^d].
        linear: whether that is at most 1 % of the modulus or of the pressure.
    """

    value: float
    strain: float
    error: float
    linear: bool


def shear_modulus(
    state: State,
    strain: float,
    tolerance: float | None = None,
    pure: bool = False,
) -> Modulus:
    """G = d(shear stress)/d(shear strain) of a relaxed state, which does not change.

    The packing is sheared by the strain and by its opposite, each time from the state, and relaxed:
    half the difference of the stresses does not contain the stress of the state. The strain is
    halved until two values agree. `state.moduli` has the limit of small strains at once.

    Args:
        state: relaxed, with a pressure above zero or
            with films.
        strain: the first one. Contacts change at strains of some part of phi - phi_J, so that a
            hundredth of that is a good start.
        tolerance: of the relaxations: their largest force over the mean contact force; by default
            1e-4 of the strain, at most 1e-8. Forces that remain are an error of the stress.
        pure: stretch along x and shrink along y, at constant area, instead of simple shear along x.
            A small packing is not isotropic: its modulus varies as the sine of four times the
            direction. The mean of the two moduli is the mean over all directions.

    Returns:
        The modulus; negative if a packing is stable only because its box is fixed, as some are at
        onset.

    Raises:
        ParameterError: a value is out of range, or the state is not at rest (`residual` above
            1e-3).
    """
    expect("state", state, State)
    if pure:
        refuse_space("pure=True", state.packing.dimension, "turn the packing, and shear it along x")
    if not pure:
        return _modulus(state, strain, tolerance, sheared, lambda stress: -float(stress[0, 1]))
    return _modulus(
        state,
        strain,
        tolerance,
        lambda box, gamma: box * [1.0 + gamma / 2.0, 1.0 / (1.0 + gamma / 2.0)],
        lambda stress: float(stress[1, 1] - stress[0, 0]) / 2.0,
    )


def bulk_modulus(
    state: State,
    strain: float,
    tolerance: float | None = None,
) -> Modulus:
    """K = d(pressure)/d(compressive strain of the area) of a relaxed state, as `shear_modulus`.

    In three dimensions it is the strain of the volume.
    """
    expect("state", state, State)
    dimension = state.packing.dimension
    return _modulus(
        state,
        strain,
        tolerance,
        lambda box, compression: box * root(1.0 - compression, dimension),
        lambda stress: float(np.trace(stress) / dimension),
    )


def _modulus(
    state: State,
    strain: float,
    tolerance: float | None,
    deformed: Callable[[NDArray[np.float64], float], NDArray[np.float64]],
    component: Callable[[NDArray[np.float64]], float],
) -> Modulus:
    """Half the difference of a component of stress at two opposite strains, over the strain."""
    positive("strain", strain)
    check_at_rest(state.residual)
    before, zero = np.inf, _AGREEMENT * abs(state.pressure)
    for halving in range(_HALVINGS + 1):
        closely = tolerance_under(strain, _TOLERANCE) if tolerance is None else tolerance
        stresses, stalled, left = [], False, 0.0
        for sign in (1.0, -1.0):
            with (
                Simulation(state, state.law, comm=MPI.COMM_SELF) as sim,
                following(sim, state.packing, strain),
            ):
                sim.deform(deformed(sim.box, sign * strain))
                relaxed = sim.relax(closely)
            stresses.append(component(relaxed.pressure_tensor))
            stalled |= not relaxed.converged
            left = max(left, relaxed.residual)
        value = (stresses[0] - stresses[1]) / (2.0 * strain)
        unbalanced = unbalanced_modulus(state, left, strain)
        error, allowed = abs(value - before), max(_AGREEMENT * abs(value), zero)
        linear = max(error, unbalanced) <= allowed and not stalled
        if linear or stalled or unbalanced > allowed or halving == _HALVINGS:
            break
        before, strain = value, strain / 2.0
    return Modulus(value, strain, max(error, unbalanced), linear)

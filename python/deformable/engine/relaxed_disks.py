"""Relaxation of soft disks, in a box that is kept or at a pressure."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..model.packing import Packing
from .enthalpy import Enthalpy
from .lbfgs import minimize
from .relaxation import force_rounding

# Called every 20 iterations with their number, phi and the pressure.
Report = Callable[[int, float, float], object]

# Iterations after which a relaxation in a box counts as stalled; largest step in smallest radii.
_PATIENCE, _LARGEST_STEP = 20_000, 0.1


class RelaxedDisks(NamedTuple):
    """Soft disks after a relaxation.

    Attributes:
        packing: with the same shape of the box.
        pressure: of the disks [k].
        residual: largest force on a particle over the pressure times the smallest radius, which is
            about a contact force; 0 if it is rounding.
        stalled: whether the residual is above the tolerance.
    """

    packing: Packing
    pressure: float
    residual: float
    stalled: bool


def relax_in_box(
    packing: Packing,
    tolerance: float,
    loose: float,
    report: Report,
) -> RelaxedDisks:
    """Relax soft disks in their box, until the pressure is low or the forces are small.

    Args:
        packing: no two centers at one place.
        tolerance: largest residual.
        loose: pressure at which the packing is relaxed enough [k].
        report: see `Report`.
    """
    return _relax(packing, None, tolerance, loose, _PATIENCE, report)


def relax_at_pressure(
    packing: Packing,
    pressure: float,
    tolerance: float,
    patience: int,
    report: Report,
) -> RelaxedDisks:
    """Relax soft disks and the size of their box at a pressure [k], in so many iterations.

    See `relax_in_box`.
    """
    return _relax(packing, pressure, tolerance, -np.inf, patience, report)


def _relax(
    packing: Packing,
    applied: float | None,
    tolerance: float,
    loose: float,
    patience: int,
    report: Report,
) -> RelaxedDisks:
    enthalpy = Enthalpy(packing, applied)
    smallest = float(packing.radius.min())
    rounding = force_rounding(packing.box, stiffness=1.0)

    def residual(gradient: NDArray[np.float64]) -> float:
        forces = gradient[:-1].reshape(-1, 2)
        on_particles = math.sqrt(np.einsum("ij,ij->i", forces, forces).max())
        largest = max(on_particles, abs(float(gradient[-1])))
        scale = smallest * (enthalpy.pressure if applied is None else applied)
        return largest / scale if largest > rounding and scale > 0.0 else 0.0

    z, relaxed = minimize(
        enthalpy,
        enthalpy.start,
        lambda gradient: enthalpy.pressure <= loose or residual(gradient) <= tolerance,
        _LARGEST_STEP * smallest,
        patience,
        lambda count: report(count, enthalpy.phi, enthalpy.pressure),
        None if applied is None else enthalpy.preconditioner,
    )
    _, gradient = enthalpy(z)
    return RelaxedDisks(enthalpy.packing(z), enthalpy.pressure, residual(gradient), not relaxed)

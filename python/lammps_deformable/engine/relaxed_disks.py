"""Relaxation of soft disks or spheres, in a box that is kept or at a pressure."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core import norm
from ..model.lattice import fractional, lengths
from ..model.packing import Packing
from .damped import settle
from .enthalpy import Enthalpy
from .lbfgs import Floats, minimize
from .relaxation import force_rounding

# Called every 20 iterations with their number, phi, the pressure and the residual.
Report = Callable[[int, float, float, float], object]

# Iterations after which a relaxation in a box counts as stalled; largest step in smallest radii.
_PATIENCE, _LARGEST_STEP = 20_000, 0.1

# From this number on a minimizer with one line search for all disks hardly moves, because contacts
# form somewhere: `settle_at_pressure` is better. And disks are sorted in rows: an evaluation finds
# near ones in the cache, which takes half the time.
HUGE = 30_000


class RelaxedDisks(NamedTuple):
    """Soft disks after a relaxation.

    Attributes:
        packing: with the same shape of the box.
        pressure: of the disks [k], of spheres [k/length].
        residual: largest force on a particle over the pressure times the smallest radius, of
            spheres its square, which is about a contact force; 0 if it is rounding.
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
    rigid: tuple[float, float] | None = None,
) -> RelaxedDisks:
    """Relax soft disks in their box, until the pressure is low or the forces are small.

    Args:
        packing: no two centers at one place.
        tolerance: largest residual.
        loose: pressure at which the packing is relaxed enough [k].
        report: see `Report`.
        rigid: a pressure [k]; above it the packing is relaxed enough where the root mean square of
            the forces on particles, in the unit of the residual, is at most the other number.
    """
    return _relax(packing, None, tolerance, _PATIENCE, report, loose, rigid)


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
    return _relax(packing, pressure, tolerance, patience, report)


def settle_at_pressure(
    packing: Packing, pressure: float, tolerance: float, patience: int, report: Report
) -> RelaxedDisks:
    """As `relax_at_pressure`, by damped motion: for residuals that are not tiny."""
    return _relax(packing, pressure, tolerance, patience, report, damped=True)


def _relax(
    packing: Packing,
    applied: float | None,
    tolerance: float,
    patience: int,
    report: Report,
    loose: float = -math.inf,
    rigid: tuple[float, float] | None = None,
    damped: bool = False,
) -> RelaxedDisks:
    order = _rows(packing) if len(packing) >= HUGE else np.arange(len(packing))
    enthalpy = Enthalpy(_reordered(packing, order), applied)
    smallest = float(packing.radius.min())
    facet = smallest ** (packing.dimension - 1)  # about that of a contact
    rounding = force_rounding(packing.box, stiffness=1.0)
    last = math.inf

    def residual(gradient: Floats) -> float:
        forces = gradient[:-1].reshape(-1, packing.dimension)
        on_particles = float(lengths(forces).max())
        largest = max(on_particles, abs(float(gradient[-1])))
        scale = facet * (enthalpy.pressure if applied is None else applied)
        return largest / scale if largest > rounding and scale > 0.0 else 0.0

    def relaxed(gradient: Floats) -> bool:
        nonlocal last
        last = residual(gradient)
        if rigid and enthalpy.pressure >= rigid[0]:
            bearing = rigid[1] * facet * enthalpy.pressure
            if norm(gradient) <= bearing * math.sqrt(len(packing)):
                return True
        return enthalpy.pressure <= loose or last <= tolerance

    def tell(count: int) -> None:
        report(count, enthalpy.phi, enthalpy.pressure, last)

    start, largest_step = enthalpy.start, _LARGEST_STEP * smallest
    if damped:
        mass, softest = enthalpy.mass, enthalpy.softest
        z, enough = settle(enthalpy, start, mass, softest, relaxed, largest_step, patience, tell)
    else:
        inverse = None if applied is None else enthalpy.preconditioner
        z, enough = minimize(enthalpy, start, relaxed, largest_step, patience, tell, inverse)
    _, gradient = enthalpy(z)
    found = _reordered(enthalpy.packing(z), np.argsort(order))
    return RelaxedDisks(found, enthalpy.pressure, residual(gradient), not enough)


def _rows(packing: Packing) -> NDArray[np.int64]:
    """The order of disks in rows along x, each about a diameter high."""
    x, y = fractional(packing.positions, packing.box).T[:2] % 1.0
    return np.lexsort((x, np.floor(y * math.sqrt(len(packing)))))


def _reordered(packing: Packing, order: NDArray[np.int64]) -> Packing:
    radii = packing.particle_radii
    return replace(
        packing,
        positions=packing.positions[order],
        species=packing.species[order],
        particle_radii=None if radii is None else radii[order],
    )

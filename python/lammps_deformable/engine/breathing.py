"""Relaxation of centers and radii: particles that breathe.

Centers r and radii R minimize together

    F = U(r, R) + stiffness/2 sum (R_i - R_i0)^2

from the radii R_i0 at the start, where sums of powers R_i^m stay what they are: that of the
dimension, so that the packing fraction is kept, and those of the moments that are asked for. The
centers are relaxed at each set of radii. So the derivatives of F by radii are those of U at given
centers, and of the springs. Radii are y_i + sum_m l_m m y_i^(m-1) of free variables y, with the l_m
that keep the sums.

Source: C. Brito, E. Lerner, M. Wyart, Phys. Rev. X 8, 031050 (2018); V. F. Hagh, S. R. Nagel, A. J.
Liu, M. L. Manning, E. I. Corwin, Proc. Natl. Acad. Sci. USA 119, e2117622119 (2022).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.checks import numbers, shown, zero_or_more
from ..common.errors import ParameterError, StalledWarning, UnjammedWarning, warn
from ..particles.laws import Droplet, Ring, SoftContact
from ..state.derivatives import Derivatives
from ..state.law_terms import terms_of
from .free_box import told_at_the_end
from .soft_disks import minimize

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..state.state import State
    from .simulation import Simulation

Floats = NDArray[np.float64]

# Longest change of a radius in a step over the mean radius; steps at most.
_LONGEST, _STEPS = 0.02, 2000

# A mean contact force that has fallen to this part is that of a packing that has come apart.
_APART = 1e-6


def relax_radii(
    sim: Simulation,
    stiffness: float,
    moments: ArrayLike,
    tolerance: float,
    max_steps: int | None,
    relax: Callable[[], State],
) -> State:
    """Relax centers and radii.

    Args:
        sim: ends in the state that is returned.
        stiffness: of the springs of radii [energy/length^2].
        moments: powers m whose sums are kept, beside the dimension.
        tolerance: largest derivative of F by a free radius, over the mean contact force.
        max_steps: of radii at most.
        relax: relaxes `sim` at its radii.

    Raises:
        ParameterError: a value is out of range; or the law has no derivatives by radii; or there
            are too few different radii for so many moments.

    Warns:
        StalledWarning: the derivatives by radii stay above the tolerance.
        UnjammedWarning: the radii have found places where nothing touches any more.
    """
    if not isinstance(sim.law, Ring | SoftContact | Droplet):
        raise ParameterError(
            f"the energy of {type(sim.law).__name__} has no derivatives by radii: take Ring, "
            "SoftContact or Droplet"
        )
    if sim.friction:
        raise ParameterError("friction has no energy to vary radii with: leave it out")
    zero_or_more("stiffness", stiffness)
    radii = Radii(sim.packing.radii, sim.dimension, moments)
    return told_at_the_end(
        lambda relax: _minimize(sim, stiffness, radii, tolerance, max_steps, relax), relax
    )


class Radii:
    """Radii R(y) = y + sum_m l_m m y^(m-1) that keep sums of powers m.

    Args:
        start: radii that have the sums, shape (N,) [length].
        dimension: the power that is always kept.
        moments: others.

    Raises:
        ParameterError: a moment is 0, or the sums leave the radii no freedom.
    """

    def __init__(self, start: Floats, dimension: int, moments: ArrayLike) -> None:
        given = numbers("moments", moments)
        powers = np.unique(np.append(given, dimension))
        if given.ndim > 1 or np.any(given == 0.0):
            raise ParameterError(
                f"moments must be powers of the radius other than 0, not {shown(moments)}"
            )
        different = len(np.unique(start))
        if different < len(powers) or len(start) <= len(powers):
            raise ParameterError(
                f"{len(powers)} sums of powers of the radii cannot be kept with {len(start)} "
                f"particles of {different} different radii: take fewer moments, or radii of a "
                "distribution"
            )
        self.length = float(start.mean())  # all else has this unit
        self.start, self._powers = start / self.length, powers[:, None]
        self._sums = np.sum(self.start**self._powers, axis=1)

    def _slopes(self, radii: Floats) -> Floats:
        """Of the sums, shape (m, N)."""
        slopes: Floats = self._powers * radii ** (self._powers - 1.0)
        return slopes

    def at(self, y: Floats) -> tuple[Floats, Callable[[Floats], Floats]] | None:
        """R(y) [length], and what makes derivatives by y of those by R.

        The sums stay: with b their slopes at R and a those at y

            dR = (1 + D) dy + a^T dl,   D = sum_m l_m m (m-1) y^(m-2),   b dR = 0

        None if Newton's method finds no such radii.
        """
        a, shares = self._slopes(y), np.zeros(len(self._powers))
        for _ in range(50):
            radii = y + shares @ a
            if not np.all(radii > 0.0):
                return None
            b = self._slopes(radii)
            missing = np.sum(radii**self._powers, axis=1) - self._sums
            if np.all(np.abs(missing) <= 1e-14 * self._sums):
                break
            shares -= np.linalg.solve(b @ a.T, missing)
        else:
            if np.any(np.abs(missing) > 1e-10 * self._sums):
                return None
        stretch = 1.0 + shares @ (self._powers * (self._powers - 1.0) * y ** (self._powers - 2.0))

        def pulled(by_radii: Floats) -> Floats:
            kept: Floats = by_radii - b.T @ np.linalg.solve(a @ b.T, a @ by_radii)
            return stretch * kept

        return self.length * radii, pulled


def _minimize(
    sim: Simulation,
    stiffness: float,
    radii: Radii,
    tolerance: float,
    max_steps: int | None,
    relax: Callable[[], State],
) -> State:
    """See `relax_radii`; the state of the last radii."""
    state, slope = relax(), np.inf
    unit = _mean_force(state)  # of derivatives; energies have it times the mean radius

    def objective(y: Floats) -> tuple[float, Floats]:
        nonlocal state, slope
        found = radii.at(y)
        if found is None:
            return np.inf, np.zeros_like(y)
        of, pulled = found
        sim.reset(replace(state, packing=state.packing.replace(radii=of)))
        state = relax()
        change = of - radii.length * radii.start
        by_radii = Derivatives(terms_of(state), "radii").vjp(energy=1.0)
        slopes = pulled(by_radii + stiffness * change)
        slope = float(np.abs(slopes).max())
        energy = state.energy + 0.5 * stiffness * float(change @ change)
        return energy / (unit * radii.length), slopes / unit

    def is_relaxed(_: Floats) -> bool:
        force = _mean_force(state)
        return slope <= tolerance * force or force <= _APART * unit

    if unit == 0.0:
        return state
    steps = _STEPS if max_steps is None else max_steps
    _, relaxed = minimize(objective, radii.start, is_relaxed, _LONGEST, steps)
    force = _mean_force(state)
    if force <= _APART * unit:
        warn(
            f"the packing came apart: with these radii forces are {force / unit:.2g} of those "
            "before; take a larger stiffness, or a higher packing fraction",
            UnjammedWarning,
        )
    elif not relaxed:
        warn(
            f"radii stalled: the largest derivative of the energy by one is {slope / force:.2g} of "
            f"the mean contact force, not {tolerance:g}",
            StalledWarning,
        )
    return replace(state, converged=state.converged and relaxed)


def _mean_force(state: State) -> float:
    """Of the contacts of a state [energy/length]."""
    return float(state.contacts["force"].mean()) if len(state.contacts) else 0.0

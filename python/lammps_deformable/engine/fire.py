"""Calls of FIRE, one after the other, whose time steps and lengths follow the packing."""

from __future__ import annotations

import numpy as np

from .relaxation import minimize_command

# FIRE starts from this part of 1/sqrt(p), p the largest pressure in a particle (mass 1), and may
# stretch it tenfold. Measured, N = 40 and 128: 0.03 is the fastest, 0.04 three times slower.
_TIMESTEP = 0.02

# The time step follows the pressure, which falls by decades. Once it falls by less than a factor
# two in a call of the minimizer, the next call is twice as long: soft modes need many iterations.
_ITERATIONS = 2000


class Fire:
    """The calls of one relaxation."""

    def __init__(self) -> None:
        self._highest, self.iterations = np.inf, _ITERATIONS

    def call(self, highest: float, stiffest: float, force: float) -> str:
        """The commands of a call, of at most so many `iterations`.

        Args:
            highest: pressure in a particle [energy/length^2].
            stiffest: the same, or what replaces it in the time step.
            force: it stops once no component of a force is above this one [energy/length].
        """
        before, self._highest = self._highest, highest
        self.iterations = _ITERATIONS if highest < 0.5 * before else 2 * self.iterations
        timestep = float(_TIMESTEP / np.sqrt(stiffest))
        return f"timestep {timestep!r}\n{minimize_command(float(force), self.iterations)}"

"""Damped motion to a minimum: for very many particles, of which some rearrange at any time."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from .lbfgs import Floats, Function

# Time step, where the highest frequency is about 2.5.
_TIMESTEP = 0.5

# Steps between looks at the gradient.
_LOOK = 20


def settle(
    function: Function,
    z: Floats,
    mass: Floats,
    softest: float,
    relaxed: Callable[[Floats], bool],
    largest_step: float,
    patience: int,
    report: Callable[[int], object],
) -> tuple[Floats, bool]:
    """Move by m z'' = -df/dz - 2 sqrt(softest) m z' until the gradient is small.

    Modes of the stiffness `softest` are damped critically. A minimizer has one line search for all
    particles: contacts that form at one place keep all others from moving. Here each place moves
    as fast as it would alone.

    Args:
        function: value and gradient at a point.
        z: start.
        mass: of each variable, so that all have stiffnesses near 1 or less.
        softest: stiffness of the softest modes over their mass.
        relaxed: whether a gradient is small enough.
        largest_step: of each variable in a step.
        patience: largest number of steps.
        report: called with the number of steps since it was called last.

    Returns:
        The last point, and whether it is relaxed.
    """
    keep = max(1.0 - 2.0 * math.sqrt(softest) * _TIMESTEP, 0.0)
    push, fastest = _TIMESTEP / mass, largest_step / _TIMESTEP
    velocity = np.zeros_like(z)
    for step in range(patience):
        _, gradient = function(z)
        if step % _LOOK == 0:
            report(_LOOK if step else 0)
            if relaxed(gradient):
                return z, True
        velocity *= keep
        velocity -= push * gradient
        np.clip(velocity, -fastest, fastest, out=velocity)
        z = z + _TIMESTEP * velocity
    _, gradient = function(z)
    return z, relaxed(gradient)

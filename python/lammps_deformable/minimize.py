"""Minimization by L-BFGS, if asked with a factored Hessian that is renewed now and then.

Damped motion to a minimum: for very many particles, of which some rearrange at any time.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .core import dot, norm

Floats = NDArray[np.float64]

# Steps that are remembered.
_MEMORY = 12

# Iterations after which the preconditioner is renewed.
_LIFETIME = 20

# First part of the gradient that is tried as a step.
_FIRST = 0.2

# A step must reduce the value by this part of what the slope predicts (Armijo), or else, where
# rounding hides that, the slope by a tenth.
_DECREASE, _SLOPE, _ROUNDING = 1e-4, 0.9, 1e-10

# Evaluations along one direction, and directions in a row that fail.
_TRIALS, _FAILURES = 12, 4


# Value and gradient at a point; product of a gradient with an approximate inverse of the Hessian.
Function = Callable[[Floats], tuple[float, Floats]]
Inverse = Callable[[Floats], Floats]


def minimize(
    function: Function,
    z: Floats,
    relaxed: Callable[[Floats], bool],
    largest_step: float,
    patience: int,
    report: Callable[[int], object] = lambda iterations: None,
    preconditioner: Callable[[Floats], Inverse] | None = None,
) -> tuple[Floats, bool]:
    """Minimize a function.

    Args:
        function: it is evaluated last at the point that is returned.
        z: start.
        relaxed: whether a gradient, that of the last evaluation, is small enough.
        largest_step: of each variable in an iteration.
        patience: largest number of iterations.
        report: called every 20 iterations with their number.
        preconditioner: makes an approximate inverse of the Hessian at a point.

    Returns:
        The last point, and whether it is relaxed.

    Source: Nocedal and Wright, Numerical Optimization (2006), chapter 7.
    """
    steps: deque[tuple[Floats, Floats, float]] = deque(maxlen=_MEMORY)
    precondition: Inverse | None = None
    value, gradient = function(z)
    renewal = failures = 0
    for iteration in range(patience):
        if relaxed(gradient):
            return z, True
        if iteration % _LIFETIME == _LIFETIME - 1:
            report(_LIFETIME)
        if preconditioner and iteration >= renewal:
            precondition, renewal = preconditioner(z), iteration + _LIFETIME
            steps.clear()
        direction = _direction(gradient, steps, precondition)
        direction *= min(1.0, largest_step / float(np.abs(direction).max(initial=1e-300)))
        slope = dot(gradient, direction)
        found = _search(function, z, value, direction, slope) if slope < 0.0 else None
        if found is None:
            failures, renewal = failures + 1, iteration
            steps.clear()
            if failures == _FAILURES:
                break
            continue
        failures = 0
        step, change = found[0] - z, found[2] - gradient
        curvature = dot(step, change)
        if curvature > 1e-14 * norm(step) * norm(change):
            steps.append((step, change, 1.0 / curvature))
        z, value, gradient = found
    _, gradient = function(z)
    return z, relaxed(gradient)


def _direction(
    gradient: Floats,
    steps: deque[tuple[Floats, Floats, float]],
    precondition: Inverse | None,
) -> Floats:
    """Minus the gradient times the inverse Hessian that the steps and preconditioner tell."""
    q, weights = -gradient, []
    for step, change, inverse in reversed(steps):
        weights.append(inverse * dot(step, q))
        q -= weights[-1] * change
    if precondition is not None:
        q = precondition(q)
    elif steps:
        _, change, inverse = steps[-1]
        q /= inverse * dot(change, change)
    else:
        q *= _FIRST
    for (step, change, inverse), weight in zip(steps, reversed(weights), strict=True):
        q += (weight - inverse * dot(change, q)) * step
    return q


def _search(
    function: Function, z: Floats, value: float, direction: Floats, slope: float
) -> tuple[Floats, float, Floats] | None:
    """Point, value and gradient of a step along a direction; None if none is good enough."""
    part = 1.0
    for _ in range(_TRIALS):
        there = z + part * direction
        new, gradient = function(there)
        flatter = dot(gradient, direction)
        if new <= value + _DECREASE * part * slope or (
            abs(flatter) <= _SLOPE * abs(slope) and new <= value * (1.0 + _ROUNDING)
        ):
            return there, new, gradient
        # where the slope, taken as linear, is zero
        zero = part * slope / (slope - flatter) if flatter > slope else 0.5 * part
        part = min(max(zero, 0.1 * part), 0.6 * part)
    return None


# Time step, where the highest frequency is about 2.5.
_DAMPED_TIMESTEP = 0.5

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
    keep = max(1.0 - 2.0 * math.sqrt(softest) * _DAMPED_TIMESTEP, 0.0)
    push, fastest = _DAMPED_TIMESTEP / mass, largest_step / _DAMPED_TIMESTEP
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
        z = z + _DAMPED_TIMESTEP * velocity
    _, gradient = function(z)
    return z, relaxed(gradient)

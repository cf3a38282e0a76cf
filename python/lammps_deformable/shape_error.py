"""Distance of the outline of a contact law from the beads of a ring."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .core import angles, unit_vectors
from .errors import ParameterError

# Corners that coincide may differ in direction by rounding [rad].
_ROUNDING = 1e-12


def radial_distance(outline: ArrayLike, angle: ArrayLike) -> NDArray[np.float64]:
    """Distance g(theta) of an outline from the origin.

    Args:
        outline: corners of a polygon around the origin, counterclockwise, shape (m, 2) [length].
        angle: directions theta, shape (k,) [rad].

    Returns:
        Distance at which each ray crosses the polygon, shape (k,) [length].

    Raises:
        ParameterError: a ray crosses the polygon more than once: the particle is beyond the model.
    """
    corners = np.asarray(outline, dtype=np.float64)
    turn = angles(corners)
    start = int(turn.argmin())
    corners = np.roll(corners, -start, axis=0)
    turn = np.roll(turn, -start)
    steps = np.diff(turn, append=turn[0] + 2.0 * np.pi)
    if not ((steps > -_ROUNDING) & (steps < np.pi)).all():
        raise ParameterError(
            "an outline must go once around its center, counterclockwise and without turning back"
        )
    ray = np.asarray(angle, dtype=np.float64)
    ray = (ray - turn[0]) % (2.0 * np.pi) + turn[0]
    side = np.searchsorted(turn, ray, side="right") - 1
    a, b = corners[side], corners[(side + 1) % len(corners)]
    edge = b - a
    x, y = unit_vectors(ray).T
    across = x * edge[:, 1] - y * edge[:, 0]
    return np.asarray((a[:, 0] * edge[:, 1] - a[:, 1] * edge[:, 0]) / across)


def deviation(beads: ArrayLike, outline: ArrayLike) -> NDArray[np.float64]:
    """|v| - g(theta) of each bead v, shape (N_v,) [length].

    Args:
        beads: positions about the center of the outline, shape (N_v, 2) [length].
        outline: as for `radial_distance`, of the line of bead centers in the law.
    """
    v = np.asarray(beads, dtype=np.float64)
    return np.hypot(v[:, 0], v[:, 1]) - radial_distance(outline, angles(v))


def shape_error(beads: ArrayLike, outline: ArrayLike, radius: float) -> float:
    """I = 1/(R N_v) sum | |v| - g(theta) |, arguments as for `deviation`, R the radius."""
    return float(np.mean(np.abs(deviation(beads, outline))) / radius)

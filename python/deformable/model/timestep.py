"""Time steps that the contacts of a packing allow."""

from __future__ import annotations

import numpy as np

from .laws import Law
from .packing import Packing

# Energies are quartic in the indentation a: S ~ K a^2/2, p = kA S, L = K a, so that a contact has
# the stiffness d(p L)/da = 3 K p whatever the law, with K about 15.
STIFFNESS_PER_PRESSURE = 50.0

# Verlet is stable up to dt = 2/omega. Contacts of stiffness k give at most omega^2 = 6 k, all
# neighbours of a triangular lattice moving against the particle (mass 1).
_STABLE = 2.0 / np.sqrt(6.0 * STIFFNESS_PER_PRESSURE)

# The default is this part of the longest stable step. Kinetic energies of oscillators are wrong by
# (omega dt)^2/8 then, 2 % for the very stiffest.
_ACCURATE = 0.2

# Energy that collisions may gather in one particle, over the temperature: a probability of e^-10.
_HOT = 10.0

# Particles at rest that press less than this part of their stiffness do not move: any step will do.
_AT_REST = 1e-12


def accurate_step(packing: Packing, law: Law, pressure: float, temperature: float) -> float:
    """The time step of `move` if none is given [time]; the minimizer's is about the same.

    Arguments as for `longest_step`.
    """
    return _ACCURATE * longest_step(packing, law, pressure, temperature)


def longest_step(packing: Packing, law: Law, pressure: float, temperature: float) -> float:
    """The longest stable time step [time].

    Contacts are as stiff as the pressure p of their particles, which is that of the hardest one or
    what a hot one can reach: U >= p^2 / (2 kA), and U >= (p R)^2 / (2 kP).

    Args:
        packing: the particles.
        law: their contact law.
        pressure: the largest pressure inside a particle [energy/length^2].
        temperature: of the motion [energy].
    """
    kinds = len(packing.radii)
    kA, kP, skin = (
        np.broadcast_to(values, kinds)[packing.species]
        for values in (law.kA, law.kP, law.skins(kinds))
    )
    stiffness = float(np.minimum(kA, kP / (packing.radius - skin) ** 2).max())
    hot = np.sqrt(2.0 * stiffness * _HOT * temperature)
    at_rest = _AT_REST * stiffness * float(packing.radius.min()) ** 2
    return float(_STABLE / np.sqrt(max(pressure, hot, at_rest)))

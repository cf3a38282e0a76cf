"""Time steps that the contacts of a packing allow."""

from __future__ import annotations

import numpy as np

from .droplet import AnyLaw, Droplet
from .packing import Packing

# Energies are quartic in the indentation a: S ~ K a^2/2, p = kA S, L = K a. So a contact has the
# stiffness d(p L)/da = 3 K p for any law, with K about 15.
STIFFNESS_PER_PRESSURE = 50.0

# Verlet is stable up to dt = 2/omega. Contacts of stiffness k give omega^2 = 6 k at most, where all
# neighbors of a triangular lattice move against the particle (mass 1).
_STABLE = 2.0 / np.sqrt(6.0 * STIFFNESS_PER_PRESSURE)

# The default is this part of the longest stable step. The kinetic energy of an oscillator is then
# wrong by (omega dt)^2/8, which is 2 % for the stiffest one.
ACCURATE = 0.2

# Energy of one particle over the temperature that collisions exceed with a probability of e^-10.
_HOT = 10.0

# A contact of the indentation a has p = kA K a^2/2 and the force F = p K a, so that
# p = _BY_FORCE (kA F^2)^(1/3). Forces on many particles add up in a contact to so many of them.
_BY_FORCE = (1.0 / (2.0 * 15.0)) ** (1.0 / 3.0)
_TOGETHER = 10.0

# The largest eigenvalue of the Hessian of droplets over their tension, about, by their load x: no
# less than random packings and fcc, bcc and sc crystals have
# (tests/python/protocols/test_space_motion.py). A droplet with the energy U above rest has a load
# of up to (U / (tension R^2))^(1/2) / 2.
_LOOSE, _BY_LOAD = 12.0, 380.0

# Smallest pressure that limits the step, over the stiffness: particles at rest do not move.
_AT_REST = 1e-12


def accurate_step(packing: Packing, law: AnyLaw, squeeze: float, temperature: float) -> float:
    """The default time step of `move` [time]; that of the minimizer is about the same.

    Arguments as for `longest_step`.
    """
    return ACCURATE * longest_step(packing, law, squeeze, temperature)


def longest_step(packing: Packing, law: AnyLaw, squeeze: float, temperature: float) -> float:
    """The longest stable time step [time].

    The stiffness of contacts is proportional to the pressure p of their particles. The largest p is
    the present one, or that of a particle with much thermal energy U: U >= p^2 / (2 kA) and
    U >= (p R)^2 / (2 kP). With a tension p = tension/R + p', where U >= p'^2 R^3 / (4 tension) too:
    six contacts have U = 34 tension a^2/R and p' = 11 tension a/R^2 at the indentation a.

    In three dimensions it follows from the largest load of a droplet.

    Args:
        packing: the particles.
        law: their contact law.
        squeeze: the largest pressure inside a particle [energy/length^2]; of droplets in three
            dimensions the largest load.
        temperature: of the motion [energy].
    """
    if isinstance(law, Droplet):
        tension = law.species_parameters(packing.radii).of(packing.species).tension
        energy = float(np.min(tension * packing.radius**2))
        load = max(squeeze, 0.5 * float(np.sqrt(_HOT * temperature / energy)))
        return float(2.0 / np.sqrt((_LOOSE + _BY_LOAD * load) * tension.max()))
    kA, kP, skin, tension = law.species_parameters(packing.radii).of(packing.species)
    radius = packing.radius - skin
    by_tension = 2.0 * tension / radius**3
    stiffness = np.minimum(kA, kP / radius**2 + by_tension)
    hot = float((tension / radius + np.sqrt(2.0 * stiffness * _HOT * temperature)).max())
    at_rest = _AT_REST * float(stiffness.max()) * float(packing.radius.min()) ** 2
    return float(_STABLE / np.sqrt(max(squeeze, hot, at_rest)))


def longest_overdamped_step(
    packing: Packing, law: AnyLaw, squeeze: float, temperature: float, friction: float
) -> float:
    """The longest stable time step of dr/dt = F/friction by Euler's method [time].

    A mode of the stiffness k is stable up to 2 friction/k, in Verlet's method up to 2/k^(1/2): half
    the square of that step, but stiffnesses are overestimated. Crystals, the stiffest packings, are
    stable up to five times this step. Of droplets in space they are not, and it is half as long as
    the stable one.

    Args:
        packing: the particles.
        law: their contact law.
        squeeze: as for `longest_step`.
        temperature: of the motion [energy].
        friction: force over velocity [1/time].
    """
    part = 0.25 if isinstance(law, Droplet) else 1.0
    return part * friction * longest_step(packing, law, squeeze, temperature) ** 2


def squeeze_under(force: float, packing: Packing, law: AnyLaw) -> float:
    """Pressure in particles that are driven by a force each, or load of droplets in space.

    Args:
        force: on a particle [energy/length].
        packing: the particles.
        law: their contact law.
    """
    if not force:
        return 0.0
    kA, kP, skin, tension = law.species_parameters(packing.radii).of(packing.species)
    radius = packing.radius - skin
    if isinstance(law, Droplet):  # two contacts
        return float(np.max(2.0 * _TOGETHER * force / (8.0 * np.pi * tension * radius)))
    stiffness = np.minimum(kA, (kP + 2.0 * tension / radius) / radius**2)
    pushed = _BY_FORCE * np.cbrt(stiffness * (_TOGETHER * force) ** 2)
    return float((tension / radius + pushed).max())

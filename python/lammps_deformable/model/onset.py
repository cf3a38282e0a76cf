"""How the pressure of a packing rises above the onset of jamming, about."""

from __future__ import annotations

import numpy as np

from .droplet import AnyLaw, Droplet
from .laws import Law
from .packing import Packing

# Pressures p in natural units over x = phi - phi_J: 0.4 x for disks, x for droplets, 5 x^3 for
# rings; in three dimensions droplets have x = 0.8 p ln(1 + 1/p).
_DISKS, _DROPLETS, _RINGS, _IN_SPACE = 0.4, 1.0, 5.0, 0.8

# Iterations for the inverse of the last one, which come closer by 1/((1 + p) ln(1 + 1/p)) each.
_INVERTED = 100


def natural_pressure(packing: Packing, law: AnyLaw | None) -> float:
    """The unit of pressure of a contact law [energy/length^2].

        <kA R0^2 kP / (kA R0^2 + kP) + tension/R0>

    is the mean over deformable particles, with their mean radius R0: kA R0^2 if the perimeter is
    conserved, kP if the area is, tension/R0 of droplets. For soft disks it is their stiffness, 1,
    for soft spheres 1/(2 R0).
    """
    r0 = float(packing.radius.mean())
    if law is None:
        return 1.0 if packing.dimension == 2 else 0.5 / r0
    kA, kP, _, tension = law.species_parameters(packing.radii).of(packing.species)
    compliance = 1.0 / (kA * r0**2) + 1.0 / np.where(kP > 0.0, kP, np.inf)
    stiffness = np.where(kP > 0.0, 1.0 / np.where(compliance > 0.0, compliance, 1.0), 0.0)
    return float(np.mean(stiffness + tension / r0))


def excess_phi(p: float, packing: Packing, law: AnyLaw | None) -> float:
    """phi - phi_J at a pressure p in natural units.

    p = 5 x^3 of rings, p = x of droplets, p = 0.4 x of disks; x = 0.8 p ln(1 + 1/p) of
    droplets in three dimensions.
    """
    if law is None:
        return p / _DISKS
    if isinstance(law, Droplet):
        return float(_IN_SPACE * p * np.log1p(1.0 / p)) if p > 0.0 else 0.0
    return p / _DROPLETS if _droplets(packing, law) else (max(p, 0.0) / _RINGS) ** (1.0 / 3.0)


def pressure_above_onset(excess: float, packing: Packing, law: AnyLaw | None) -> float:
    """The pressure in natural units at this phi - phi_J, the inverse of `excess_phi`."""
    if law is None:
        return _DISKS * excess
    if isinstance(law, Droplet):
        pressure = excess
        for _ in range(_INVERTED):
            pressure = excess / (_IN_SPACE * float(np.log1p(1.0 / pressure)))
        return pressure
    return _DROPLETS * excess if _droplets(packing, law) else _RINGS * excess**3


def _droplets(packing: Packing, law: Law) -> bool:
    return bool(np.all(law.species_parameters(packing.radii).tension > 0.0))

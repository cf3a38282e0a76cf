"""Rings of beads as settings: the deformable-polygon model that the contact laws stand in for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import ParameterError
from .packing import positive


@dataclass(frozen=True)
class Beads:
    """The deformable-polygon model: rings of beads, joined by springs around a soft area.

        U = kL/2 sum (L - L0)^2 + kA/2 sum (A - A0)^2 + kr/2 sum (2p - |v - v'|)^2

    over all springs, all rings, and all overlapping beads of different rings. At rest a particle
    of radius R is a regular polygon of circumradius R - p, so that its beads reach out to R.

    Args:
        number: beads on a ring of the smallest species; larger ones get more, N_v ~ R - p. Or a
            number for each species.
        radius: p, of a bead [length].
        kL: stiffness of a spring [energy/length^2]; the perimeter of a ring has kP = kL/N_v.
        kA: stiffness of the area of a ring [energy/length^4].
        kr: stiffness of the contact of two beads [energy/length^2].

    Raises:
        ParameterError: a value is not positive, or a ring has fewer than 3 beads.

    Source: Boromand et al., Phys. Rev. Lett. 121, 248003 (2018); R. Maharana, "Efficient
    Simulation of Deformable Particles", whose rest area lacks a factor cos(pi/N_v).
    """

    number: int | Sequence[int] = 50
    radius: float = 0.05
    kL: float = 300.0
    kA: float = 1.0
    kr: float = 30.0

    def __post_init__(self) -> None:
        for name in ("radius", "kL", "kA", "kr"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))
        counts = np.atleast_1d(np.asarray(self.number))
        whole = counts.ndim == 1 and counts.dtype.kind in "iuf" and np.isfinite(counts).all()
        if not (whole and (counts == np.rint(counts)).all() and (counts >= 3).all()):
            raise ParameterError(
                f"a ring needs a whole number of beads, at least 3, not {self.number}"
            )

    def rings(self, radii: NDArray[np.float64]) -> Rings:
        """The undeformed rings of species of these radii [length].

        Raises:
            ParameterError: beads too large for a particle, or so few that others slip through
                between them.
        """
        ring = radii - self.radius
        if not (ring > self.radius).all():
            raise ParameterError(
                f"beads of radius {self.radius:g} are too large for a particle of radius "
                f"{radii.min():g}: take less than half of that"
            )
        if np.ndim(self.number) == 0:
            number = np.rint(np.asarray(self.number) * ring / ring.min()).astype(np.int64)
        else:
            number = np.array(self.number, dtype=np.int64)
            if len(number) != len(radii):
                raise ParameterError(
                    f"number must be one, or one a species ({len(radii)}), not {self.number}"
                )
        spacing = 2.0 * ring * np.sin(np.pi / number)
        widest = int(spacing.argmax())
        if spacing[widest] >= 4.0 * self.radius:
            enough = int(np.pi / np.arcsin(2.0 * self.radius / ring[widest])) + 1
            raise ParameterError(
                f"{number[widest]} beads of radius {self.radius:g} are too few for a particle of "
                f"radius {radii[widest]:g}, others slip through between them: take {enough} or more"
            )
        return Rings(
            number=number,
            radius=ring,
            spacing=spacing,
            area=0.5 * number * ring**2 * np.sin(2.0 * np.pi / number),
            effective_radius=ring + 0.5 * np.sqrt(4.0 * self.radius**2 - 0.25 * spacing**2),
        )


@dataclass(frozen=True, eq=False)
class Rings:
    """Undeformed rings, one a species, each array of shape (number of species,).

    Attributes:
        number: of beads, N_v.
        radius: of the circle through the beads, R - p [length].
        spacing: rest length of the springs, L0 = 2 (R - p) sin(pi/N_v) [length].
        area: rest area, A0 = N_v/2 (R - p)^2 sin(2 pi/N_v) [length^2].
        effective_radius: of the smooth particle that a ring is to other rings,
            R - p + sqrt(4p^2 - L0^2/4)/2 [length]: facing rows of beads interlock. A smooth wall
            meets the radius R.
    """

    number: NDArray[np.int64]
    radius: NDArray[np.float64]
    spacing: NDArray[np.float64]
    area: NDArray[np.float64]
    effective_radius: NDArray[np.float64]

"""The contact laws as settings: what `pair_style` and the parameter file say about them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from .errors import ParameterError
from .packing import positive


@dataclass(frozen=True)
class Ring:
    """Contacts slip: an inextensible ring takes the shape of largest area, U = kA/2 (A0 - A)^2.

    Args:
        kA: area stiffness [energy/length^4].
        reach: how far beyond touching neighbours count, relative to R_i + R_j, because outlines
            bulge between their contacts. More than enough costs little (3 % at 0.3), too little
            stops the run with an error that suggests a value; particles of very unequal size need
            more.

    Raises:
        ParameterError: a value is not positive.
    """

    kA: float = 1.0
    reach: float = 0.3

    def __post_init__(self) -> None:
        positive("kA", self.kA)
        positive("reach", self.reach)

    @property
    def style(self) -> str:
        """Name of the LAMMPS pair style."""
        return "deformable/ring"

    @property
    def arguments(self) -> str:
        """Arguments of the pair style."""
        return f"reach {self.reach!r}"

    @property
    def law(self) -> str:
        """Name of the kernel in `deformable.core`."""
        return "ring"

    @property
    def range(self) -> float:
        """Largest distance of neighbours that may touch, in units of R_i + R_j."""
        return 1.0 + self.reach

    def lone_stiffness(self, radius: float) -> float:
        """Stiffness of the only contact of a particle, while it is weak: none [energy/length^2]."""
        return 0.0

    def parameters(self, radii: Iterable[float]) -> str:
        """Text of the parameter file for species of these radii [length], named s1, s2, ..."""
        return _parameter_file(radii, self.kA, math.inf)


@dataclass(frozen=True)
class Sector:
    """Contacts stick: each sector between two contacts keeps its perimeter or its area.

    With finite kA the perimeter is conserved, U = kA/2 (A0 - A)^2; with finite kP (and kA = inf)
    the area is, U = kP/2 (P - P0)^2. The energy jumps where contacts appear, so that relaxations
    stall; `Ring` has no such jumps.

    Args:
        kA: area stiffness [energy/length^4], 1 if neither is given.
        kP: perimeter stiffness [energy/length^2].

    Raises:
        ParameterError: a value is not positive, or both or none of the two are infinite.
    """

    kA: float = math.nan
    kP: float = math.inf

    def __post_init__(self) -> None:
        if math.isnan(self.kA):
            object.__setattr__(self, "kA", 1.0 if math.isinf(self.kP) else math.inf)
        if not (self.kA > 0.0 and self.kP > 0.0 and math.isinf(self.kA) != math.isinf(self.kP)):
            raise ParameterError(
                f"Sector needs one positive stiffness and the other inf, not kA = {self.kA}, "
                f"kP = {self.kP}"
            )

    @property
    def style(self) -> str:
        """Name of the LAMMPS pair style."""
        return "deformable/sector"

    @property
    def arguments(self) -> str:
        """Arguments of the pair style."""
        return ""

    @property
    def law(self) -> str:
        """Name of the kernel in `deformable.core`."""
        return "area_sector" if math.isinf(self.kA) else "sector"

    @property
    def range(self) -> float:
        """Largest distance of neighbours that may touch, in units of R_i + R_j."""
        return 1.0

    def lone_stiffness(self, radius: float) -> float:
        """Stiffness of the only contact of a particle, a soft disk then [energy/length^2].

        Its energy k/2 (1 - d/(R_i + R_j))^2 has k numerically equal to the finite stiffness.
        """
        return min(self.kA, self.kP) / (2.0 * radius) ** 2

    def parameters(self, radii: Iterable[float]) -> str:
        """Text of the parameter file for species of these radii [length], named s1, s2, ..."""
        return _parameter_file(radii, self.kA, self.kP)


Model = Ring | Sector


def _parameter_file(radii: Iterable[float], kA: float, kP: float) -> str:
    lines = [
        "# UNITS: lj CONTRIBUTOR: written by lammps-deformable",
        "# name radius[length] kA[energy/length^4] kP[energy/length^2]",
    ]
    lines += [f"s{n} {float(radius)!r} {kA!r} {kP!r}" for n, radius in enumerate(radii, start=1)]
    return "\n".join(lines) + "\n"

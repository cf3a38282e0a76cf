"""The contact laws as settings, and their names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import core
from ..common.errors import ParameterError
from ..common.validate import positive, shown

# A ring of constant perimeter, even pressed flat, bulges by (pi/2 - 1) R. Up to a reach f all lines
# are found that much smaller neighbors have at (1 + f + 1/(1 + f)) R/2, so that 1.8 would do.
_FARTHEST_REACH = 3.0


@dataclass(frozen=True)
class Ring:
    """Contacts slip: a ring takes the shape of least energy.

        U = kA/2 (A - A0)^2 + kP/2 (P - P0)^2

    With kP = inf, the default, the perimeter is conserved; with kA = inf the area is. Stiffnesses
    and skin are numbers, or sequences of a number a species.

    Args:
        kA: area stiffness [energy/length^4].
        contact: where contact lines are: `balanced`, where both sides press with the same force, or
            `radical`, on the radical axis of the undeformed circles. Against rings of beads the
            first is right to 1 % where the second is off by factors (docs/paper.md), and relaxes in
            about three times the time.
        reach: how far beyond touching neighbors count, relative to R_i + R_j, because outlines
            bulge between their contacts. More than enough costs little (3 % at 0.3), too little
            stops the run with an error that suggests a value; particles of very unequal size need
            more, at most 3.
        kP: perimeter stiffness [energy/length^2].
        skin: thickness of a rigid skin around the ring [length]: contacts act at the radius R,
            while A0 and P0 are those of the radius R - skin.

    Raises:
        ParameterError: a stiffness is not positive, both are infinite, the reach is not in
            (0, 3], or a skin is negative.

    Source: docs/theory.md, "Ring" and "Rings that breathe".
    """

    kA: float | Sequence[float] = 1.0
    reach: float = 0.3
    kP: float | Sequence[float] = math.inf
    skin: float | Sequence[float] = 0.0
    contact: str = "balanced"

    def __post_init__(self) -> None:
        object.__setattr__(self, "reach", positive("reach", self.reach))
        if self.reach > _FARTHEST_REACH:
            raise ParameterError(
                f"reach must be at most {_FARTHEST_REACH:g}, not {self.reach}: no outline bulges "
                "so far that it finds more contacts"
            )
        if not isinstance(self.contact, str) or self.contact not in ("radical", "balanced"):
            raise ParameterError(f"contact must be radical or balanced, not {shown(self.contact)}")
        for name in ("kA", "kP", "skin"):
            object.__setattr__(self, name, one_or_each(name, getattr(self, name)))
        kA, kP, skin = (np.asarray(value) for value in (self.kA, self.kP, self.skin))
        for name, values in (("kA", kA), ("kP", kP)):
            if not (values > 0.0).all():
                raise ParameterError(f"{name} must be positive, not {shown(values)}")
        if not (np.isfinite(skin) & (skin >= 0.0)).all():
            raise ParameterError(f"skin must not be negative, not {shown(skin)}")
        if len({values.size for values in (kA, kP, skin)} - {1}) > 1:
            raise ParameterError(
                f"kA, kP and skin must be numbers or have one a species, not {kA.size}, {kP.size} "
                f"and {skin.size} numbers"
            )
        if (np.isinf(kA) & np.isinf(kP)).any():
            raise ParameterError(
                f"a ring must change its area or its perimeter: kA and kP cannot both be inf, as "
                f"in {shown(kA)} and {shown(kP)}"
            )

    @property
    def name(self) -> str:
        """`balanced` or `radical`, see `LAWS`."""
        return self.contact

    def single_contact_stiffness(self, radius: float) -> float:
        """Stiffness of the only contact of a particle, while it is weak: none [energy/length^2]."""
        return 0.0

    def skins(self, species: int) -> NDArray[np.float64]:
        """Skin of each species, shape (species,) [length]."""
        return np.array(per_species(self.skin, species))

    def species(self, radii: Sequence[float]) -> list[tuple[float, float, float]]:
        """kA, kP and skin of species of these radii [length].

        Raises:
            ParameterError: there are other numbers of species, or a skin is as thick as a particle.
        """
        kA, kP, skin = (per_species(values, len(radii)) for values in (self.kA, self.kP, self.skin))
        for thickness, radius in zip(skin, radii, strict=True):
            if thickness >= radius:
                raise ParameterError(
                    f"a skin of {thickness:g} is too thick for a particle of radius {radius:g}: it "
                    "must be thinner than that"
                )
        return list(zip(kA, kP, skin, strict=True))

    def outline(
        self,
        species: int,
        radius: float,
        angle: ArrayLike,
        indentation: ArrayLike,
        inset: float = 0.0,
        points: int = 180,
    ) -> NDArray[np.float64]:
        """Outline of a particle about its center, a closed polygon of shape (m, 2) [length].

        Args:
            species: of the particle.
            radius: undeformed [length].
            angle: directions of its contacts, shape (z,) [rad].
            indentation: of each, shape (z,) [length].
            inset: distance from the outline to the parallel line within it that is wanted [length].
            points: how finely a whole turn is divided.
        """
        breath, felt = self._felt(species, radius, angle, indentation)
        return core.outline("ring", radius - inset + breath, angle, felt, points)

    def _felt(
        self, species: int, radius: float, angle: ArrayLike, indentation: ArrayLike
    ) -> tuple[float, NDArray[np.float64]]:
        """How much the ring widens, and the indentations that its contacts then feel."""
        a = np.asarray(indentation, dtype=np.float64)
        kA, kP, skin = (_at(values, species) for values in (self.kA, self.kP, self.skin))
        if math.isinf(kP):
            return 0.0, a
        breath = core.soft_ring(radius, angle, a, kA, kP, skin).delta
        return breath, a + breath


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
        for name in ("kA", "kP"):
            plain = one_or_each(name, getattr(self, name))
            if isinstance(plain, tuple):
                raise ParameterError(
                    f"{name} of Sector must be one number, not {shown(list(plain))}"
                )
            object.__setattr__(self, name, plain)
        if math.isnan(self.kA):
            object.__setattr__(self, "kA", 1.0 if math.isinf(self.kP) else math.inf)
        if not (self.kA > 0.0 and self.kP > 0.0 and math.isinf(self.kA) != math.isinf(self.kP)):
            raise ParameterError(
                f"Sector needs one positive stiffness and the other inf, not kA = {self.kA}, "
                f"kP = {self.kP}"
            )

    @property
    def name(self) -> str:
        """`sector`, see `LAWS`."""
        return "sector"

    @property
    def kernel(self) -> str:
        """Name of the kernel in `deformable.core`."""
        return "area_sector" if math.isinf(self.kA) else "sector"

    def single_contact_stiffness(self, radius: float) -> float:
        """Stiffness of the only contact of a particle, a soft disk then [energy/length^2].

        Its energy k/2 (1 - d/(R_i + R_j))^2 has k numerically equal to the finite stiffness.
        """
        return min(self.kA, self.kP) / (2.0 * radius) ** 2

    def skins(self, species: int) -> NDArray[np.float64]:
        """Skin of each species: none, shape (species,) [length]."""
        return np.zeros(species)

    def species(self, radii: Sequence[float]) -> list[tuple[float, float, float]]:
        """kA, kP and skin of species of these radii [length]."""
        return [(self.kA, self.kP, 0.0)] * len(radii)

    def outline(
        self,
        species: int,
        radius: float,
        angle: ArrayLike,
        indentation: ArrayLike,
        inset: float = 0.0,
        points: int = 180,
    ) -> NDArray[np.float64]:
        """As for `Ring`; an inset is right for sectors that keep their perimeter."""
        return core.outline(self.kernel, radius - inset, angle, indentation, points)


Law = Ring | Sector


def one_or_each(name: str, given: object) -> float | tuple[float, ...]:
    """A number as a float, one number a species as a tuple."""
    try:
        values = np.asarray(given)
    except ValueError:  # rows of unequal length
        values = np.asarray(None)
    if values.dtype.kind not in "iuf" or values.ndim > 1 or values.size == 0:
        raise ParameterError(
            f"{name} must be a number, or one number a species, not {shown(given)}"
        )
    return float(values) if values.ndim == 0 else tuple(float(value) for value in values)


def per_species(values: float | Sequence[float], species: int) -> list[float]:
    """A number for each species, of what `one_or_each` returns."""
    if np.ndim(values) == 1 and len(np.asarray(values)) != species:
        raise ParameterError(
            f"there are {species} species, so {np.asarray(values).tolist()} must have as many "
            "numbers"
        )
    return [_at(values, n) for n in range(species)]


def _at(values: float | Sequence[float], species: int) -> float:
    return values if isinstance(values, float) else float(np.asarray(values)[species])


# The contact laws by name, with stiffness 1: the one table of the names that options, tables and
# files use.
LAWS: dict[str, Law] = {
    "balanced": Ring(),
    "radical": Ring(contact="radical"),
    "sector": Sector(),
}

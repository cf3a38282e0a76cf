"""Contact laws as settings, and the table of their names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, fields
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import core
from ..common.errors import ParameterError
from ..common.validate import positive, shown
from .adhesion import adhesion_of, check_adhesion
from .by_pair import ByPair, pair_matrix

# A ring of constant perimeter bulges by (pi/2 - 1) R at most, when it is pressed flat. A reach f
# finds the lines of much smaller neighbors up to (1 + f + 1/(1 + f)) R/2, so that 1.8 is enough.
_FARTHEST_REACH = 3.0

# The default reach by the place of contact lines. Only radical lines cost more with a larger one.
_REACH = {"balanced": 0.6, "curved": 0.6, "radical": 0.3}


class SpeciesParameters(NamedTuple):
    """Parameters of a law, each one an array of shape (species,).

    Attributes:
        kA: area stiffness [energy/length^4].
        kP: perimeter stiffness [energy/length^2].
        skin: thickness of the rigid skin [length].
        tension: line tension of the perimeter at rest [energy/length].
    """

    kA: NDArray[np.float64]
    kP: NDArray[np.float64]
    skin: NDArray[np.float64]
    tension: NDArray[np.float64]

    def of(self, species: NDArray[np.int64]) -> SpeciesParameters:
        """The parameters of particles of these species, arrays of shape (N,)."""
        return SpeciesParameters(*(values[species] for values in self))


@dataclass(frozen=True, repr=False)
class Ring:
    """The ring laws: contacts slip, and each particle takes the shape of least energy.

        U = kA/2 (A - A0)^2 + kP/2 (P - P0)^2 + tension [(P - P0) - (A - A0)/R]

    With kP = inf, the default, the perimeter is conserved; with kA = inf the area is. A droplet of
    constant surface tension that conserves its area is Ring(kA=inf, kP=0, tension=1), a bubble of
    gas has a finite kA. Stiffnesses, skin and tension are numbers, or sequences of one number for
    each species.

    Args:
        kA: area stiffness [energy/length^4].
        reach: neighbors count up to a distance of (1 + reach) (R_i + R_j), because outlines bulge
            between their contacts; 0.6 if not given, with `radical` 0.3. A larger one costs next to
            nothing, but with `radical` a quarter at 0.6. One that is too small stops the run with
            an error that suggests a value: particles of very unequal size need more, at most 3.
        kP: perimeter stiffness [energy/length^2].
        skin: thickness of a rigid skin around the ring [length]: contacts act at the radius R,
            while A0 and P0 are those of the radius R - skin.
        tension: line tension of the perimeter at rest [energy/length]. Beside it kP is finite, and
            may be 0. The last term of U is the pressure tension/R of a free particle, so that it
            is at rest with the radius R. With kP the perimeter alone would shrink to
            P0 - tension/kP.
        adhesion: energy w that two particles gain for each unit of length of the film between them
            [energy/length], with `curved` contacts: a number for all pairs, or a symmetric matrix,
            a row for each species. Outlines of the tension T meet a film at the angle theta,
            cos theta = 1 - w/(2T) between equals. Particles attach where they touch, and let go
            where their film has no length left. w is below twice the weaker tension; both have a
            tension, a finite kP and no skin.
        contact: the contact lines. `balanced`: straight, perpendicular to the line of centers,
            where the forces of both sides are equal. `curved`: arcs between particles of unequal
            pressure, whose torques are balanced too; at rest this is the exact shape of slipping
            particles, and for droplets that of a foam. `radical`: on the radical axis of the
            undeformed circles. Compared with smooth polygons, `balanced` is right to 1.4 % up to
            3 % strain, `curved` to less than the polygons' own error, and `radical` wrong by
            factors. A relaxation takes about 1.4 times as long with `balanced` as with `radical`,
            and a relaxation about twice, a step of motion two to four times as long with `curved`
            as with `balanced`.

    Raises:
        ParameterError: a stiffness is not positive, both are infinite, the reach is not in
            (0, 3], a skin or a tension is negative, or there is a tension beside kP = inf; or an
            adhesion is negative, or too large for a tension, or contacts are not `curved`.

    Source: docs/theory.md.
    """

    dimension: ClassVar[int] = 2

    kA: float | Sequence[float] = 1.0
    _: KW_ONLY
    reach: float = math.nan
    kP: float | Sequence[float] = math.inf
    skin: float | Sequence[float] = 0.0
    contact: str = "balanced"
    tension: float | Sequence[float] = 0.0
    adhesion: ByPair = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.contact, str) or self.contact not in _REACH:
            raise ParameterError(
                f"contact must be balanced, curved or radical, not {shown(self.contact)}"
            )
        given = _REACH[self.contact] if self.reach is math.nan else self.reach
        object.__setattr__(self, "reach", positive("reach", given))
        if self.reach > _FARTHEST_REACH:
            raise ParameterError(
                f"reach must be at most {_FARTHEST_REACH:g}, not {self.reach}: no outline bulges "
                "farther than that"
            )
        for name in SpeciesParameters._fields:
            object.__setattr__(self, name, one_or_each(name, getattr(self, name)))
        kA, kP, skin, tension = (np.atleast_1d(value) for value in self._parameters)
        sizes = [values.size for values in (kA, kP, skin, tension)]
        if len({*sizes} - {1}) > 1:
            raise ParameterError(
                "kA, kP, skin and tension must be numbers, or one number for each species, not "
                f"{sizes[0]}, {sizes[1]}, {sizes[2]} and {sizes[3]} numbers"
            )
        for stiffnesses in np.broadcast(kA, kP, tension):
            _refuse(core.invalid_stiffness(*stiffnesses))
        for thickness in skin:
            _refuse(core.invalid_skin(thickness))
        object.__setattr__(self, "adhesion", adhesion_of(self.adhesion))
        check_adhesion(self.adhesion, self.contact, kA, kP, skin, tension)

    def __repr__(self) -> str:
        return _call(self)

    @property
    def _parameters(self) -> list[float | Sequence[float]]:
        return [getattr(self, name) for name in SpeciesParameters._fields]

    @property
    def sticks(self) -> bool:
        """Whether any particles have an adhesion."""
        return bool(np.max(self.adhesion) > 0.0)

    @property
    def name(self) -> str:
        """`balanced`, `curved` or `radical`, see `LAWS`."""
        return self.contact

    def single_contact_stiffness(self, radius: float) -> float:
        """Stiffness of a particle's only contact, if it is weak: 0 [energy/length^2]."""
        return 0.0

    def species_parameters(self, radii: Sequence[float] | NDArray[np.float64]) -> SpeciesParameters:
        """The parameters of species of these radii [length].

        Raises:
            ParameterError: there is another number of species, a skin is not thinner than the
                radius, or a particle would collapse by its tension.
        """
        found = [per_species(values, len(radii)) for values in self._parameters]
        pair_matrix("adhesion", self.adhesion, len(radii))
        for kA, kP, skin, tension, radius in zip(*found, radii, strict=True):
            _refuse(core.invalid_skin(skin, radius))
            _refuse(core.unstable_radius(radius - skin, kA, kP, tension))
        return SpeciesParameters(*map(np.array, found))

    def outline(
        self,
        species: int,
        radius: float,
        angle: ArrayLike,
        indentation: ArrayLike,
        inset: float = 0.0,
        points: int = 180,
        same_area: bool = False,
        force: ArrayLike = (),
        half_angle: ArrayLike = (),
        contact_angle: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Outline of a particle about its center, a closed polygon of shape (m, 2) [length].

        Args:
            species: of the particle.
            radius: undeformed [length].
            angle: directions of its contacts, shape (z,) [rad].
            indentation: of each, shape (z,) [length].
            inset: distance of the line that is returned to the outline, inward [length].
            points: number of points on a whole turn.
            same_area: move points between contacts a little outward, see `core.outline`.
            force: of each contact, if they are curved, shape (z,) [energy/length].
            half_angle: of each contact, likewise, shape (z,) [rad].
            contact_angle: of each contact, likewise, shape (z,) [rad].
        """
        a = np.asarray(indentation, dtype=np.float64)
        kA, kP, skin, tension = (_at(values, species) for values in self._parameters)
        if self.contact == "curved":
            ring = core.forced_ring(
                radius, angle, force, kA, kP, skin, tension, half_angle, contact_angle
            )
            whole, length = ring.support_radius + skin - inset, ring.contact_length
            return core.curved_outline(
                whole, angle, length, half_angle, points, same_area, contact_angle
            )
        expansion = 0.0
        if math.isfinite(kP):  # the radius changes, and with it all indentations
            expansion = core.soft_ring(radius, angle, a, kA, kP, skin, tension).delta
        whole, deeper = radius - inset + expansion, a + expansion
        return core.outline("ring", whole, angle, deeper, points, same_area)


@dataclass(frozen=True, repr=False)
class Sector:
    """The sector law: contacts stick, and each sector between two contacts keeps its perimeter.

        U = kA/2 (A0 - A)^2, perimeter conserved (kP = inf)
        U = kP/2 (P - P0)^2, area of each sector conserved (kA = inf)

    The energy jumps where contacts appear, so that relaxations stall; `Ring` has no such jumps.

    Args:
        kA: area stiffness [energy/length^4], 1 if neither is given.
        kP: perimeter stiffness [energy/length^2].

    Raises:
        ParameterError: a value is not positive, or both or none of the two are infinite.
    """

    dimension: ClassVar[int] = 2
    sticks: ClassVar[bool] = False

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
        _refuse(core.invalid_stiffness(self.kA, self.kP))
        _refuse(core.invalid_for_sectors(self.kA, self.kP))

    def __repr__(self) -> str:
        return _call(self)

    @property
    def name(self) -> str:
        """`sector`, see `LAWS`."""
        return "sector"

    @property
    def kernel(self) -> str:
        """Name of the kernel in `ld.core`."""
        return "area_sector" if math.isinf(self.kA) else "sector"

    def single_contact_stiffness(self, radius: float) -> float:
        """Stiffness of a particle's only contact: the particle is a soft disk [energy/length^2].

        In its energy k/2 (1 - d/(R_i + R_j))^2, k is the number of the finite stiffness.
        """
        return min(self.kA, self.kP) / (2.0 * radius) ** 2

    def species_parameters(self, radii: Sequence[float] | NDArray[np.float64]) -> SpeciesParameters:
        """As for `Ring`: the same for all species, without skin and tension."""
        return SpeciesParameters(*np.tile([[self.kA], [self.kP], [0.0], [0.0]], len(radii)))

    def outline(
        self,
        species: int,
        radius: float,
        angle: ArrayLike,
        indentation: ArrayLike,
        inset: float = 0.0,
        points: int = 180,
        same_area: bool = False,
    ) -> NDArray[np.float64]:
        """As for `Ring`; an inset is right for sectors that keep their perimeter."""
        return core.outline(self.kernel, radius - inset, angle, indentation, points, same_area)


Law = Ring | Sector


def one_or_each(name: str, given: object) -> float | tuple[float, ...]:
    """A number as a float, a sequence of one number for each species as a tuple.

    Raises:
        ParameterError: it is neither.
    """
    try:
        values = np.asarray(given)
    except ValueError:  # rows of unequal length
        values = np.asarray(None)
    if values.dtype.kind not in "iuf" or values.ndim > 1 or values.size == 0:
        raise ParameterError(
            f"{name} must be a number, or one number for each species, not {shown(given)}"
        )
    return float(values) if values.ndim == 0 else tuple(float(value) for value in values)


def per_species(values: float | Sequence[float], species: int) -> list[float]:
    """A number for each species, from a result of `one_or_each`.

    Raises:
        ParameterError: there is another number of species.
    """
    if np.ndim(values) == 1 and len(np.asarray(values)) != species:
        raise ParameterError(
            f"there are {species} species, so {np.asarray(values).tolist()} must have as many "
            "numbers"
        )
    return [_at(values, n) for n in range(species)]


def _at(values: float | Sequence[float], species: int) -> float:
    return values if isinstance(values, float) else float(np.asarray(values)[species])


def _call(law: Law) -> str:
    """The call that makes a law, without the settings that have their default."""
    defaults = {field.name: field.default for field in fields(law)}
    if isinstance(law, Ring):
        defaults["reach"] = _REACH[law.contact]
    given = (
        f"{name}={getattr(law, name)!r}"
        for name, default in defaults.items()
        if getattr(law, name) != default
    )
    return f"{type(law).__name__}({', '.join(given)})"


def _refuse(problem: str | None) -> None:
    """Raise the problem that a rule of `ld.core` has found, if any."""
    if problem is not None:
        raise ParameterError(problem)


# The contact laws by name, with stiffness 1: options, tables and files use these names.
LAWS: dict[str, Law] = {
    "balanced": Ring(),
    "curved": Ring(contact="curved"),
    "radical": Ring(contact="radical"),
    "sector": Sector(),
}

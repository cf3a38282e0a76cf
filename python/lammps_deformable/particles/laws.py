"""Contact laws as settings: what one particle costs, for `Simulation`.

Laws with numbers for all species or one for each, the table of their names, and what follows from a
law and a packing: adhesion to walls, time steps, and the pressure above the onset of jamming.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import core
from ..common.box import refuse_space
from ..common.checks import (
    as_array,
    as_call,
    count,
    expect,
    finite,
    number_or_nan,
    numbers,
    positive,
    shown,
    whole,
)
from ..common.errors import ParameterError

if TYPE_CHECKING:
    from .packing import Packing
    from .walls import Wall

Floats = NDArray[np.float64]

# More species than a law has: so many numbers, as many as particles, are those of particles.
_MANY_SPECIES = 12

ByPair = float | Sequence[Sequence[float]]


def by_pair(name: str, given: object) -> float | tuple[tuple[float, ...], ...]:
    """A number as a float, a symmetric matrix as rows of floats.

    Raises:
        ParameterError: it is neither.
    """
    values = as_array(given)
    square = values.ndim == 2 and values.size > 0 and values.shape[0] == values.shape[1]
    if values.dtype.kind not in "iuf" or not (values.ndim == 0 or square):
        raise ParameterError(
            f"{name} must be a number, or a matrix with a row and a column for each species, not "
            f"{shown(given)}"
        )
    if values.ndim == 0:
        return float(values)
    if (odd := np.argwhere((values != values.T) & (values == values))).size:
        i, j = odd[0].tolist()
        raise ParameterError(
            f"{name} must be symmetric, but species {i} and {j} have {values[i, j]:g} and "
            f"{values[j, i]:g}"
        )
    return tuple(tuple(map(float, row)) for row in values)


def pair_matrix(name: str, values: ByPair, species: int) -> NDArray[np.float64]:
    """The value of each pair of so many species, from a result of `by_pair`.

    Those of further species, which have no particles, are left out.

    Raises:
        ParameterError: there are more species.
    """
    if isinstance(values, float):
        return np.full((species, species), values)
    if len(values) < species:
        raise ParameterError(
            f"there are {species} species, so the matrix of {name} must have as many rows, not "
            f"{len(values)}"
        )
    return np.array(values)[:species, :species]


def adhesion_of(given: object) -> float | tuple[tuple[float, ...], ...]:
    """A number as a float, a symmetric matrix as rows of floats.

    Raises:
        ParameterError: it is neither, or a value is no adhesion.
    """
    adhesion = by_pair("adhesion", given)
    for value in np.ravel(adhesion).tolist():
        _refuse(core.invalid_adhesion(value))
    return adhesion


def check_adhesion(adhesion: ByPair, contact: str, *parameters: NDArray[np.float64]) -> None:
    """Refuse an adhesion that these contacts or these species cannot have.

    Args:
        adhesion: a result of `adhesion_of`.
        contact: the contact lines of `Ring`.
        parameters: kA, kP, skin and tension, one number each or one for each species.

    Raises:
        ParameterError: the contacts are not curved, there is another number of species, or one of
            them has a tension that is too small, an infinite kP, or a skin.
    """
    rows = 1 if isinstance(adhesion, float) else len(adhesion)
    sizes = [values.size for values in parameters]
    matrix = pair_matrix("adhesion", adhesion, max(sizes) if max(sizes) > 1 else rows)
    if (matrix > 0.0).any() and contact != "curved":
        raise ParameterError(
            "adhesion needs contact lines that bend, to meet outlines at an angle: use "
            f"contact='curved', not {contact!r}, or adhesion 0"
        )
    for w, *of_species in np.broadcast(matrix.max(axis=1), *parameters):
        _refuse(core.invalid_for_adhesion(w, *of_species))


def wall_adhesion(kind: str, given: object) -> float:
    """The adhesion of a wall of this kind.

    Raises:
        ParameterError: it is no adhesion.
    """
    value = number_or_nan(given)
    if problem := core.invalid_adhesion(value):
        raise ParameterError(f"{problem.replace('nan', shown(given))} (of a {kind})")
    return value


# A ring of constant perimeter bulges by (pi/2 - 1) R at most, when it is pressed flat. A reach f
# finds the lines of much smaller neighbors up to (1 + f + 1/(1 + f)) R/2, so that 1.8 is enough.
_FARTHEST_REACH = 3.0

# The default reach by the place of contact lines. Only radical lines cost more with a larger one.
_REACH = {"balanced": 0.6, "curved": 0.6, "radical": 0.3}


class SpeciesParameters(NamedTuple):
    """Parameters of a law, each one an array of shape (species,).

    They have the order in which functions of `core` take them. A new one has the name that it has
    in `src/laws/stiffness.h`, and is a field of `Ring` too.

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

    @classmethod
    def like(cls, species: int, **given: ArrayLike) -> SpeciesParameters:
        """Parameters of so many species: numbers, or one for each; 0 if they are not given."""
        zero = dict.fromkeys(cls._fields, 0.0)
        return cls(
            *(np.broadcast_to(value, species).astype(float) for value in (zero | given).values())
        )


@dataclass(frozen=True, repr=False)
class Ring:
    """The ring laws: contacts slip, and each particle takes the shape of least energy.

        U = kA/2 (A - A0)^2 + kP/2 (P - P0)^2 + tension [(P - P0) - (A - A0)/R]

    With kP = inf, the default, the perimeter is conserved; with kA = inf the area is. A droplet of
    constant surface tension that conserves its area is Ring(kA=inf, kP=0, tension=1), a bubble of
    gas has a finite kA. Stiffnesses, skin and tension are numbers, or sequences of one number for
    each species; numbers of further species, which have no particles, are left out.

    Args:
        kA: area stiffness [energy/length^4].
        kP: perimeter stiffness [energy/length^2].
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
        skin: thickness of a rigid skin around the ring [length]: contacts act at the radius R,
            while A0 and P0 are those of the radius R - skin.
        contact: the contact lines. `balanced`: straight, perpendicular to the line of centers,
            where the forces of both sides are equal. `curved`: arcs between particles of unequal
            pressure, whose torques are balanced too; at rest this is the exact shape of slipping
            particles, and for droplets that of a foam. `radical`: on the radical axis of the
            undeformed circles. Compared with smooth polygons, `balanced` is right to 1.3 % from
            1 to 3 % strain, `curved` to less than the polygons' own error, and `radical` wrong by
            factors. A relaxation takes about 1.2 times as long with `balanced` as with `radical`;
            with `curved` it takes 1.2 to 1.4 times, and a step of motion two to three and a half
            times as long as with `balanced`.
        reach: neighbors count up to a distance of (1 + reach) (R_i + R_j), because outlines bulge
            between their contacts; 0.6 if not given, with `radical` 0.3. A larger one costs next to
            nothing, but with `radical` a quarter at 0.6. One that is too small stops the run with
            an error that suggests a value: particles of very unequal size need more, at most 3.

    Raises:
        ParameterError: a stiffness is not positive, both are infinite, the reach is not in
            (0, 3], a skin or a tension is negative, or there is a tension beside kP = inf; or an
            adhesion is negative, or too large for a tension, or contacts are not `curved`.

    Source: docs/theory.md.
    """

    dimension: ClassVar[int] = 2

    kA: float | Sequence[float] = 1.0
    _: KW_ONLY
    kP: float | Sequence[float] = math.inf
    tension: float | Sequence[float] = 0.0
    adhesion: ByPair = 0.0
    skin: float | Sequence[float] = 0.0
    contact: str = "balanced"
    reach: float = math.nan

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
        parameters = [np.atleast_1d(value) for value in self._parameters]
        sizes = [values.size for values in parameters]
        if len({*sizes} - {1}) > 1:
            names, numbers = (
                f"{', '.join(words[:-1])} and {words[-1]}"
                for words in (SpeciesParameters._fields, [*map(str, sizes)])
            )
            raise ParameterError(
                f"{names} must be numbers, or one number for each species, not {numbers} numbers"
            )
        for kA, kP, skin, *more in np.broadcast(*parameters):
            _refuse(core.invalid_stiffness(kA, kP, *more))
            _refuse(core.invalid_skin(skin))
        object.__setattr__(self, "adhesion", adhesion_of(self.adhesion))
        check_adhesion(self.adhesion, self.contact, *parameters)

    def __repr__(self) -> str:
        return as_call(self, reach=_REACH[self.contact])

    @property
    def _parameters(self) -> list[float | Sequence[float]]:
        return [getattr(self, name) for name in SpeciesParameters._fields]

    @property
    def sticks(self) -> bool:
        """Whether any particles have an adhesion."""
        return bool(np.max(self.adhesion) > 0.0)

    @property
    def name(self) -> str:
        """`balanced`, `curved` or `radical`, as in the shell and in files."""
        return self.contact

    def single_contact_stiffness(self, radius: float) -> float:
        """Stiffness of a particle's only contact, if it is weak: 0 [energy/length^2]."""
        positive("radius", radius)
        return 0.0

    def species_parameters(self, radii: Sequence[float] | NDArray[np.float64]) -> SpeciesParameters:
        """The parameters of species of these radii [length].

        Raises:
            ParameterError: there are more species, a skin is not thinner than the
                radius, or a particle would collapse by its tension.
        """
        radii = radii_of_species(radii)
        found = [per_species(values, len(radii)) for values in self._parameters]
        pair_matrix("adhesion", self.adhesion, len(radii))
        for radius, kA, kP, skin, *more in zip(radii, *found, strict=True):
            _refuse(core.invalid_skin(skin, radius))
            _refuse(core.unstable_radius(radius - skin, kA, kP, *more))
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

        Raises:
            ParameterError: a number is out of range, shapes disagree, or lines of curved contacts
                are given to others.
        """
        kind = _check_outline(species, radius, inset, points, same_area)
        lines = {"force": force, "half_angle": half_angle}
        lines |= {} if contact_angle is None else {"contact_angle": contact_angle}
        if self.contact != "curved":
            for name, line in lines.items():
                if np.size(as_array(line)):
                    raise ParameterError(f"{name} is for contact='curved', not '{self.contact}'")
            lines = {}
        angle, a, *_ = _of_contacts(angle=angle, indentation=indentation, **lines)
        _, kP, skin, *_ = own = [_at(values, kind) for values in self._parameters]
        if self.contact == "curved":
            ring = core.forced_ring(
                radius, angle, force, *own, half_angle=half_angle, contact_angle=contact_angle
            )
            outer, length = ring.support_radius + skin - inset, ring.contact_length
            return core.curved_outline(
                outer, angle, length, half_angle, points, same_area, contact_angle
            )
        expansion = 0.0
        if math.isfinite(kP):  # the radius changes, and with it all indentations
            expansion = core.soft_ring(radius, angle, a, *own).delta
        outer, deeper = radius - inset + expansion, a + expansion
        return core.outline("ring", outer, angle, deeper, points, same_area)


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
    _: KW_ONLY
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
        return as_call(self)

    @property
    def name(self) -> str:
        """`sector`, in files."""
        return "sector"

    @property
    def _kernel(self) -> str:
        """Name of the kernel in `ld.core`."""
        return "area_sector" if math.isinf(self.kA) else "sector"

    def single_contact_stiffness(self, radius: float) -> float:
        """Stiffness of a particle's only contact: the particle is a soft disk [energy/length^2].

        In its energy k/2 (1 - d/(R_i + R_j))^2, k is the number of the finite stiffness.
        """
        return min(self.kA, self.kP) / (2.0 * positive("radius", radius)) ** 2

    def species_parameters(self, radii: Sequence[float] | NDArray[np.float64]) -> SpeciesParameters:
        """As for `Ring`: the same for all species, without skin and tension."""
        number = len(radii_of_species(radii))
        return SpeciesParameters.like(number, kA=self.kA, kP=self.kP)

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
        _check_outline(species, radius, inset, points, same_area)
        angle, indentation = _of_contacts(angle=angle, indentation=indentation)
        return core.outline(self._kernel, radius - inset, angle, indentation, points, same_area)


Law = Ring | Sector


def one_or_each(name: str, given: object) -> float | tuple[float, ...]:
    """A number as a float, a sequence of one number for each species as a tuple.

    Raises:
        ParameterError: it is neither.
    """
    values = as_array(given)
    if values.dtype.kind not in "iuf" or values.ndim > 1 or values.size == 0:
        raise ParameterError(
            f"{name} must be a number, or one number for each species, not {shown(given)}"
        )
    return float(values) if values.ndim == 0 else tuple(float(value) for value in values)


def radii_of_species(radii: ArrayLike) -> NDArray[np.float64]:
    """The radii, shape (number of species,) [length].

    Raises:
        ParameterError: they are no such numbers, or one is not positive.
    """
    values = numbers("radii", radii)
    if values.ndim != 1 or (values <= 0.0).any():
        raise ParameterError(
            f"radii must be positive numbers, one for each species, not {shown(radii)}"
        )
    return values


def per_species(values: float | Sequence[float], species: int) -> list[float]:
    """A number for each species, from a result of `one_or_each`.

    Those of further species, which have no particles, are left out.

    Raises:
        ParameterError: there are more species.
    """
    if np.ndim(values) == 1 and len(np.asarray(values)) < species:
        raise ParameterError(
            f"there are {species} species, so {shown(np.asarray(values))} must have as many "
            "numbers; other species are made by packing.replace(species=...)"
        )
    return [_at(values, n) for n in range(species)]


def refuse_values_of_particles(law: object, packing: Packing) -> None:
    """Refuse a law with a number for each particle, which is no number for each species.

    Raises:
        ParameterError: it has as many numbers as there are particles, and these are many.
    """
    for name, value in vars(law).items():
        each, species = np.ndim(value) == 1, len(packing.species_radii)
        if each and len(value) == len(packing) > max(species, _MANY_SPECIES):
            raise ParameterError(
                f"{name} has {len(value)} numbers, as there are particles, and a law has one for "
                f"each of {species} species: make species by packing.replace(species=...)"
            )


def _at(values: float | Sequence[float], species: int) -> float:
    if isinstance(values, float):
        return values
    if not 0 <= species < len(values):
        raise ParameterError(f"species must be below {len(values)}, not {species}")
    return values[species]


def _check_outline(species: int, radius: float, inset: float, points: int, same_area: bool) -> int:
    """Refuse what is no outline of a particle; returns its species."""
    if (kind := whole("species", species)) < 0:
        raise ParameterError(f"species must not be negative, not {kind}")
    if not positive("radius", radius) > finite("inset", inset):
        raise ParameterError(f"inset must be less than the radius {radius:g}, not {inset:g}")
    count("points", points)
    expect("same_area", same_area, bool)
    return kind


def _of_contacts(**given: ArrayLike) -> list[NDArray[np.float64]]:
    """Numbers of the contacts of one particle as arrays, all of shape (z,).

    Raises:
        ParameterError: they are no such numbers.
    """
    found: list[NDArray[np.float64]] = []
    for name, values in given.items():
        array = numbers(name, values)
        if array.ndim != 1 or (found and len(array) != len(found[0])):
            each = f"({len(found[0])},)" if found else "(contacts,)"
            raise ParameterError(f"{name} must have shape {each}, not {array.shape}")
        found.append(array)
    return found


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


# Load beyond which the law is off by more than it is worth; as in `src/laws/droplet.h`.
LARGEST_LOAD = 0.4
# And part of the surface in the mean facet, where contacts are few and strong.
LARGEST_FACET = 0.05


@dataclass(frozen=True, repr=False)
class Droplet:
    """Droplets or bubbles of constant volume in three dimensions.

        U = max over F >= 0 of  sum_pairs [F (R_i + R_j - d) - T(F)] - sum_i W_i(F)

    with one force F for each pair and the work W of Morse and Witten's theory, exact to third order
    in the forces; T is what films gain that curve and turn. Droplets bulge between their contacts,
    so that each contact depends on all others of both droplets. The *load* of a droplet is the part
    of its surface that facets cover. Up to 0.3 energies are right to 0.35 % and forces to 1 % of
    their mean, in random packings at a mean load of 0.25 to 1 % and some per cent; beyond 0.4, or
    beyond 0.05 in the mean facet, a droplet is beyond the model.

        Simulation(packing, Droplet(tension=1.0))

    Droplets with an adhesion stick: their surfaces meet a film at the angle theta, cos theta =
    1 - w/(2 tension) between equals, and a film may pull. They attach where they touch; a film that
    is pulled too far is torn.

        Simulation(packing, Droplet(tension=1.0, adhesion=0.1))

    Args:
        tension: surface tension [energy/length^2]: a number, or one for each species.
        adhesion: energy w that two droplets gain for each unit of area of the film between them
            [energy/length^2]: a number for all pairs, or a symmetric matrix, a row for each
            species. Contact angles above 0.7 are beyond the model, those above 1 are refused.

    Raises:
        ParameterError: a tension is not a positive number, or an adhesion is negative, or too large
            for a tension.

    Source: Morse and Witten, Europhys. Lett. 22, 549 (1993); docs/theory/droplets.md.
    """

    dimension: ClassVar[int] = 3

    tension: float | Sequence[float] = 1.0
    _: KW_ONLY
    adhesion: ByPair = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "tension", one_or_each("tension", self.tension))
        values = np.atleast_1d(self.tension)
        if not ((values > 0.0) & (values < np.inf)).all():
            raise ParameterError(
                f"tension must be positive, as droplets have nothing else, not "
                f"{shown(np.asarray(self.tension))}"
            )
        object.__setattr__(self, "adhesion", adhesion_of(self.adhesion))
        rows = 1 if isinstance(self.adhesion, float) else len(self.adhesion)
        count_of = len(values) if len(values) > 1 else rows
        matrix = pair_matrix("adhesion", self.adhesion, count_of)
        tensions = np.broadcast_to(values, count_of)
        for w, one, other in np.broadcast(matrix, tensions[:, None], tensions):
            _refuse(core.invalid_for_droplet_film(w, one, other))

    def __repr__(self) -> str:
        return as_call(self, adhesion=0.0)

    @property
    def sticks(self) -> bool:
        """Whether any droplets have an adhesion."""
        return bool(np.max(self.adhesion) > 0.0)

    @property
    def name(self) -> str:
        """`droplet`, in files."""
        return "droplet"

    @property
    def reach(self) -> float:
        """How far beyond its undeformed sphere a droplet may touch, in radii."""
        return core.largest_bulge

    def species_parameters(self, radii: Sequence[float] | NDArray[np.float64]) -> SpeciesParameters:
        """As for `Ring`: the volume is kept, kA = inf, and all else but the tension is 0.

        Raises:
            ParameterError: there are more species.
        """
        radii = radii_of_species(radii)
        tension = per_species(self.tension, len(radii))
        return SpeciesParameters.like(len(radii), kA=np.inf, tension=tension)


@dataclass(frozen=True, repr=False)
class SoftContact:
    """Soft disks, or spheres in space: particles that do not deform, and repel where they overlap.

        U = k/2 sum_pairs (R_i + R_j - d)^2 over pairs with d < R_i + R_j

    A wall at the distance h adds k/2 (R - h)^2, and does not stop a particle whose center has
    passed it.

    Args:
        k: stiffness of a contact [energy/length^2].

    Raises:
        ParameterError: k is not a positive number.

    Source: C. S. O'Hern et al., Phys. Rev. E 68, 011306 (2003).
    """

    sticks: ClassVar[bool] = False

    k: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "k", positive("k", self.k))

    def __repr__(self) -> str:
        return as_call(self)

    @property
    def name(self) -> str:
        """`soft`, in files."""
        return "soft"


AnyLaw = Law | Droplet

# By the names that files have.
ALL_LAWS: dict[str, AnyLaw] = {**LAWS, "droplet": Droplet()}


# Of a packing that jams.
Jamming = AnyLaw | SoftContact


def check_dimension(law: AnyLaw, dimension: int) -> None:
    """Refuse a law of the plane in three dimensions, and `Droplet` in the plane.

    Raises:
        ParameterError: law and dimension do not fit.
    """
    if law.dimension == 2:
        refuse_space(f"the law {type(law).__name__}", dimension, "take `Droplet`")
    elif dimension == 2:
        raise ParameterError(
            "Droplet is for three dimensions, and this packing has two: droplets in the plane are "
            "Ring(kA=math.inf, kP=0.0, tension=1.0)"
        )


def sticks(law: Jamming, walls: Sequence[Wall]) -> bool:
    """Whether any particles have an adhesion, to each other or to a wall."""
    return law.sticks or any(wall.adhesion > 0.0 for wall in walls)


def refuse_adhesion(law: Jamming, walls: Sequence[Wall], why: str) -> None:
    """Refuse particles that stick, for what does not know adhesion.

    Args:
        law: of the particles.
        walls: around them.
        why: a phrase that completes "particles have an adhesion".

    Raises:
        ParameterError: there is an adhesion.
    """
    if sticks(law, walls):
        raise ParameterError(f"particles have an adhesion{why}: take adhesion=0")


def check_sticky_walls(packing: Packing, law: AnyLaw) -> None:
    """Refuse walls to which particles of this law cannot stick.

    Raises:
        ParameterError: the contacts are not curved, or a species has a tension that is too small,
            an infinite kP, or a skin.
    """
    kinds = sorted({*packing.species.tolist()})
    parameters = law.species_parameters(packing.species_radii)
    for n, wall in enumerate(packing.walls, start=1):
        if wall.adhesion == 0.0:
            continue
        if not (isinstance(law, Droplet) or (isinstance(law, Ring) and law.contact == "curved")):
            raise ParameterError(
                f"{wall._kind} {n}: adhesion needs contact lines that bend, to meet outlines at an "
                "angle: use Ring(contact='curved'), or adhesion 0"
            )
        for kind in kinds:
            of_kind = [float(values[kind]) for values in parameters]
            if isinstance(law, Droplet):
                problem = core.invalid_for_droplet_film(wall.adhesion, of_kind[-1])
            else:
                problem = core.invalid_for_adhesion(wall.adhesion, *of_kind)
            if problem:
                raise ParameterError(f"{wall._kind} {n}, species {kind}: {problem}")


# Energies are quartic in the indentation a: S ~ K a^2/2, p = kA S, L = K a. So a contact has the
# stiffness d(p L)/da = 3 K p for any law, with K about 15.
STIFFNESS_PER_PRESSURE = 50.0

# Verlet is stable up to dt = 2/omega. Contacts of stiffness k give omega^2 = 6 k at most, where all
# neighbors of a triangular lattice move against the particle (mass 1). Packings are softer.
_STABLE = 2.0 / np.sqrt(6.0 * STIFFNESS_PER_PRESSURE)

# The default is this part of the longest step that is accepted. The kinetic energy of an oscillator
# is then wrong by (omega dt)^2/8, which is 2 % for the stiffest one.
ACCURATE = 0.2

# Energy of one particle over the temperature that collisions exceed with a probability of e^-10.
HOTTEST = 10.0

# A contact of the indentation a has p = kA K a^2/2 and the force F = p K a, so that
# p = _BY_FORCE (kA F^2)^(1/3). Forces on many particles add up in a contact to so many of them.
_BY_FORCE = (1.0 / (2.0 * 15.0)) ** (1.0 / 3.0)
_TOGETHER = 10.0

# The largest eigenvalue of the Hessian of droplets over their tension: no less than random packings
# and fcc, bcc and sc crystals have at any density (tests/python/protocols/test_space_motion.py).
_STIFFEST = 18.0

# Smallest pressure that limits the step, over the stiffness: particles at rest do not move.
_AT_REST = 1e-12


def accurate_step(packing: Packing, law: AnyLaw, squeeze: float, temperature: float) -> float:
    """The default time step of `move` [time]; that of the minimizer is about the same.

    Arguments as for `longest_step`.
    """
    return ACCURATE * longest_step(packing, law, squeeze, temperature)


def longest_step(packing: Packing, law: AnyLaw, squeeze: float, temperature: float) -> float:
    """The longest time step that is accepted [time]: stable, with room for pressures that rise.

    Packings of rings at rest are stable up to about 3.5 times this step (docs/units.md), droplets
    in space up to this one.

    The stiffness of contacts is proportional to the pressure p of their particles. The largest p is
    the present one, or that of a particle with much thermal energy U: U >= p^2 / (2 kA) and U >= (p
    R)^2 / (2 kP). With a tension p = tension/R + p', where U >= p'^2 R^3 / (4 tension) too: six
    contacts have U = 34 tension a^2/R and p' = 11 tension a/R^2 at the indentation a.

    In three dimensions it follows from the tension alone.

    Args:
        packing: the particles.
        law: their contact law.
        squeeze: the largest pressure inside a particle [energy/length^2]; of droplets in three
            dimensions the largest load.
        temperature: of the motion [energy].
    """
    if isinstance(law, Droplet):
        tension = law.species_parameters(packing.species_radii).of(packing.species).tension
        return float(2.0 / np.sqrt(_STIFFEST * tension.max()))
    kA, kP, skin, tension, *_ = law.species_parameters(packing.species_radii).of(packing.species)
    radius = packing.radii - skin
    by_tension = 2.0 * tension / radius**3
    stiffness = np.minimum(kA, kP / radius**2 + by_tension)
    hot = float((tension / radius + np.sqrt(2.0 * stiffness * HOTTEST * temperature)).max())
    at_rest = _AT_REST * float(stiffness.max()) * float(packing.radii.min()) ** 2
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
    kA, kP, skin, tension, *_ = law.species_parameters(packing.species_radii).of(packing.species)
    radius = packing.radii - skin
    if isinstance(law, Droplet):  # two contacts
        return float(np.max(2.0 * _TOGETHER * force / (8.0 * np.pi * tension * radius)))
    stiffness = np.minimum(kA, (kP + 2.0 * tension / radius) / radius**2)
    pushed = _BY_FORCE * np.cbrt(stiffness * (_TOGETHER * force) ** 2)
    return float((tension / radius + pushed).max())


# Pressures p in natural units over x = phi - phi_J: 0.4 x for disks, x for droplets, 5 x^3 for
# rings; in three dimensions droplets have x = 0.8 p ln(1 + 1/p).
_DISKS, _DROPLETS, _RINGS, _IN_SPACE = 0.4, 1.0, 5.0, 0.8

# Iterations for the inverse of the last one, which come closer by 1/((1 + p) ln(1 + 1/p)) each.
_INVERTED = 100


def natural_pressure(packing: Packing, law: Jamming) -> float:
    """The unit of pressure of a contact law [energy/length^2].

        <kA R0^2 kP / (kA R0^2 + kP) + tension/R0>

    is the mean over deformable particles, with their mean radius R0: kA R0^2 if the perimeter is
    conserved, kP if the area is, tension/R0 of droplets. For soft disks it is their stiffness k,
    for soft spheres k/(2 R0).
    """
    r0 = float(packing.radii.mean())
    if isinstance(law, SoftContact):
        return law.k if packing.dimension == 2 else 0.5 * law.k / r0
    kA, kP, _, tension, *_ = law.species_parameters(packing.species_radii).of(packing.species)
    compliance = 1.0 / (kA * r0**2) + 1.0 / np.where(kP > 0.0, kP, np.inf)
    stiffness = np.where(kP > 0.0, 1.0 / np.where(compliance > 0.0, compliance, 1.0), 0.0)
    return float(np.mean(stiffness + tension / r0))


def excess_phi(p: float, packing: Packing, law: Jamming) -> float:
    """phi - phi_J at a pressure p in natural units.

    p = 5 x^3 of rings, p = x of droplets, p = 0.4 x of disks; x = 0.8 p ln(1 + 1/p) of
    droplets in three dimensions.
    """
    if isinstance(law, SoftContact):
        return p / _DISKS
    if isinstance(law, Droplet):
        return float(_IN_SPACE * p * np.log1p(1.0 / p)) if p > 0.0 else 0.0
    return p / _DROPLETS if _droplets(packing, law) else (max(p, 0.0) / _RINGS) ** (1.0 / 3.0)


def pressure_above_onset(excess: float, packing: Packing, law: Jamming) -> float:
    """The pressure in natural units at this phi - phi_J, the inverse of `excess_phi`."""
    if isinstance(law, SoftContact):
        return _DISKS * excess
    if isinstance(law, Droplet):
        pressure = excess
        for _ in range(_INVERTED):
            pressure = excess / (_IN_SPACE * float(np.log1p(1.0 / pressure)))
        return pressure
    return _DROPLETS * excess if _droplets(packing, law) else _RINGS * excess**3


def _droplets(packing: Packing, law: Law) -> bool:
    return bool(np.all(law.species_parameters(packing.species_radii).tension > 0.0))


def filled_area(area: Floats, perimeter: Floats, skin: Floats) -> Floats:
    """A + P s + pi s^2 of particles of the area A and the perimeter P within skins of thickness s.

    Args:
        area: shape (N,) [length^2].
        perimeter: shape (N,) [length].
        skin: shape (N,) [length].
    """
    return area + skin * perimeter + np.pi * skin**2


def volumes(radius: Floats, dimension: int) -> Floats:
    """Area of each disk, pi R^2, or volume of each sphere, 4 pi R^3/3, shape (N,)."""
    return np.pi * radius**2 if dimension == 2 else 4.0 / 3.0 * np.pi * radius**3


def undeformed(radius: Floats, dimension: int) -> float:
    """Area of all disks, sum pi R^2, or volume of all spheres, sum 4 pi R^3/3."""
    if dimension == 2:
        return float(np.pi * np.sum(radius**2))
    return float(4.0 / 3.0 * np.pi * np.sum(radius**3))


def root(ratio: float, dimension: int) -> float:
    """The ratio of lengths to a ratio of areas, or of volumes."""
    return float(np.sqrt(ratio) if dimension == 2 else np.cbrt(ratio))

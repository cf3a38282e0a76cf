"""Friction, damping and films of contacts: settings, memory, and the table of a state.

Contacts that rub remember their springs, and particles spin: positions alone do not tell that.
"""

from __future__ import annotations

import re
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.checks import expect, positive
from ..common.errors import ParameterError
from ..common.files import comment_lines, rows_in_comments
from .laws import AnyLaw, ByPair, Ring, Sector, by_pair, pair_matrix

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .packing import Packing

_NAMES = ("mu", "kt", "gt", "damping", "film", "restitution")

# Masses are 1, and 1 + m R^2/I is that of spheres at most.
_MASS, _LEVER = 1.0, 3.5

# At this part of the longest time step energies and restitution are right to a percent.
_ACCURATE = 0.1


@dataclass(frozen=True)
class Friction:
    """Friction and damping of contacts, for `Simulation`.

    The sides of a contact move against each other by v. A spring of the length xi along the contact
    and a dashpot have the force, by which both sides rub, and another dashpot damps the normal:

        f_t = kt xi + gt dxi/dt,   dxi/dt = v.t,   held to |f_t| <= mu max(f, 0)
        f_d = min(damping v.n, max(f, 0))

    f is the elastic force of the contact. With a restitution e below 1 that dashpot follows from
    the contact: two particles that meet head on part with e times their velocity, whatever the law
    and the velocity. A film of the size S between the sides, its length in the
    plane or its area in space, drags them by

        film S |v|^(power - 1) v

    along the contact and along its normal. Particles turn: their spins have the moments of inertia
    m R^2/2 of disks or 2 m R^2/5 of spheres. See *fix deformable/friction*.

    Args:
        mu: coefficient of friction, 0 or more; `math.inf` is a contact that does not slip.
        kt: stiffness of the spring [energy/length^2]; about half of that of the contact is usual.
        gt: constant of the dashpot along the contact [force/velocity].
        damping: constant of the dashpot along its normal [force/velocity].
        film: constant of films [force/(size velocity^power)].
        power: of the velocity in the force of a film, above 0, 1 at most; for all contacts.
        restitution: coefficient of restitution e, above 0, 1 at most: it damps in the place of
            `damping`, which is 0 then. Lines of contacts have one force: not with `radical`.
        walls: of contacts with walls, each a number; if not given they are as those of particles.
        ledger: whether states tell where energy is lost: `State.lost_by_particle`, and the `power`
            of contacts.

    Each of mu to film, and restitution, is a number for all pairs, or a symmetric matrix with a row
    and a column for each species.

    Raises:
        ParameterError: a value is no such number or matrix, is negative, or must be finite.

    Source: Cundall and Strack, Geotechnique 29, 47 (1979); LAMMPS' *pair_style granular*;
    restitution: Schwager and Poschel, Granular Matter 9, 465 (2007).
    """

    mu: ByPair
    _: KW_ONLY
    kt: ByPair
    gt: ByPair = 0.0
    damping: ByPair = 0.0
    film: ByPair = 0.0
    power: float = 1.0
    restitution: ByPair = 1.0
    walls: Friction | None = None
    ledger: bool = False

    def __post_init__(self) -> None:
        for name in _NAMES:
            object.__setattr__(self, name, by_pair(name, getattr(self, name)))
        object.__setattr__(self, "power", positive("power", self.power))
        for row in self._rows():
            *of_pair, restitution = row
            if problem := core.invalid_friction(*[*of_pair, self.power, restitution]):
                raise ParameterError(problem.replace("damp must", "damping must"))
        expect("walls", self.walls, Friction, type(None))
        expect("ledger", self.ledger, bool)
        if self.walls and (self.walls._by_species or self.walls.walls):
            raise ParameterError(
                f"friction with walls has one number for each of {', '.join(_NAMES)}"
            )

    @property
    def _rubs(self) -> bool:
        """Whether any particles do: dashpots alone damp."""
        return bool(np.any(np.asarray(self.mu) > 0.0))

    @property
    def _by_species(self) -> bool:
        """Whether a value differs by species."""
        return any(np.ndim(getattr(self, name)) for name in _NAMES)

    @property
    def _bounces(self) -> bool:
        """Whether any contacts have a restitution below 1."""
        own = np.any(np.asarray(self.restitution) < 1.0)
        return bool(own) or bool(self.walls and self.walls._bounces)

    def _rows(self) -> list[list[float]]:
        """What `_NAMES` names, of each pair of as many species as matrices have."""
        species = max(len(np.atleast_1d(getattr(self, name))) for name in _NAMES)
        rows: list[list[float]] = values_of_pairs(self, species).reshape(-1, len(_NAMES)).tolist()
        return rows


def has_films(friction: Friction) -> bool:
    """Whether any contacts have films that drag."""
    return bool(np.any(friction.film)) or bool(friction.walls and has_films(friction.walls))


def overdamped_part(friction: Friction) -> float:
    """Part of the usual time step; less than 1 below e^-2, that of critical damping."""
    least = float(np.min(friction.restitution) * np.exp(2.0))
    return min(1.0, least, overdamped_part(friction.walls) if friction.walls else 1.0)


def longest_rubbing_step(friction: Friction) -> float:
    """The longest time step that *fix deformable/friction* takes [time]."""
    own = min(
        core.friction_time_step(mu, kt, gt, damp, _MASS, _LEVER)
        for mu, kt, gt, damp, *_ in friction._rows()
    )
    return min(own, longest_rubbing_step(friction.walls)) if friction.walls else own


def rubbing_step(friction: Friction) -> float:
    """The longest one that is accurate to a few percent [time]."""
    return _ACCURATE * longest_rubbing_step(friction)


def values_of_pairs(friction: Friction, species: int) -> NDArray[np.float64]:
    """What `_NAMES` names, of each pair, shape (species, species, 6).

    Raises:
        ParameterError: there are more species.
    """
    return np.stack([pair_matrix(name, getattr(friction, name), species) for name in _NAMES], 2)


def check_friction(friction: Friction, packing: Packing, law: AnyLaw) -> None:
    """Refuse friction where contacts do not slip, or where coefficients are missing.

    Raises:
        ParameterError: the law is `Sector`, or it is radical and contacts have a restitution; or
            there are more species; or there are walls, and coefficients by species
            only.
    """
    expect("friction", friction, Friction)
    if isinstance(law, Sector):
        raise ParameterError(
            "friction needs contacts that slip, and those of Sector stick: take Ring"
        )
    if friction._bounces and isinstance(law, Ring) and law.contact == "radical":
        raise ParameterError(
            "a restitution needs contacts with one force, and those of radical have two: take "
            "contact='balanced' or 'curved'"
        )
    values_of_pairs(friction, len(packing.species_radii))
    if packing.walls and friction._by_species and friction.walls is None:
        raise ParameterError(
            "friction differs by species, and walls have none: give it walls=Friction(mu, kt=kt)"
        )


# ID of the fix: one that a user would not take.
FRICTION = "deformable_friction"

# Springs in a line.
_SPRINGS = 20

_LOSSES = 4

_DAMPED = """
fix deformable_move all nve/sphere{disc}
fix deformable_drag all viscous {rate!r}
variable deformable_inertia atom {inertia}*mass*radius^2
fix deformable_turn all viscous/sphere {rate!r} scale v_deformable_inertia
"""

# Of a trajectory, in the plane and in space.
_SPIN, _SPINS = ("spin",), ("spin_x", "spin_y", "spin_z")
_LOST = ("lost_sliding", "lost_dashpots", "lost_damping", "lost_films")


class Rubbing(NamedTuple):
    """What goes on where contacts rub.

    Attributes:
        spins: angular velocities of the particles, shape (N,), in space (N, 3) [1/time].
        springs: of the contacts, a row for each: the ID from 1 of its particle, that of its partner
            or the code below 0 of a wall; the vector to the center of the partner, 0 of a wall; the
            length xi of the spring; the forces f_t and f_d; and of films their parts along the
            contact and along its normal. In space n x v stands for a vector v along the contact.
        lost: energies lost so far by sliding, in the dashpots gt, in the other dashpots, by films.
        stored: energy of the springs; known of states only.
        places: of the springs, shape (M, 2 d): the normal of the contact, and the vector from the
            particle to the center of its partner or to the wall; known of states only.
        by_particle: `lost` of each particle, shape (N, 4); None without a ledger.
    """

    spins: NDArray[np.float64]
    springs: NDArray[np.float64]
    lost: tuple[float, ...] = (0.0,) * _LOSSES
    stored: float = 0.0
    places: NDArray[np.float64] = np.zeros((0, 4))
    by_particle: NDArray[np.float64] | None = None

    @property
    def dimension(self) -> int:
        """2, or 3 in space."""
        return 2 if self.spins.ndim == 1 else 3


def friction_commands(friction: Friction | None, species: int) -> str:
    """The fix for particles of so many species; none without friction."""
    if friction is None:
        return ""
    pairs = values_of_pairs(friction, species)
    words = [_numbers(pairs[0, 0].tolist(), friction.power, " damp")]
    if friction._by_species:
        words += [
            f"types {i + 1} {j + 1}{_numbers(pairs[i, j].tolist(), friction.power)}"
            for i in range(species)
            for j in range(i, species)
        ]
    if friction.walls:
        of_walls = values_of_pairs(friction.walls, 1)[0, 0].tolist()
        words.append(f"types * wall{_numbers(of_walls, friction.walls.power)}")
    if friction.ledger:
        words.append(" ledger yes")
    return f"fix {FRICTION} all deformable/friction{' '.join(words)}\n"


def inertia(dimension: int) -> float:
    """I/(m R^2) of a particle that turns: a disk in the plane, a ball in space."""
    return 0.5 if dimension == 2 else 0.4


def damped_commands(rate: float, dimension: int) -> str:
    """Commands for motion where velocities and spins decay, as I dw/dt = - rate I w."""
    disc = " disc" * (dimension == 2)
    return _DAMPED.format(rate=rate, disc=disc, inertia=inertia(dimension)).strip()


def undamped_commands() -> str:
    """Commands that end that motion."""
    names = (line.split()[1] for line in _DAMPED.splitlines() if line.startswith("fix "))
    return "\n".join(f"unfix {name}" for name in names)


def _numbers(values: list[float], power: float, before_damp: str = "") -> str:
    mu, kt, gt, damp, film, restitution = values
    words = f" {mu!r} {kt!r} {gt!r}{before_damp} {damp!r}"
    words += f" restitution {restitution!r}" if restitution < 1.0 else ""
    return words + (f" film {film!r} {power!r}" if film else "")


def spring_commands(friction: Friction | None, rubbing: Rubbing | None) -> str:
    """Commands that give the fix its springs and losses; none if they are not given.

    Films that a former friction did not have begin without a force.
    """
    if friction is None or rubbing is None:
        return ""
    lines = [f"lost {' '.join(map(repr, rubbing.lost))}", "springs none"]
    columns = _columns(rubbing.spins)
    springs, films = np.split(rubbing.springs, [columns], axis=1)
    if has_films(friction):
        more = 2 if rubbing.dimension == 2 else 4
        films = films if films.shape[1] else np.zeros((len(springs), more))
        springs = np.column_stack([springs, films])
    for n in range(0, len(springs), _SPRINGS):
        lines.append("springs" + "".join(_words(springs[n : n + _SPRINGS])))
    return "".join(f"fix_modify {FRICTION} {line}\n" for line in lines)


def _words(springs: NDArray[np.float64]) -> list[str]:
    return [
        f" {round(i)} {round(j)} {' '.join(map(repr, numbers))}"
        for i, j, *numbers in springs.tolist()
    ]


def rubbing_lines(rubbing: Rubbing | None) -> str:
    """Comments at the end of a data file; none without friction. Spins are among its velocities."""
    if rubbing is None:
        return ""
    lost = np.array([rubbing.lost])
    text = comment_lines("spring", rubbing.springs) + comment_lines("lost by friction", lost)
    return text + comment_lines("lost by particle", rubbing.by_particle)


def _losses(numbers: Any) -> tuple[float, ...]:
    """They were three before there were films.

    Raises:
        ValueError: they are damaged.
    """
    found = tuple(map(float, numbers))
    if len(found) not in (_LOSSES - 1, _LOSSES):
        raise ValueError(f"it has {len(found)} losses by friction")
    return (*found, *(0.0,) * (_LOSSES - len(found)))


def rubbing_in(text: str, spins: NDArray[np.float64]) -> Rubbing | None:
    """What the comments of a data file have, beside the spins of its velocities.

    Raises:
        ValueError: they are damaged.
    """
    first = re.search(r"^# spring (.+)$", text, re.MULTILINE)
    columns = len(first[1].split()) if first and first[1] != "none" else _columns(spins)
    springs = rows_in_comments(text, "spring", columns)
    lost = rows_in_comments(text, "lost by friction", 1)
    if springs is None or lost is None:
        return None
    each = rows_in_comments(text, "lost by particle", _LOSSES)
    if each is not None and len(each) != len(spins):
        raise ValueError(f"it has losses of {len(each)} of {len(spins)} atoms")
    return Rubbing(spins, springs, _losses(lost.ravel()), by_particle=each)


def _columns(spins: NDArray[np.float64]) -> int:
    """Numbers of a spring without a film."""
    return 7 if spins.ndim == 1 else 12


def rubbing_as_json(rubbing: Rubbing | None) -> dict[str, Any]:
    """All but what is in columns of a trajectory; nothing without friction."""
    if rubbing is None:
        return {}
    return {"springs": rubbing.springs.tolist(), "lost_by_friction": list(rubbing.lost)}


def rubbing_from_json(
    saved: Mapping[str, Any], columns: Mapping[str, NDArray[np.float64]]
) -> Rubbing | None:
    """The inverse of `rubbing_as_json` and `rubbing_as_columns`.

    Raises:
        KeyError, ValueError, TypeError: it is damaged.
    """
    if "springs" not in saved:
        return None
    names = _SPINS if _SPINS[0] in columns else _SPIN
    spins = np.column_stack([columns[name] for name in names])
    spins = spins[:, 0] if names is _SPIN else spins
    rows = saved["springs"]
    width = len(rows[0]) if rows else _columns(spins)
    springs = np.array(rows, np.float64).reshape(-1, width)
    lost = _losses(saved["lost_by_friction"])
    each = np.column_stack([columns[name] for name in _LOST]) if _LOST[0] in columns else None
    return Rubbing(np.ascontiguousarray(spins), springs, lost, by_particle=each)


def rubbing_as_columns(rubbing: Rubbing | None) -> dict[str, NDArray[np.float64]]:
    """Spins, and what particles have lost, as columns of a trajectory; none without friction."""
    if rubbing is None:
        return {}
    spins = dict(zip(_SPINS, rubbing.spins.T, strict=True)) if rubbing.dimension == 3 else {}
    found = spins or {_SPIN[0]: rubbing.spins}
    if rubbing.by_particle is not None:
        found |= dict(zip(_LOST, rubbing.by_particle.T, strict=True))
    return found


Floats = NDArray[np.float64]


def rubbing_columns(dimension: int, ledger: bool = False) -> np.dtype[np.void]:
    """Columns that follow those of contacts that slip freely.

    What lies along the contact is a number in the plane, in the direction of the normal turned
    left, and a vector in space. Forces are those on i [energy/length].
    """
    along = () if dimension == 2 else (3,)
    # lost by sliding, dashpots along and across it, and films; of both sides [energy/time]
    power = [("power", float, (_LOSSES,))] * ledger
    return np.dtype(
        [
            ("friction", float, along),  # f_t
            ("damping", float),  # f_d, along the normal
            ("spring", float, along),  # xi [length]
            ("sliding", bool),  # whether the friction has its largest value
            ("film_vector", float, (dimension,)),  # of the film, along the contact and its normal
            *power,
        ]
    )

"""What contacts that rub remember, and spins: a memory that positions do not have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..model.friction import Friction
from .comments import comment_lines, rows_in_comments

# ID of the fix: one that a user would not take.
FRICTION = "deformable_friction"

# Numbers of a spring, and springs in a line.
_NUMBERS, _SPRINGS = 7, 20

_LOSSES = 3

_DAMPED = """
fix deformable_move all nve/sphere disc
fix deformable_drag all viscous {rate!r}
variable deformable_inertia atom 0.5*mass*radius^2
fix deformable_turn all viscous/sphere {rate!r} scale v_deformable_inertia
"""

# Of a trajectory.
_SPIN = "spin"


class Rubbing(NamedTuple):
    """What goes on where contacts rub.

    Attributes:
        spins: angular velocities of the particles, shape (N,) [1/time].
        springs: of the contacts, shape (M, 7): the ID from 1 of its particle, that of its partner
            or the code below 0 of a wall; the vector to the center of the partner, 0 of a wall; the
            length xi of the spring; the forces f_t and f_d.
        lost: energies lost so far by sliding, in the dashpots gt, and in the dashpots damp.
        stored: energy of the springs; known of states only.
        places: of the springs, shape (M, 4): the normal of the contact, and the vector from the
            particle to the center of its partner or to the wall; known of states only.
    """

    spins: NDArray[np.float64]
    springs: NDArray[np.float64]
    lost: tuple[float, float, float] = (0.0, 0.0, 0.0)
    stored: float = 0.0
    places: NDArray[np.float64] = np.zeros((0, 4))


def friction_commands(friction: Friction | None, species: int) -> str:
    """The fix for particles of so many species; none without friction."""
    if friction is None:
        return ""
    pairs = friction.of_pairs(species)
    words = [_numbers(pairs[0, 0].tolist(), " damp")]
    if friction.by_species:
        words += [
            f"types {i + 1} {j + 1}{_numbers(pairs[i, j].tolist())}"
            for i in range(species)
            for j in range(i, species)
        ]
    if friction.walls:
        words.append(f"types * wall{_numbers(friction.walls.of_pairs(1)[0, 0].tolist())}")
    return f"fix {FRICTION} all deformable/friction{' '.join(words)}\n"


def damped_commands(rate: float) -> str:
    """Commands for motion where velocities and spins decay, as I dw/dt = - rate I w."""
    return _DAMPED.format(rate=rate).strip()


def undamped_commands() -> str:
    """Commands that end that motion."""
    names = (line.split()[1] for line in _DAMPED.splitlines() if line.startswith("fix "))
    return "\n".join(f"unfix {name}" for name in names)


def _numbers(values: list[float], before_last: str = "") -> str:
    mu, kt, gt, damp = values
    return f" {mu!r} {kt!r} {gt!r}{before_last} {damp!r}"


def spring_commands(rubbing: Rubbing | None) -> str:
    """Commands that give the fix its springs and losses; none if they are not given."""
    if rubbing is None:
        return ""
    lines = [f"lost {' '.join(map(repr, rubbing.lost))}", "springs none"]
    for n in range(0, len(rubbing.springs), _SPRINGS):
        lines.append("springs" + "".join(_words(rubbing.springs[n : n + _SPRINGS])))
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
    return comment_lines("spring", rubbing.springs) + comment_lines("lost by friction", lost)


def rubbing_in(text: str, spins: NDArray[np.float64]) -> Rubbing | None:
    """What the comments of a data file have, beside the spins of its velocities.

    Raises:
        ValueError: they are damaged.
    """
    springs = rows_in_comments(text, "spring", _NUMBERS)
    lost = rows_in_comments(text, "lost by friction", _LOSSES)
    if springs is None or lost is None:
        return None
    ((sliding, dashpots, damping),) = lost.tolist()
    return Rubbing(spins, springs, (sliding, dashpots, damping))


def rubbing_as_json(rubbing: Rubbing | None) -> dict[str, Any]:
    """All but the spins, which are in a trajectory; nothing without friction."""
    if rubbing is None:
        return {}
    return {"springs": rubbing.springs.tolist(), "lost_by_friction": list(rubbing.lost)}


def rubbing_from_json(
    saved: Mapping[str, Any], columns: Mapping[str, NDArray[np.float64]]
) -> Rubbing | None:
    """The inverse of `rubbing_as_json` and `spin_column`.

    Raises:
        KeyError, ValueError, TypeError: it is damaged.
    """
    if "springs" not in saved:
        return None
    sliding, dashpots, damping = map(float, saved["lost_by_friction"])
    springs = np.array(saved["springs"], np.float64).reshape(-1, _NUMBERS)
    return Rubbing(columns[_SPIN], springs, (sliding, dashpots, damping))


def spin_column(rubbing: Rubbing | None) -> dict[str, NDArray[np.float64]]:
    """The spins as a column of a trajectory; none without friction."""
    return {} if rubbing is None else {_SPIN: rubbing.spins}

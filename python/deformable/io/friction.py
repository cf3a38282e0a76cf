"""Friction of contacts as a fix of LAMMPS."""

from __future__ import annotations

from ..model.friction import Friction

# ID of the fix: one that a user would not take.
FRICTION = "deformable_friction"


def friction_commands(friction: Friction | None, species: int) -> str:
    """The command for particles of so many species; none without friction."""
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


def _numbers(values: list[float], before_last: str = "") -> str:
    mu, kt, gt, damp = values
    return f" {mu!r} {kt!r} {gt!r}{before_last} {damp!r}"

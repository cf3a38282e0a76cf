"""Films, the contacts of particles that stick, as text: a memory that positions do not have.

A film is a row of two numbers: the IDs of its particles; or the ID of one, and the code below 0 of
a wall, as compute deformable/contact tells it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ..model.droplet import AnyLaw
from ..model.sticking import sticks
from ..model.walls import Wall
from .comments import comment_lines, rows_in_comments

Films = NDArray[np.int64]

# Of a line.
_FILMS = 10


def film_commands(law: AnyLaw, walls: Sequence[Wall], films: Films | None = None) -> str:
    """Commands after those of the law and the walls, before the first run.

    Args:
        law: of the particles.
        walls: around them.
        films: that there are; those of circles that overlap, if not given.
    """
    if not sticks(law, walls):
        return ""
    # with a law that sticks, the pair style has it already
    fix = [] if law.sticks else ["fix deformable_films all deformable/films"]
    return "\n".join([*fix, *memory_commands(films)]) + "\n"


def memory_commands(films: Films | None) -> list[str]:
    """Commands that make these films, and no other ones; none if they are not given."""
    if films is None:
        return []
    name = "fix_modify deformable_films attached"
    return [f"{name} none", *(f"{name} {row}" for row in _rows(films))]


def film_lines(films: Films | None) -> str:
    """Comments at the end of a data file; none without a memory."""
    return comment_lines("attached", films, _FILMS)


def films_in(text: str) -> Films | None:
    """The films in the comments of a data file.

    Raises:
        ValueError: they are damaged.
    """
    return rows_in_comments(text, "attached", 2, int)


def as_films(given: Sequence[Sequence[int]] | None) -> Films | None:
    """Films from JSON."""
    return None if given is None else np.array(given, np.int64).reshape(-1, 2)


def _rows(films: Films) -> Iterator[str]:
    for first in range(0, len(films), _FILMS):
        yield " ".join(map(str, films[first : first + _FILMS].ravel().tolist()))

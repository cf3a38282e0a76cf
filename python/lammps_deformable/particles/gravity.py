"""Gravity: a constant force on each particle, in the plane and in space.

LAMMPS' *fix gravity* acts in motion only. *fix addforce* acts in minimizations too, with the energy

    U = - sum g_i . r_i

of unwrapped positions r_i, as masses are 1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.checks import numbers, shown
from ..common.errors import ParameterError
from .containers import closed
from .laws import Droplet, Ring, Sector

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .packing import Packing
    from .walls import Wall

Floats = NDArray[np.float64]

# ID of the fix: one that a user would not take.
GRAVITY = "deformable_gravity"

# Forces on all particles together that count as zero, over the sum of their sizes.
_ROUNDING = 1e-12

# The constants act at once. Of species they are variables, as a user may change the types of atoms.
_ONE = f"""
fix {GRAVITY} all addforce {{x!r}} {{y!r}} {{z!r}}
fix_modify {GRAVITY} energy yes
"""
_BY_SPECIES = f"""
compute deformable_place all property/atom xu yu zu
variable deformable_gx atom {{x}}
variable deformable_gy atom {{y}}
variable deformable_gz atom {{z}}
variable deformable_height atom \
"-v_deformable_gx*c_deformable_place[1]-v_deformable_gy*c_deformable_place[2]\
-v_deformable_gz*c_deformable_place[3]"
fix {GRAVITY} all addforce v_deformable_gx v_deformable_gy v_deformable_gz \
energy v_deformable_height
fix_modify {GRAVITY} energy yes
"""


def as_gravity(given: ArrayLike | None, packing: Packing, law: Any) -> Floats | None:
    """The acceleration of all particles, shape (d,), or of each species; None without.

    Raises:
        ParameterError: it has another shape, or is not finite; or the law has none.
    """
    if given is None:
        return None
    if not isinstance(law, Ring | Sector | Droplet):
        raise ParameterError(f"{type(law).__name__} has no gravity: take Ring or Droplet")
    found, d = numbers("gravity", given), packing.dimension
    species = len(packing.species_radii)
    if found.shape not in ((d,), (species, d)):
        axes = ", ".join(f"g{axis}" for axis in "xyz"[:d])
        rows = f", or {species} rows of that, one for each species" if species > 1 else ""
        raise ParameterError(f"gravity must be ({axes}){rows}, not {shown(given)}")
    return found if found.any() else None


def gravity_commands(gravity: Floats | None) -> str:
    """The fix, which minimizers and the conserved energy know; none without gravity."""
    if gravity is None:
        return ""
    columns = np.zeros((3, *gravity.shape[:-1]))
    columns[: gravity.shape[-1]] = gravity.T
    x, y, z = columns.tolist()
    if gravity.ndim == 1:
        return _ONE.format(x=x, y=y, z=z).lstrip()
    return _BY_SPECIES.format(x=_by_type(x), y=_by_type(y), z=_by_type(z)).lstrip()


def _by_type(values: list[float]) -> str:
    """A formula of LAMMPS for a value by the type of the atom."""
    terms = [f"({value!r})*(type=={n})" for n, value in enumerate(values, start=1)]
    return f'"{"+".join(terms)}"'


def forces_of(gravity: Floats, species: NDArray[np.int64]) -> Floats:
    """Force on each particle, of these species, shape (N, d) [energy/length]."""
    return gravity[species] if gravity.ndim == 2 else np.tile(gravity, (len(species), 1))


def largest_weight(gravity: Floats | None) -> float:
    """The largest force of gravity on a particle, 0 without [energy/length]."""
    return 0.0 if gravity is None else float(np.linalg.norm(gravity, axis=-1).max())


def gravity_energy(
    gravity: Floats | None, packing: Packing, images: NDArray[np.int64] | None
) -> float:
    """U, see above [energy]."""
    if gravity is None:
        return 0.0
    positions = packing.positions
    if images is not None:
        positions = positions + images @ packing.box
    return -float(np.sum(forces_of(gravity, packing.species) * positions))


def check_held(gravity: Floats, species: NDArray[np.int64], walls: Sequence[Wall]) -> None:
    """Refuse to relax what falls without end: along a direction of the box that no wall closes.

    Obstacles may hold particles.

    Args:
        gravity: see `as_gravity`.
        species: of the particles, shape (N,).
        walls: around them.

    Raises:
        ParameterError: all particles together are pulled along such a direction.
    """
    if not all(wall.inside for wall in walls):
        return
    forces, shut = forces_of(gravity, species), closed(walls, gravity.shape[-1])
    pulled = np.abs(forces.sum(axis=0)) > _ROUNDING * np.abs(forces).sum()
    for axis, (pull, is_shut) in enumerate(zip(pulled, shut, strict=True)):
        if pull and not is_shut:
            raise ParameterError(
                f"gravity pulls the particles along {'xyz'[axis]}, where the box is periodic, so "
                "that they fall without end: give the packing walls, or let them move with "
                "run(drag=)"
            )

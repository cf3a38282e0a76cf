"""LAMMPS commands for the contacts of rings of beads, with each other and with walls, as text."""

from __future__ import annotations

from ..model.beads import Beads
from ..model.walls import Walls

# Longest edge of smooth rings over the one at rest.
_LONGEST_EDGE = 2.0

_ROUGH = """
pair_style harmonic/cut
pair_coeff * * {half!r} {range!r}
compute pairs all property/local patom1 patom2
compute overlaps all pair/local dx dy fx fy
"""

_SMOOTH = """
pair_style deformable/edge {longest!r}
pair_coeff * * {kr!r} {range!r}
"""


def ring_contact_commands(beads: Beads, spacing: float) -> str:
    """Commands for the contacts of rings, rough or smooth.

    Args:
        beads: settings of the rings.
        spacing: longest edge of a ring at rest [length].
    """
    style = _SMOOTH if beads.smooth else _ROUGH
    return style.format(
        longest=_LONGEST_EDGE * spacing,
        kr=beads.kr,
        half=0.5 * beads.kr,  # the energy of LAMMPS' style has no factor 1/2
        range=2.0 * beads.radius,
    )


def ring_wall_commands(beads: Beads, stick: bool) -> str:
    """Commands for walls with the stiffness of beads, at a distance of p from their centers.

    The energy of LAMMPS' harmonic wall has no factor 1/2; it ignores the second number, sigma.
    """
    slip = f"wall/region walls harmonic {0.5 * beads.kr!r} 1.0 {beads.radius!r}"
    style = f"deformable/stick walls {beads.kr!r} radius {beads.radius!r}" if stick else slip
    return f"fix walls all {style}\nfix_modify walls energy yes"


def region_within(walls: Walls) -> str:
    """Commands that define the region within walls."""
    planes = [
        f"region {side} plane {height * nx!r} {height * ny!r} 0 {-nx!r} {-ny!r} 0"
        for side, (nx, ny), height in zip(
            _sides(walls), walls.normal.tolist(), walls.height.tolist(), strict=True
        )
    ]
    return "\n".join(
        [*planes, f"region walls intersect {len(walls.angle)} {' '.join(_sides(walls))}"]
    )


def without_region(walls: Walls) -> str:
    """Commands that delete the region within walls."""
    return "\n".join(f"region {name} delete" for name in ("walls", *_sides(walls)))


def _sides(walls: Walls) -> list[str]:
    """Names of the regions of single walls."""
    return [f"side{n}" for n in range(len(walls.angle))]

"""LAMMPS commands as text: a packing, its law, its walls, films, and the minimizer.

A film is a contact of particles that stick, a memory that positions do not have: a row of two
numbers, the IDs of its particles; or the ID of one, and the code below 0 of a wall, as *compute
deformable/contact* tells it.
"""

from __future__ import annotations

from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..common.files import comment_lines, rows_in_comments
from .containers import closed
from .laws import AnyLaw, Droplet, Ring, sticks
from .walls import PolygonWall, SurfaceWall, Wall

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from .packing import Packing
    from .polygons import DeformablePolygon, Walls

SETUP = """
units lj
dimension {dimension}
boundary {boundary}
atom_style {style}
atom_modify map yes
newton on
box tilt large
"""

# Of particles in a periodic box in the plane, without radii of their own.
PLANE = SETUP.format(dimension=2, boundary="p p p", style="atomic")

_LAW = """
pair_style {style} radius {whose}
pair_coeff * * "{file}" {names}
"""

_LISTS = """
neighbor {skin!r} bin
neigh_modify delay 0 every 1 check yes
"""

# Bins of a dilute packing at most, or for each particle.
_MOST_BINS, _BINS_EACH = 1_000_000, 10

_WIDE = """
neigh_modify binsize {size!r}
atom_modify sort 1000 {size!r}
"""

_FIRE = """
min_style fire
min_modify dmax {dmax!r} norm max tmax {tmax!r}
"""

# Longest displacement in an iteration of FIRE, in smallest radii.
LONGEST_STEP = 0.005

# Its steps are bounded by the overlaps.
LBFGS = """
min_style deformable/lbfgs
min_modify norm max
"""

# Longest edge of smooth polygons over the one at rest.
_LONGEST_EDGE = 2.0

_BEAD = """
pair_style harmonic/cut
pair_coeff * * {half!r} {range!r}
compute pairs all property/local patom1 patom2
compute overlaps all pair/local dx dy fx fy
"""

_SMOOTH = """
pair_style deformable/edge {longest!r}
pair_coeff * * {kr!r} {range!r}
"""

# ID of the fix of a wall, counted from 1: one that a user would not take.
WALL = "deformable_wall_{}"


def boundary(walls: Sequence[Wall], dimension: int) -> str:
    """LAMMPS boundary: fixed where a container closes the box."""
    return " ".join("f" if shut else "p" for shut in (*closed(walls, dimension), False)[:3])


def setup_commands(packing: Packing) -> str:
    """Commands to run before LAMMPS has a box."""
    return SETUP.format(
        dimension=packing.dimension,
        style=atom_style(packing),
        boundary=boundary(packing.walls, packing.dimension),
    )


def wall_commands(walls: Sequence[Wall]) -> str:
    """Commands for the walls, a fix for each, so that each has its force."""
    lines = []
    for n, wall in enumerate(walls, start=1):
        count = f"{len(wall.corners)} " if isinstance(wall, (PolygonWall, SurfaceWall)) else ""
        words = f"{wall._kind} {count}" + " ".join(f"{value:.17g}" for value in wall._values)
        words += f" adhesion {wall.adhesion!r}" * (wall.adhesion > 0.0)
        name = WALL.format(n)
        lines += [f"fix {name} all deformable/wall {words}", f"fix_modify {name} virial yes"]
    return "\n".join(lines) + "\n" * bool(lines)


def atom_style(packing: Packing) -> str:
    """LAMMPS atom_style for this packing."""
    return "sphere" if packing.own_radii else "atomic"


def pair_style(law: AnyLaw) -> str:
    """Name of the pair style of a contact law."""
    if isinstance(law, Droplet):
        return "deformable/droplet"
    return "deformable/ring" if isinstance(law, Ring) else "deformable/sector"


def pair_style_arguments(law: AnyLaw, threads: int | str | None = None) -> str:
    """Arguments of the pair style; threads: that share the balance of contacts, None: as LAMMPS."""
    arguments = f"contact {law.contact} reach {law.reach!r}" if isinstance(law, Ring) else ""
    has_balance = law.name not in ("radical", "sector")
    return arguments + f" threads {threads}" * (threads is not None and has_balance)


# Times count in contact periods sqrt(m/k): a step of 0.05 was fastest in FIRE, from 0.1 on it is at
# its stability limit.
SOFT_STEP = 0.05

# Radii of their own: grains without friction and damping. LAMMPS has no energy for them, but FIRE
# needs their forces only.
_GRAINS = """
comm_modify vel yes
pair_style gran/hooke {k!r} NULL 0.0 NULL 0.0 0
pair_coeff * *
"""


def soft_commands(packing: Packing, k: float) -> str:
    """Commands that define soft contacts by LAMMPS' own styles, U = k/2 overlap^2 of each pair."""
    if packing.own_radii:
        return _GRAINS.format(k=k)
    pairs = combinations_with_replacement(enumerate(packing.species_radii, start=1), 2)
    return "pair_style harmonic/cut\n" + "".join(
        f"pair_coeff {i} {j} {0.5 * k!r} {float(a + b)!r}\n"  # LAMMPS' energy has no 1/2
        for (i, a), (j, b) in pairs
    )


def law_commands(packing: Packing, law: AnyLaw, file: str, threads: int | str | None = None) -> str:
    """Commands for the contact law and its minimizer, to run once LAMMPS has the particles.

    Args:
        packing: gives the particles' sizes.
        law: the contact law.
        file: its species file.
        threads: see `pair_style_arguments`.
    """
    smallest = float(packing.radii.min())
    commands = _LAW.format(
        style=f"{pair_style(law)} {pair_style_arguments(law, threads)}".strip(),
        whose="atom" if packing.own_radii else "type",
        file=file,
        names=" ".join(f"s{n}" for n in range(1, len(packing.species_radii) + 1)),
    )
    energy_jumps = law.name == "sector"
    return (
        commands
        + list_commands(0.1 * smallest, packing)
        + (fire_commands(LONGEST_STEP * smallest) if energy_jumps else LBFGS)
    )


def balance_command(
    packing: Packing, law: AnyLaw, tolerance: float, threads: int | str | None = None
) -> str:
    """Command for the imbalance that LAMMPS leaves to contacts; empty if the law has no balance."""
    if law.name in ("radical", "sector"):
        return ""
    whose = "atom" if packing.own_radii else "type"
    given = pair_style_arguments(law, threads)
    arguments = f"{given} balance {tolerance!r} 1000 radius {whose}"
    return f"pair_style {pair_style(law)} {arguments}"


def list_commands(skin: float, packing: Packing | None = None) -> str:
    """Commands that choose neighbor lists with this skin [length], and bins of a dilute packing.

    LAMMPS takes bins of about a radius, of which a box that is thousands of radii long has too
    many.
    """
    lists = _LISTS.format(skin=skin)
    if packing is None:
        return lists
    bins = max(_MOST_BINS, _BINS_EACH * len(packing))
    size = float(abs(np.linalg.det(packing.box)) / bins) ** (1.0 / packing.dimension)
    return lists + _WIDE.format(size=size) * (size > 2.0 * float(packing.radii.max()))


def fire_commands(dmax: float, tmax: float = 10.0) -> str:
    """Commands that choose FIRE.

    Args:
        dmax: the largest displacement in an iteration: without a bound, particles of a loose
            packing jump through one another [length].
        tmax: how far FIRE may stretch its first time step.
    """
    return _FIRE.format(dmax=dmax, tmax=tmax)


def polygon_contact_commands(model: DeformablePolygon, spacing: float) -> str:
    """Commands for the contacts of polygons, smooth or of beads.

    Args:
        model: settings of the polygons.
        spacing: longest edge of a polygon at rest [length].
    """
    style = _SMOOTH if model.smooth else _BEAD
    return style.format(
        longest=_LONGEST_EDGE * spacing,
        kr=model.kr,
        half=0.5 * model.kr,  # the energy of LAMMPS' style has no factor 1/2
        range=2.0 * model.radius,
    )


def polygon_wall_commands(model: DeformablePolygon, stick: bool) -> str:
    """Commands for walls with the stiffness of beads, at a distance of p from their centers.

    The energy of LAMMPS' harmonic wall has no factor 1/2; it ignores the second number, sigma.
    """
    slip = f"wall/region walls harmonic {0.5 * model.kr!r} 1.0 {model.radius!r}"
    style = f"deformable/stick walls {model.kr!r} radius {model.radius!r}" if stick else slip
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

"""The LAMMPS data file of a saved state: its packing, and what a motion goes on with."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..formats.lammps_data import data_file, read_data_file, sphere_columns
from ..model.packing import Packing
from ..model.walls import Wall
from .directions import direction_lines, directions_in
from .films import Films, film_lines, films_in
from .lammps_commands import atom_style
from .rubbing import Rubbing, rubbing_in, rubbing_lines


class Motion(NamedTuple):
    """How far a simulation has come, beside its packing.

    Attributes:
        velocities: of the particles, shape (N, d) [length/time].
        time: of the motion so far [time].
        strain: shear strain so far; None without shear.
        films: those that there are, see `films.py`; None if nothing sticks.
        directions: in which particles propel themselves, shape (N, 2); None if they do not.
        rubbing: spins, and what contacts that rub remember; None if they do not.
    """

    velocities: NDArray[np.float64]
    time: float = 0.0
    strain: float | None = None
    films: Films | None = None
    directions: NDArray[np.float64] | None = None
    rubbing: Rubbing | None = None

    @property
    def moves(self) -> bool:
        """Whether any particle moves or spins."""
        spins = self.rubbing is not None and self.rubbing.spins.any()
        return bool(self.velocities.any() or spins)

    def at(self, former: tuple[Wall, ...], walls: tuple[Wall, ...]) -> Motion:
        """The motion between walls in the place of former ones, whose numbers contacts know.

        Films and springs of walls are left out if the kinds of the walls are others.
        """
        if [wall.kind for wall in walls] == [wall.kind for wall in former]:
            return self
        films, rubbing = self.films, self.rubbing
        if films is not None:
            films = films[films[:, 1] > 0]
        if rubbing is not None:
            rubbing = rubbing._replace(springs=rubbing.springs[rubbing.springs[:, 1] > 0])
        return self._replace(films=films, rubbing=rubbing)


def packing_file(packing: Packing, motion: Motion, frames: int | None) -> str:
    """A packing as a LAMMPS data file.

    Its title has the time and the strain where these are not 0, and the number of recorded frames,
    if given. Films, directions and springs of contacts are comments at its end.
    """
    style = atom_style(packing)
    space = "two" if packing.dimension == 2 else "three"
    title = f"LAMMPS data file by lammps-deformable, units lj, atom_style {style}, "
    title += f"{space}-dimensional"
    columns: list[NDArray[Any]] = [packing.species + 1]
    if packing.particle_radii is not None:
        columns += sphere_columns(packing.particle_radii)
    if motion.time:
        title += f", time {motion.time!r}"
    if motion.strain is not None:
        title += f", strain {motion.strain!r}"
    text = data_file(
        title if frames is None else f"{title}, {frames} frames",
        style,
        packing.box,
        len(packing.radii),
        columns,
        packing.positions,
        origin=packing.origin.tolist(),
        velocities=motion.velocities if motion.moves else None,
        spins=motion.rubbing.spins if motion.rubbing else None,
    )
    memory = film_lines(motion.films) + rubbing_lines(motion.rubbing)
    return text + memory + direction_lines(motion.directions)


def packing_in(text: str, radii: list[float], dimension: int) -> Packing:
    """The packing in a data file, which LAMMPS itself would round while it reads it.

    Args:
        text: of the file, as `packing_file` or LAMMPS' `write_data` writes it.
        radii: of the species [length].
        dimension: 2, or 3 in space.

    Raises:
        ValueError: the text is no such file, or lacks atoms.
    """
    found = read_data_file(text)
    if not np.array_equal(found.ids, np.arange(1, len(found.ids) + 1)):
        raise ValueError(f"atom IDs must be 1 to {len(found.ids)}")
    own = "diameter" in found.columns
    return Packing(
        positions=found.places(dimension),
        species=found.species,
        radii=np.array(radii),
        box=found.lattice(dimension),
        particle_radii=found.radius("diameter") if own else None,
    )


def motion_in(text: str, number: int, dimension: int) -> Motion:
    """The motion in a data file of so many atoms, as `packing_file` or `write_data` writes it.

    Args:
        text: of the file.
        number: of atoms.
        dimension: 2, or 3 in space.

    Raises:
        ValueError: velocities or directions are missing or damaged.
    """
    title, _, body = text.partition("\n")
    time, strain = (re.search(rf", {name} ([^,]+)", title) for name in ("time", "strain"))
    velocities, spins = np.zeros((number, dimension)), np.zeros(number)
    _, _, section = body.partition("\nVelocities\n\n")
    rows = [row.split() for row in section.partition("\n\n")[0].splitlines()]
    if rows:
        ids, vx, vy, vz, *turn = np.array(rows, dtype=np.float64).T
        if sorted(ids) != list(range(1, number + 1)):
            raise ValueError(f"it has velocities of {len(ids)} of {number} atoms")
        order = ids.astype(np.int64) - 1
        velocities[order] = np.column_stack([vx, vy, vz][:dimension])
        spins[order] = turn[2] if len(turn) > 2 else 0.0
    return Motion(
        velocities,
        float(time[1]) if time else 0.0,
        float(strain[1]) if strain else None,
        films_in(text),
        directions_in(text, number),
        rubbing_in(text, spins),
    )

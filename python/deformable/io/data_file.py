"""The LAMMPS data file of a saved state: its packing, and what a motion goes on with."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..formats.lammps_data import data_file, read_data_file, sphere_columns
from ..model.packing import Packing
from .directions import direction_lines, directions_in
from .films import Films, film_lines, films_in
from .lammps_commands import atom_style


class Motion(NamedTuple):
    """How far a simulation has come, beside its packing.

    Attributes:
        velocities: of the particles, shape (N, 2) [length/time].
        time: of the motion so far [time].
        strain: shear strain so far; None without shear.
        films: those that there are, see `films.py`; None if nothing sticks.
        directions: in which particles propel themselves, shape (N, 2); None if they do not.
    """

    velocities: NDArray[np.float64]
    time: float = 0.0
    strain: float | None = None
    films: Films | None = None
    directions: NDArray[np.float64] | None = None


def packing_file(packing: Packing, motion: Motion, frames: int | None) -> str:
    """A packing as a LAMMPS data file.

    Its title has the time and the strain where these are not 0, and the number of recorded frames,
    if given. Films and directions are comments at its end.
    """
    style = atom_style(packing)
    title = f"LAMMPS data file by lammps-deformable, units lj, atom_style {style}, two-dimensional"
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
        velocities=motion.velocities if motion.velocities.any() else None,
    )
    return text + film_lines(motion.films) + direction_lines(motion.directions)


def packing_in(text: str, radii: list[float]) -> Packing:
    """The packing in a data file, which LAMMPS itself would round while it reads it.

    Args:
        text: of the file, as `packing_file` or LAMMPS' `write_data` writes it.
        radii: of the species [length].

    Raises:
        ValueError: the text is no such file, or lacks atoms.
    """
    found = read_data_file(text)
    if not np.array_equal(found.ids, np.arange(1, len(found.ids) + 1)):
        raise ValueError(f"atom IDs must be 1 to {len(found.ids)}")
    own = "diameter" in found.columns
    return Packing(
        positions=found.places(),
        species=found.species,
        radii=np.array(radii),
        box=found.lattice(),
        particle_radii=found.radius("diameter") if own else None,
    )


def motion_in(text: str, number: int) -> Motion:
    """The motion in a data file of so many atoms, as `packing_file` or `write_data` writes it.

    Raises:
        ValueError: velocities or directions are missing or damaged.
    """
    title, _, body = text.partition("\n")
    time, strain = (re.search(rf", {name} ([^,]+)", title) for name in ("time", "strain"))
    velocities = np.zeros((number, 2))
    _, _, section = body.partition("\nVelocities\n\n")
    rows = [row.split()[:3] for row in section.partition("\n\n")[0].splitlines()]
    if rows:
        ids, *columns = np.array(rows, dtype=np.float64).T
        if sorted(ids) != list(range(1, number + 1)):
            raise ValueError(f"it has velocities of {len(ids)} of {number} atoms")
        velocities[ids.astype(np.int64) - 1] = np.column_stack(columns)
    return Motion(
        velocities,
        float(time[1]) if time else 0.0,
        float(strain[1]) if strain else None,
        films_in(text),
        directions_in(text, number),
    )

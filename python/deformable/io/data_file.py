"""LAMMPS data files: written from plain values, and read back as a packing."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..model.packing import Packing
from .films import Films, film_lines, films_in
from .lammps_commands import atom_style


class Motion(NamedTuple):
    """How far a simulation has come, beside its packing.

    Attributes:
        velocities: of the particles, shape (N, 2) [length/time].
        time: of the motion so far [time].
        strain: shear strain so far; None without shear.
        films: those that there are, see `films.py`; None if nothing sticks.
    """

    velocities: NDArray[np.float64]
    time: float = 0.0
    strain: float | None = None
    films: Films | None = None


def data_file(
    title: str,
    style: str,
    box: ArrayLike,
    types: int,
    columns: Sequence[NDArray[Any]],
    positions: NDArray[np.float64],
    bonds: NDArray[np.int64] | None = None,
    origin: Sequence[float] = (0, 0),
    velocities: NDArray[np.float64] | None = None,
) -> str:
    """Text of the LAMMPS data file of a two-dimensional system, with every digit.

    Args:
        title: first line.
        style: LAMMPS atom_style; masses are 1, or given by atom for `sphere`.
        box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length].
        types: number of atom types, and of bond types if there are bonds.
        columns: values of the style between ID and position of an atom, arrays of shape (N,).
        positions: of the atoms, shape (N, 2) [length].
        bonds: type and both atoms of each bond, shape (M, 3).
        origin: lower left corner of the box [length].
        velocities: of the atoms, shape (N, 2) [length/time]; at rest if not given.
    """
    (lx, _), (xy, ly) = np.asarray(box, dtype=np.float64).tolist()
    x0, y0 = origin
    lines = [title, "", f"{len(positions)} atoms", f"{types} atom types"]
    if bonds is not None:
        lines += [f"{len(bonds)} bonds", f"{types} bond types"]
    lines += [
        f"{x0!r} {x0 + lx!r} xlo xhi",
        f"{y0!r} {y0 + ly!r} ylo yhi",
        "-0.5 0.5 zlo zhi",
        f"{xy!r} 0 0 xy xz yz",
        "",
    ]
    if style != "sphere":
        lines += ["Masses", "", *(f"{n} 1" for n in range(1, types + 1)), ""]
    lines += [f"Atoms # {style}", ""]
    rows = zip(*(column.tolist() for column in columns), *positions.T.tolist(), strict=True)
    lines += [f"{n} {' '.join(map(repr, row))} 0" for n, row in enumerate(rows, start=1)]
    if velocities is not None:
        spin = " 0 0 0" if style == "sphere" else ""
        lines += ["", "Velocities", ""]
        lines += [f"{n} {x!r} {y!r} 0{spin}" for n, (x, y) in enumerate(velocities.tolist(), 1)]
    if bonds is not None:
        lines += ["", "Bonds", ""]
        lines += [f"{n} {a} {b} {c}" for n, (a, b, c) in enumerate(bonds.tolist(), start=1)]
    return "\n".join(lines) + "\n"


def packing_file(packing: Packing, motion: Motion, frames: int | None) -> str:
    """A packing as a LAMMPS data file.

    Its title has the time and the strain where these are not 0, and the number of recorded frames,
    if given. Films are comments at its end.
    """
    style = atom_style(packing)
    title = f"LAMMPS data file by lammps-deformable, units lj, atom_style {style}, two-dimensional"
    columns: list[NDArray[Any]] = [packing.species + 1]
    if packing.particle_radii is not None:
        density = 0.75 / (np.pi * packing.particle_radii**3)  # of a sphere of mass 1
        columns += [2.0 * packing.particle_radii, density]
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
        origin=packing.origin.tolist() if packing.walls else (0, 0),
        velocities=motion.velocities if motion.velocities.any() else None,
    )
    return text + film_lines(motion.films)


def packing_in(text: str, radii: list[float]) -> Packing:
    """The packing in a data file, which LAMMPS itself would round while it reads it.

    Args:
        text: of the file, as `packing_file` or LAMMPS' `write_data` writes it.
        radii: of the species [length].

    Raises:
        ValueError: the text is no such file, or lacks atoms.
    """
    head, _, body = text.partition("Atoms # ")
    style, _, rows = body.partition("\n")
    width = {"atomic": 5, "sphere": 7}.get(style)
    words = {line.split()[-1]: line.split() for line in head.splitlines() if line.strip()}
    needed = {"xhi": 4, "yhi": 4, "yz": 6, "atoms": 2}
    if width is None or any(len(words.get(word, ())) != size for word, size in needed.items()):
        raise ValueError("it is no packing as lammps-deformable writes it")
    lx, ly = (float(words[word][1]) - float(words[word][0]) for word in ("xhi", "yhi"))
    xy = float(words["yz"][0])
    table, _, _ = rows.strip("\n").partition("\n\n")  # sections of LAMMPS follow
    atoms = [row.split() for row in table.splitlines()]
    complete = sum(len(row) in (width, width + 3) for row in atoms)  # LAMMPS adds image flags
    if not atoms or complete != len(atoms) or complete != int(words["atoms"][0]):
        raise ValueError(f"it has {complete} of {words['atoms'][0]} atoms")
    numbers = np.array([row[:width] for row in atoms], dtype=np.float64)
    ids, types, *values = numbers[np.argsort(numbers[:, 0])].T
    if not np.array_equal(ids, np.arange(1, len(ids) + 1)):
        raise ValueError(f"atom IDs must be 1 to {len(ids)}")
    return Packing(
        positions=np.column_stack(values[-3:-1]),
        species=types.astype(np.int64) - 1,
        radii=np.array(radii),
        box=np.array([[lx, 0.0], [xy, ly]]),
        particle_radii=values[0] / 2.0 if style == "sphere" else None,
    )


def motion_in(text: str, number: int) -> Motion:
    """The motion in a data file of so many atoms, as `packing_file` or `write_data` writes it.

    Raises:
        ValueError: velocities are missing or damaged.
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
    )

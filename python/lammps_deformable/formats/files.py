"""Files of particles: which format they have, and their frames."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..common.errors import FileError, ParameterError
from ..common.files import reading, write_whole, writing
from ..common.validate import LARGEST_COUNT, whole
from .extended_xyz import read_xyz_frame, xyz_frame, xyz_frames
from .gsd_files import read_gsd, write_gsd
from .lammps_data import data_file, is_data_file, read_data_file, sphere_columns
from .lammps_dump import dump_frame, frame_texts, read_dump_frame
from .particles import Floats, Particles, check_frame
from .universes import open_universe, read_universe

if TYPE_CHECKING:
    from MDAnalysis import Universe

# Bytes from which a format is told, and those with which GSD begins.
_HEAD, _GSD_HEAD = 65536, bytes.fromhex("df65df65df65df65")

# Formats, and their suffixes where they are written.
_DATA, _DUMP, _XYZ = "a LAMMPS data file", "a LAMMPS dump", "extended XYZ"
_GSD, _OTHER = "GSD", "of MDAnalysis"
_SUFFIXES = {
    ".data": _DATA,
    ".lammpstrj": _DUMP,
    ".dump": _DUMP,
    ".xyz": _XYZ,
    ".extxyz": _XYZ,
    ".gsd": _GSD,
}

_TITLE = "LAMMPS data file by lammps-deformable, units lj, atom_style sphere, {}-dimensional"


def read_particles(
    path: Path, number: int = -1, topology: Path | None = None, wanted: Sequence[str] = ()
) -> Particles:
    """The particles of one frame of a file.

    Args:
        path: LAMMPS data files, dumps and GSD are known by what is in them, XYZ by its suffix; all
            else goes to MDAnalysis.
        number: of the frame, from 0, or from the end if negative.
        topology: of a trajectory that MDAnalysis reads, in any of these formats.
        wanted: attributes of MDAnalysis that become columns.

    Raises:
        FileError: the file cannot be read, or has no such frame.
        ImportError: gsd is missing (`pip install 'lammps-deformable[gsd]'`).
    """
    if abs(number := whole("frame", number)) > LARGEST_COUNT:
        raise ParameterError(f"frame must be the number of one, such as 0 or -1, not {number}")
    kind = _kind(path)
    if topology is not None and kind != _OTHER:
        raise ParameterError(
            f"a topology is for trajectories that MDAnalysis reads, and '{path}' is {kind}: leave "
            "it out"
        )
    known = None
    if topology is not None and _kind(topology) != _OTHER:
        known = read_particles(topology)  # MDAnalysis takes other columns for its types
    try:
        with reading(f"'{path}'"):
            if kind != _OTHER:
                return _READERS[kind](path, number)
            universe = _universe(path, len(known.ids) if known else topology)
            found = read_universe(universe, number, wanted)
            if known is None:
                return found
            return replace(known, positions=found.positions, box=found.box, origin=found.origin)
    except (RuntimeError, OSError) as error:
        if isinstance(error, FileError):
            raise
        raise FileError(f"'{path}' cannot be read: {error}") from None


def write_particles(
    path: Path,
    box: Floats,
    species: NDArray[np.int64],
    positions: Floats,
    radius: Floats,
    types: int,
    origin: Floats,
    shut: Sequence[bool],
) -> None:
    """Write particles of mass 1 in the format of the suffix.

    Args:
        path: of the file; an older one is replaced.
        box: lattice vectors as rows, those of a packing, shape (d, d) [length].
        species: of the particles, from 0, shape (N,).
        positions: shape (N, d) [length].
        radius: of the particles, shape (N,) [length].
        types: number of species.
        origin: lower left corner of the box, shape (d,) [length].
        shut: whether the box is not periodic along each axis.

    Raises:
        ParameterError: the suffix is of no format that has radii and box.
        FileError: the file cannot be written.
        ImportError: gsd is missing (`pip install 'lammps-deformable[gsd]'`).
    """
    kind, corner = _SUFFIXES.get(path.suffix.lower()), origin.tolist()
    if kind is None:
        raise ParameterError(
            f"the suffix of '{path}' must be one of {' '.join(_SUFFIXES)}: what MDAnalysis writes "
            "lacks radii, box or digits, see Packing.to_mdanalysis if they do not matter"
        )
    if kind == _GSD:
        with writing(path):
            write_gsd(path, box, species, positions - origin, radius, types)
        return
    if kind == _DATA:
        columns = [species + 1, *sphere_columns(radius)]
        title = _TITLE.format("two" if len(box) == 2 else "three")
        text = data_file(title, "sphere", box, types, columns, positions, origin=corner)
    elif kind == _DUMP:
        text = dump_frame(0, box, species, positions, {"radius": radius}, corner, shut)
    else:
        text = xyz_frame(box, species, positions, radius, corner, shut)
    write_whole(path, text)


def _universe(path: Path, topology: Path | int | None) -> Universe:
    try:
        return open_universe(path, topology)
    except Exception as error:  # of many readers
        reason = " ".join(str(error).split()) or type(error).__name__
        raise FileError(
            f"'{path}' is no LAMMPS data file, dump, XYZ or GSD, and MDAnalysis cannot read it: "
            f"{reason[:200]}"
        ) from None


def _kind(path: Path) -> str:
    """The format of a file."""
    try:
        with path.open("rb") as file:
            start = file.read(_HEAD)
    except IsADirectoryError:
        raise FileError(f"'{path}' is a folder: ld.Run has the states of a recorded run") from None
    except OSError as error:
        raise FileError(f"'{path}' cannot be read: {error.strerror}") from None
    if not start:
        raise FileError(f"'{path}' is empty")
    if start.startswith(_GSD_HEAD):
        return _GSD
    text = start.decode(errors="replace")
    if text.startswith("ITEM: "):
        return _DUMP
    if is_data_file(text):
        return _DATA
    return _XYZ if _SUFFIXES.get(path.suffix.lower()) == _XYZ else _OTHER


def _read_data(path: Path, number: int) -> Particles:
    check_frame(number, 1)
    return read_data_file(path.read_text())


def _read_dump(path: Path, number: int) -> Particles:
    frames = frame_texts(path)
    check_frame(number, len(frames))
    place = frames[number]
    with path.open("rb") as file:
        file.seek(place.start)
        return read_dump_frame(file.read(place.stop - place.start).decode())


def _read_xyz(path: Path, number: int) -> Particles:
    with path.open() as file:
        frames = enumerate(xyz_frames(file), start=1)
        kept = deque(islice(frames, number + 1), 1) if number >= 0 else deque(frames, -number)
        check_frame(number, kept[-1][0] if kept else 0)
        return read_xyz_frame(*kept[0][1])


_READERS = {_DATA: _read_data, _DUMP: _read_dump, _XYZ: _read_xyz, _GSD: read_gsd}

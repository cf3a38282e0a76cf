"""Particles in a file of any format, known by what is in it."""

from __future__ import annotations

import bz2
import gzip
import lzma
import re
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from typing import IO

import numpy as np
from numpy.typing import NDArray

from ..common.box import half_thickness
from ..common.checks import LARGEST_COUNT, whole
from ..common.errors import FileError, ParameterError
from ..common.files import reading, write_whole, writing
from ..particles.columns import Floats, Particles, check_frame
from .data_files import data_file, read_data_file, sphere_columns
from .dump_files import dump_frame, read_dump
from .gsd_files import read_gsd, write_gsd
from .universe import open_universe, read_universe
from .xyz_files import read_xyz, xyz_frame

# Bytes from which a format is told, and those with which GSD begins.
_HEAD, _GSD_HEAD = 65536, bytes.fromhex("df65df65df65df65")

# The first bytes of compressed files and what opens them, and what it raises if they are damaged.
_COMPRESSED: dict[bytes, Callable[[Path], IO[bytes]]] = {
    bytes.fromhex("1f8b"): gzip.open,  # type: ignore[dict-item]
    b"BZh": bz2.open,
    bytes.fromhex("fd377a585a00"): lzma.open,
}
_DAMAGED = (OSError, EOFError, lzma.LZMAError, zlib.error)

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
            else goes to MDAnalysis. A file of gzip, bzip2 or xz is what is in it.
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
        with reading(f"'{path}'"), _unpacked(path) as plain:
            if kind == _DATA:
                check_frame(number, 1)
                return read_data_file(plain.read_text())
            if kind != _OTHER:
                return {_DUMP: read_dump, _XYZ: read_xyz, _GSD: read_gsd}[kind](plain, number)
            universe = open_universe(path, len(known.ids) if known else topology)
            found = read_universe(universe, number, wanted)
            if known is None:
                return found
            return replace(
                known,
                positions=found.positions,
                box=found.box,
                origin=found.origin,
                step=found.step,
            )
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
    """Write particles of mass 1 in the format of the suffix; an older file is replaced.

    Args:
        path: of the file.
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
        half = half_thickness(float(radius.max()))
        text = data_file(title, "sphere", box, types, columns, positions, origin=corner, half=half)
    elif kind == _DUMP:
        half = half_thickness(float(radius.max()))
        text = dump_frame(0, box, species, positions, {"radius": radius}, corner, shut, half)
    else:
        text = xyz_frame(box, species, positions, radius, corner, shut, types)
    write_whole(path, text)


def _kind(path: Path) -> str:
    """The format of a file, or of what is in a compressed one."""
    try:
        unpack = _unpacker(path)
        with unpack(path) if unpack else path.open("rb") as file:
            start = file.read(_HEAD)
    except IsADirectoryError:
        raise FileError(
            f"'{path}' is a folder: name a file in it, such as {path / 'packing.data'}; in Python "
            "ld.Run has the states of a recorded run"
        ) from None
    except _DAMAGED as error:
        raise FileError(f"'{path}' cannot be read: {_reason(error)}") from None
    if not start:
        raise FileError(f"'{path}' is empty")
    if start.startswith(_GSD_HEAD):
        return _GSD
    text = start.decode(errors="replace")
    if text.startswith("ITEM: "):
        return _DUMP
    if re.search(r"^\s*\d+\s+atoms\b", text, re.M) and re.search(r"\bxlo\s+xhi\b", text):
        return _DATA
    suffix = Path(path.stem).suffix if unpack else path.suffix
    return _XYZ if _SUFFIXES.get(suffix.lower()) == _XYZ else _OTHER


def _unpacker(path: Path) -> Callable[[Path], IO[bytes]] | None:
    """What opens a compressed file, by its first bytes; None of others."""
    with path.open("rb") as file:
        start = file.read(6)
    return next((unpack for head, unpack in _COMPRESSED.items() if start.startswith(head)), None)


@contextmanager
def _unpacked(path: Path) -> Iterator[Path]:
    """A file, or what is in a compressed one."""
    unpack = _unpacker(path)
    if not unpack:
        yield path
        return
    with TemporaryDirectory() as folder:
        plain = Path(folder) / path.stem
        try:
            with unpack(path) as source, plain.open("wb") as copy:
                copyfileobj(source, copy)
        except _DAMAGED as error:
            raise ValueError(_reason(error)) from None
        yield plain


def _reason(error: Exception) -> str:
    """Why a file cannot be opened or unpacked."""
    return getattr(error, "strerror", None) or f"it is damaged, {error}"

"""Particles in files: GSD, what MDAnalysis reads, and any format by what is in the file.

`text_files` has LAMMPS' formats and extended XYZ. GSD has single precision, and what MDAnalysis
reads mostly too.
"""

from __future__ import annotations

import bz2
import gzip
import lzma
import re
import warnings
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from typing import IO, TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..common._checks import LARGEST_COUNT, whole
from ..common._files import reading, write_whole, writing
from ..common.box import cartesian, fractional, half_thickness
from ..common.errors import FileError, ParameterError
from ..common.versions import optional
from ..particles.text_files import (
    Particles,
    as_types,
    box_of,
    check_frame,
    data_file,
    dump_frame,
    read_data_file,
    read_dump,
    read_xyz,
    sphere_columns,
    step_of,
    tilts_of,
    xyz_frame,
)

if TYPE_CHECKING:
    from MDAnalysis import Universe

Floats = NDArray[np.float64]

# GSD, by its own package. A file without diameters has the diameter 1 by its schema, and gsd writes
# none if all of them are 1. So radii stand in the log of particles too, and what is read has
# diameters only if the file does.


# Name of the radii in the log.
_RADII = "particles/radius"


def _write_gsd(
    path: Path,
    box: Floats,
    species: NDArray[np.int64],
    positions: Floats,
    radius: Floats,
    types: int,
) -> None:
    """Write a frame, with positions from the corner of the box; types are A, B, ..."""
    hoomd = optional("gsd.hoomd", "gsd")
    dimension = len(box)
    space = np.eye(3)
    space[:dimension, :dimension] = box
    fractions = fractional(in_space(positions), space)
    fractions[:, dimension:] = 0.5  # in the middle
    image = np.floor(fractions)
    (lx, ly, lz), (xy, xz, yz) = space.diagonal().tolist(), tilts_of(box)
    frame = hoomd.Frame()
    frame.configuration.dimensions = dimension
    frame.configuration.box = [lx, ly, lz * (dimension == 3), xy / ly, xz / lz, yz / lz]
    particles = frame.particles
    particles.N = len(species)
    particles.position = cartesian(fractions - image - 0.5, space)  # the box is about the origin
    particles.image = image.astype(np.int32)
    particles.types = [_letters(n) for n in range(types)]
    particles.typeid = species
    particles.diameter = 2.0 * radius
    frame.log[_RADII] = radius
    with hoomd.open(path, "w") as file:
        file.append(frame)


def _read_gsd(path: Path, number: int) -> Particles:
    hoomd = optional("gsd.hoomd", "gsd")
    with hoomd.open(path, "r") as file:
        check_frame(number, len(file))
        frame, places = file[number], {number % len(file), 0}  # defaults are those of the first
        sized = any(file.file.chunk_exists(n, "particles/diameter") for n in places)
    lx, ly, lz, xy, xz, yz = frame.configuration.box.astype(np.float64).tolist()
    box = box_of([lx, ly, lz], xy * ly, xz * lz, yz * lz)
    particles, count = frame.particles, frame.particles.N
    columns = {
        name: getattr(particles, name) for name in ("diameter",) * sized + ("mass", "charge")
    }
    if _RADII in frame.log:
        columns["radius"] = frame.log[_RADII]
    image = particles.image * [1.0, 1.0, float(frame.configuration.dimensions == 3)]
    return Particles(
        particles.position + cartesian(image, box),
        box,
        np.arange(1, count + 1),
        np.array(particles.types)[particles.typeid],
        columns,
        -0.5 * box.sum(axis=0),
        names=particles.types,
        count=len(particles.types),
        step=step_of(particles.position),
    )


def _letters(n: int) -> str:
    """A, B, ..., Z, AA, AB, ..."""
    return ("" if n < 26 else _letters(n // 26 - 1)) + chr(ord("A") + n % 26)


# MDAnalysis, which reads the files of most other programs


def universe_of(
    box: Floats, species: NDArray[np.int64], positions: Floats, radius: Floats
) -> Universe:
    """A Universe of one frame, with positions from the lower left corner of the box."""
    import MDAnalysis

    number = len(species)
    universe = MDAnalysis.Universe.empty(number, trajectory=True, velocities=True)
    universe.add_TopologyAttr("ids", np.arange(1, number + 1))
    universe.add_TopologyAttr("types", (species + 1).astype(str))
    universe.add_TopologyAttr("radii", radius)
    universe.add_TopologyAttr("masses", np.ones(number))
    frame = universe.trajectory.ts
    frame.dimensions = box_in_space(box)
    frame.positions = in_space(positions)
    return universe


def in_space(vectors: Floats) -> Floats:
    """Vectors of the plane with z = 0, those of space as they are, shape (N, 3)."""
    return np.column_stack([vectors, np.zeros((len(vectors), 3 - vectors.shape[1]))])


def box_in_space(box: Floats) -> list[float]:
    """Lengths and angles [degrees] of a box; that of a plane is as high as its longer side."""
    if len(box) == 3:
        from MDAnalysis.lib.mdamath import triclinic_box

        return [float(number) for number in triclinic_box(*box)]
    a, b = np.linalg.norm(box, axis=1).tolist()
    return [a, b, max(a, b), 90.0, 90.0, float(np.degrees(np.arctan2(box[1, 1], box[1, 0])))]


def _open_universe(path: Path, topology: Path | int | None) -> Universe:
    """The Universe of a file, with lengths as they are in it; a topology or a number of atoms."""
    import MDAnalysis

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # masses that are guessed, and the like, are not used
            if isinstance(topology, int):
                empty = MDAnalysis.Universe.empty(topology)
                return empty.load_new(str(path), convert_units=False)
            files = [path] if topology is None else [topology, path]
            return MDAnalysis.Universe(*map(str, files), convert_units=False)
    except Exception as error:  # of many readers
        reason = " ".join(str(error).split()) or type(error).__name__
        raise FileError(
            f"'{path}' is no LAMMPS data file, dump, XYZ or GSD, and MDAnalysis cannot read it; "
            "numbers of a table are for Packing(positions, radii, box) (MDAnalysis says: "
            f"{reason[:200]})"
        ) from None


def _read_universe(universe: Universe, number: int, wanted: Sequence[str]) -> Particles:
    check_frame(number, len(universe.trajectory))
    frame, atoms = universe.trajectory[number], universe.atoms
    kind = np.asarray(atoms.types) if hasattr(atoms, "types") else None
    box = None if frame.dimensions is None else frame.triclinic_dimensions.astype(np.float64)
    return Particles(
        frame.positions.astype(np.float64),
        box,
        atoms.indices + 1,
        columns={name: np.asarray(getattr(atoms, name)) for name in wanted if hasattr(atoms, name)},
        step=step_of(frame.positions),
        **as_types(kind, len(atoms)),
    )


# Any of these formats


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
                return {_DUMP: read_dump, _XYZ: read_xyz, _GSD: _read_gsd}[kind](plain, number)
            universe = _open_universe(path, len(known.ids) if known else topology)
            found = _read_universe(universe, number, wanted)
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
            _write_gsd(path, box, species, positions - origin, radius, types)
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

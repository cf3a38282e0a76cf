"""Particles as a file has them, and what of it makes a packing.

Extended XYZ: a line with the number of particles, one of `key=value`, and one a particle.

Source: https://github.com/libAtoms/extxyz, the specification.

GSD, the files of HOOMD-blue, by its own package. They have single precision.

A file without diameters has the diameter 1 by its schema, and gsd writes none if all of them are 1.
So radii stand in the log of particles too, and what is read has diameters only if the file does.

LAMMPS data files, with every digit: LAMMPS itself and MDAnalysis round what they read.

LAMMPS dumps of atoms as text, with every digit.

MDAnalysis, which reads the files of most other programs.

Files of particles: which format they have, and their frames.
"""

from __future__ import annotations

import mmap
import re
import warnings
from collections import deque
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Context, Decimal
from itertools import islice
from typing import TYPE_CHECKING, Any, TextIO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._checks import LARGEST_COUNT, positive, shown, whole
from ._files import reading, write_whole, writing
from .errors import FileError, ParameterError
from .versions import optional

if TYPE_CHECKING:
    from pathlib import Path

    from MDAnalysis import Universe


Floats = NDArray[np.float64]

# Heights that differ by less than this part of the width are one plane, and angles of a box by
# less than this are right angles: single precision.
_PLANE = 1e-6

# Names that radii have, where none is given; those of diameters are halved.
RADII = ("radius", "diameter", "radii")

# What is told where types are needed and the file has none.
UNTYPED = "it has no types of particles: give a file that has them"

# Digits of a sum of two numbers of a file: none is lost.
_EXACT = Context(prec=60)


@dataclass(frozen=True)
class Particles:
    """Particles of a file, in the order of their IDs.

    Attributes:
        positions: shape (N, 3) [length].
        box: lattice vectors as rows, shape (3, 3) [length]; None if the file has none.
        origin: lower left corner of the box, shape (3,) [length].
        periodic: whether the box is, along x, y and z.
        ids: as the file has them, shape (N,).
        types: numbers from 1, or names, shape (N,).
        names: of all types; none if these are numbers.
        count: number of types, if the file has it.
        typed: whether the file tells the types; they are 1 if not.
        columns: other values by name, arrays of shape (N,).
    """

    positions: Floats
    box: Floats | None
    ids: NDArray[np.int64]
    types: NDArray[Any]
    columns: Mapping[str, NDArray[Any]]
    origin: Floats = field(default_factory=lambda: np.zeros(3))
    periodic: Sequence[bool] = (True, True, True)
    names: Sequence[str] = ()
    count: int = 0
    typed: bool = True

    def places(self, dimension: int = 2) -> Floats:
        """Positions, shape (N, d) [length].

        Raises:
            ValueError: a number is not finite, or the particles are not in one plane and should be.
        """
        wrong = np.argwhere(~np.isfinite(self.positions))
        if len(wrong) > 0:
            n, axis = wrong[0]
            raise ValueError(f"{'xyz'[axis]} of atom {self.ids[n]} is {self.positions[n, axis]}")
        if dimension == 3:
            return self.positions
        low, high = self.positions.min(axis=0), self.positions.max(axis=0)
        spread = high - low
        if spread[2] > _PLANE * max(spread[0], spread[1]):
            raise ValueError(
                f"its atoms fill space, z goes from {low[2]:.6g} to {high[2]:.6g}, but a packing "
                "in the plane has one z: read it with dimension=3 (in the shell --law droplet), or "
                "write the atoms of one z to a file of their own"
            )
        return self.positions[:, :2]

    def lattice(self, dimension: int = 2) -> Floats:
        """((lx, 0), (xy, ly)), or ((lx, 0, 0), (xy, ly, 0), (xz, yz, lz)), shape (d, d) [length].

        Raises:
            ValueError: there is no box, or another one.
        """
        if self.box is None:
            form = "(lx, ly)" if dimension == 2 else "(lx, ly, lz)"
            raise ValueError(f"it has no box: give one, such as box={form}")
        if dimension == 3:
            return self._space_box(self.box)
        wrong = ~np.isfinite(self.box).all() or (self.box.diagonal()[:2] <= 0.0).any()
        sides = np.abs(self.box).max()
        if wrong or np.abs(self.box[[0, 0, 1, 2, 2], [1, 2, 2, 0, 1]]).max() > _PLANE * sides:
            raise ValueError(
                f"its box is {shown(self.box.tolist())}, but the plane of a packing has lattice "
                "vectors (lx, 0, 0) and (xy, ly, 0), with the third one along z"
            )
        return np.array([[self.box[0, 0], 0.0], self.box[1, :2]])

    @staticmethod
    def _space_box(box: Floats) -> Floats:
        above = np.abs(np.triu(box, 1)).max()
        if not (np.isfinite(box).all() and (box.diagonal() > 0.0).all()) or (
            above > _PLANE * np.abs(box).max()
        ):
            raise ValueError(
                f"its box is {shown(box.tolist())}, but that of a packing has lattice vectors "
                "(lx, 0, 0), (xy, ly, 0) and (xz, yz, lz)"
            )
        return np.tril(box)

    @property
    def species(self) -> NDArray[np.int64]:
        """Species from 0, shape (N,): the number of the type less 1, or the place of its name.

        Raises:
            ValueError: a type is below 1.
        """
        if self.names:
            return np.array([list(self.names).index(name) for name in self.types.tolist()])
        if (wrong := np.flatnonzero(~(self.types >= 1))).size:
            n = int(wrong[0])
            raise ValueError(f"type of atom {self.ids[n]} is {self.types[n]}: types count from 1")
        return self.types.astype(np.int64) - 1

    def radius(self, radii: float | str | Mapping[Any, float] | None) -> Floats:
        """Radius of each particle, shape (N,) [length].

        Args:
            radii: see `Packing.from_file`; checked by `check_radii`.

        Raises:
            ValueError: the file lacks radii, or has one that is not positive.
        """
        if isinstance(radii, Mapping):
            return self._radius_by_type(radii)
        if radii is not None and not isinstance(radii, str):
            return np.full(len(self.ids), float(radii))
        wanted = RADII if radii is None else (radii,)
        name = next((name for name in wanted if name in self.columns), None)
        if name is None:
            known = ", ".join(self.columns) or "no columns but positions and types"
            raise ValueError(
                (f"it has no column {radii}" if radii else "it has no radii")
                + f" ({known}): give radii=0.5, radii by type as in radii={{1: 0.5, 2: 0.7}} (in "
                "the shell --from-radii 1=0.5,2=0.7), or the name of a column"
            )
        values = self.columns[name]
        if values.dtype.kind not in "biuf":
            raise ValueError(f"{name} of atom {self.ids[0]} is {values[0]}, which is no radius")
        wrong = np.flatnonzero(~((values > 0.0) & (values < np.inf)))
        if len(wrong) > 0:
            n = int(wrong[0])
            raise ValueError(
                f"{name} of atom {self.ids[n]} is {values[n]:g}, which is no radius: give radii, "
                "such as radii=0.5"
            )
        return values.astype(np.float64) / (2.0 if name == "diameter" else 1.0)

    def _radius_by_type(self, radii: Mapping[Any, float]) -> Floats:
        given = {str(name): radius for name, radius in radii.items()}
        if not self.typed and len(given) > 1:
            raise ValueError(f"{UNTYPED}, a topology, or one radius for all, such as radii=0.5")
        kinds, place = np.unique(self.types.astype(str), return_inverse=True)
        missing = [name for name in kinds.tolist() if name not in given]
        if missing:
            raise ValueError(
                f"it has particles of type {missing[0]}, and radii has {', '.join(given)} only"
            )
        return np.array([float(given[name]) for name in kinds.tolist()])[place]


def check_radii(radii: float | str | Mapping[Any, float] | None) -> None:
    """Raise a ParameterError for a radius that is not positive."""
    if isinstance(radii, Mapping) and not radii:
        raise ParameterError("radii by type must have a type, as in {1: 0.5, 2: 0.7}, not {}")
    for name, radius in radii.items() if isinstance(radii, Mapping) else ():
        positive(f"the radius of type {name}", radius)
    if not (radii is None or isinstance(radii, (str, Mapping))):
        positive("radii", radii)


def as_types(words: NDArray[Any]) -> tuple[NDArray[Any], list[str]]:
    """Types as numbers from 1, and no names, if all are whole numbers; else with their names."""
    if words.dtype.kind in "biuf" and np.array_equal(words, np.rint(words)):
        return words.astype(np.int64), []
    texts = words.astype(str)
    names = np.unique(texts).tolist()
    if all(name.isascii() and name.isdigit() and name == str(int(name)) for name in names):
        return texts.astype(np.int64), []
    return texts, names


def by_ids(ids: NDArray[Any]) -> NDArray[np.int64]:
    """The order of the IDs.

    Raises:
        ValueError: two are the same.
    """
    order = np.argsort(ids, kind="stable")
    same = np.flatnonzero(np.diff(ids[order]) == 0)
    if len(same) > 0:
        raise ValueError(f"atom {int(ids[order][same[0]])} occurs twice: write each particle once")
    return order.astype(np.int64)


def columns_of(
    rows: Sequence[str], names: Sequence[str], texts: Collection[str] = ()
) -> dict[str, NDArray[Any]]:
    """Columns of a table: numbers where its first row has numbers, else words.

    Args:
        rows: of the table.
        names: of its columns.
        texts: those of them that hold words, also where these look like numbers.

    Raises:
        ValueError: there are no rows, or one lacks a value, or has a word in place of a number.
    """
    if not rows:
        raise ValueError("it has no atoms")
    first = rows[0].split()
    if len(first) < len(names):
        raise ValueError(f"a row has {len(first)} values for the columns {' '.join(names)}")
    kept = range(len(names))
    numeric = [k for k in kept if names[k] not in texts and is_number(first[k])]
    values = np.loadtxt(rows, usecols=numeric, ndmin=2).T if numeric else np.empty((0, 0))
    found: dict[int, NDArray[Any]] = dict(zip(numeric, values, strict=True))
    if words := [k for k in kept if k not in found]:
        split = [row.split() for row in rows]
        found |= {k: np.array([row[k] for row in split]) for k in words}
    return {names[k]: found[k] for k in kept}


def check_frame(number: int, count: int) -> None:
    """Raise an error if a file of so many frames has none of this number.

    Raises:
        ValueError: it has none.
    """
    if not -count <= number < count:
        known = f"0 to {count - 1}, or -1 to {-count} from the end" if count > 1 else "0"
        raise ValueError(f"it has {count} frames, and no frame {number}: give {known}")


def is_number(word: str) -> bool:
    """Whether a word is one, such as 1e-3 or nan."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def plus(a: float, b: float) -> str:
    """a + b with all digits: a file that gives two ends of a box keeps its length to the last."""
    return str(_EXACT.add(Decimal(repr(a)), Decimal(repr(b))))


def minus(a: str, *others: str) -> float:
    """The difference of numbers of a file, rounded once.

    Raises:
        ValueError: one is no finite number.
    """
    if not all(np.isfinite(float(word)) for word in (a, *others)):
        raise ValueError(f"its box has the bounds {' '.join((*others[:1], a))}")
    left = Decimal(a)
    for word in others:
        left = _EXACT.subtract(left, Decimal(word))
    return float(left)


# Columns of a file that does not tell.
_PLAIN = "species:S:1:pos:R:3"

# A pair of the second line. All else there is a comment, in which a quote is an apostrophe.
_PAIR = re.compile(r"""([\w-]+)=(?:"([^"]*)"|'([^']*)'|(\S*))""")

# What is read of it.
_KEYS = ("lattice", "properties", "origin", "pbc")

# Of the columns of types, the first that there is.
_TYPES = ("species", "type", "element")


def xyz_frame(
    box: NDArray[np.float64],
    species: NDArray[np.int64],
    positions: NDArray[np.float64],
    radius: NDArray[np.float64],
    origin: Sequence[float],
    shut: Sequence[bool],
) -> str:
    """Text of a frame, with every digit; see `dump_frame`."""
    dimension, height = len(box), "" if len(box) == 3 else "0 "
    rows = [list(map(repr, vector[: n + 1])) for n, vector in enumerate(box.tolist())]
    rows += [["0", "0", "1"]] * (3 - dimension)
    vectors = " ".join(word for row in rows for word in [*row, "0", "0"][:3])
    corner = " ".join([*map(repr, origin), "-0.5"][:3])
    ends = " ".join("F" if each else "T" for each in (*shut, False)[:3])
    head = [
        f'Lattice="{vectors}"',
        f'Origin="{corner}"',
        f'pbc="{ends}"',
        "Properties=species:S:1:pos:R:3:radius:R:1",
    ]
    table = zip(species.tolist(), positions.tolist(), radius.tolist(), strict=True)
    lines = [f"{kind + 1} {' '.join(map(repr, x))} {height}{r!r}" for kind, x, r in table]
    return "\n".join([str(len(species)), " ".join(head), *lines]) + "\n"


def xyz_frames(file: TextIO) -> Iterator[tuple[int, str, list[str]]]:
    """The frames of a file: number of particles, second line, and rows, of which some may lack."""
    for line in file:
        if not line.strip():
            continue
        if not line.strip().isdigit():
            raise ValueError(f"a frame begins with the number of atoms, not {line.strip()[:60]!r}")
        count = int(line)
        yield count, file.readline(), list(islice(file, count))


def read_xyz_frame(count: int, head: str, rows: list[str]) -> Particles:
    """The particles of a frame, see `xyz_frames`.

    Raises:
        ValueError: it lacks particles, or its second line is damaged.
    """
    if len(rows) < count:
        raise ValueError(f"the frame has {len(rows)} of {count} atoms")
    said = {key.lower(): "".join(value) for key, *value in _PAIR.findall(head)}
    for key in _KEYS:
        if said.get(key, "").startswith(('"', "'")):
            raise ValueError(f"{key}={said[key]} has no closing quotation mark")
    properties = said.get("properties", _PLAIN).split(":")
    names: list[str] = []
    texts: set[str] = set()
    for word, form, size in zip(properties[::3], properties[1::3], properties[2::3], strict=True):
        name = word.lower()
        these = [name] if size == "1" else [f"{name}{n}" for n in range(int(size))]
        names += these
        texts |= set(these) if form == "S" else set()
    columns = columns_of(rows, names, texts)
    if not all(f"pos{n}" in columns for n in range(3)):
        raise ValueError(f"it has no pos:R:3 among its columns {' '.join(names)}")
    positions = np.column_stack([columns.pop(f"pos{n}") for n in range(3)])
    kind: NDArray[Any] | None = next((columns[name] for name in _TYPES if name in columns), None)
    types, kinds = as_types(np.ones(count) if kind is None else kind)
    box = None
    if "lattice" in said:
        box = _numbers("Lattice", said["lattice"], 9).reshape(3, 3)
    origin = _numbers("Origin", said.get("origin", "0 0 0"), 3)
    ends = [end[:1].upper() != "F" for end in said.get("pbc", "T T T").split()]
    if len(ends) != 3:
        raise ValueError(f"pbc must be three letters T or F, not {said['pbc']}")
    ids = np.arange(1, count + 1)
    typed = kind is not None
    return Particles(positions, box, ids, types, columns, origin, ends, kinds, typed=typed)


def _numbers(name: str, words: str, count: int) -> NDArray[np.float64]:
    values = np.array([float(word) for word in words.split()])
    if len(values) != count:
        raise ValueError(f"{name} must be {count} numbers, not {len(values)}")
    return values


# Name of the radii in the log.
_RADII = "particles/radius"


def write_gsd(
    path: Path,
    box: NDArray[np.float64],
    species: NDArray[np.int64],
    positions: NDArray[np.float64],
    radius: NDArray[np.float64],
    types: int,
) -> None:
    """Write a frame; types are A, B, ... Directions are periodic.

    Args:
        path: of the file.
        box: lattice vectors as rows, those of a packing, shape (d, d) [length].
        species: of the particles, from 0, shape (N,).
        positions: from the lower left corner of the box, shape (N, d) [length].
        radius: of the particles, shape (N,) [length].
        types: number of species.
    """
    hoomd = optional("gsd.hoomd", "gsd")
    dimension = len(box)
    space = np.zeros((3, 3))  # a plane has no height there
    space[:dimension, :dimension] = box
    (lx, *_), (xy, ly, _), (xz, yz, lz) = space.tolist()
    x, y, z = in_space(positions).T
    h = z / lz if lz else z + 0.5  # in the middle
    g = (y - h * yz) / ly
    fractions = np.column_stack([(x - h * xz - g * xy) / lx, g, h])
    image = np.floor(fractions)
    # the box is about the origin, and particles are in it
    f, g, h = (fractions - image - 0.5).T
    frame = hoomd.Frame()
    frame.configuration.dimensions = dimension
    frame.configuration.box = [lx, ly, lz, xy / ly, *((xz / lz, yz / lz) if lz else (0.0, 0.0))]
    particles = frame.particles
    particles.N = len(species)
    particles.position = np.column_stack([lx * f + xy * g + xz * h, ly * g + yz * h, lz * h])
    particles.image = image.astype(np.int32)
    particles.types = [_letters(n) for n in range(types)]
    particles.typeid = species
    particles.diameter = 2.0 * radius
    frame.log[_RADII] = radius
    with hoomd.open(path, "w") as file:
        file.append(frame)


def read_gsd(path: Path, number: int) -> Particles:
    """The particles of a frame.

    Args:
        path: of the file.
        number: of the frame, negative from the end.

    Raises:
        ValueError: there is no such frame.
        RuntimeError, OSError: the file is damaged.
    """
    hoomd = optional("gsd.hoomd", "gsd")
    with hoomd.open(path, "r") as file:
        check_frame(number, len(file))
        frame, places = file[number], {number % len(file), 0}  # defaults are those of the first
        sized = any(file.file.chunk_exists(n, "particles/diameter") for n in places)
    lx, ly, lz, xy, xz, yz = frame.configuration.box.astype(np.float64).tolist()
    box = np.array([[lx, 0.0, 0.0], [xy * ly, ly, 0.0], [xz * lz, yz * lz, lz]])
    particles, count = frame.particles, frame.particles.N
    columns = {
        name: getattr(particles, name) for name in ("diameter",) * sized + ("mass", "charge")
    }
    if _RADII in frame.log:
        columns["radius"] = frame.log[_RADII]
    image = particles.image * [1.0, 1.0, float(frame.configuration.dimensions == 3)]
    return Particles(
        particles.position + image @ box,
        box,
        np.arange(1, count + 1),
        np.array(particles.types)[particles.typeid],
        columns,
        -0.5 * box.sum(axis=0),
        names=particles.types,
        count=len(particles.types),
    )


def _letters(n: int) -> str:
    """A, B, ..., Z, AA, AB, ..."""
    return ("" if n < 26 else _letters(n // 26 - 1)) + chr(ord("A") + n % 26)


# What an atom style has between the ID and the position of an atom.
_STYLES = {
    "atomic": "type",
    "charge": "type q",
    "dipole": "type q",
    "bond": "molecule type",
    "angle": "molecule type",
    "molecular": "molecule type",
    "full": "molecule type q",
    "sphere": "type diameter density",
    "bpm/sphere": "molecule type diameter density",
}

# Edges of the box that the head must have, with the number of words of their lines.
_EDGES = {"xhi": 4, "yhi": 4, "atoms": 2}


def data_file(
    title: str,
    style: str,
    box: ArrayLike,
    types: int,
    columns: Sequence[NDArray[Any]],
    positions: NDArray[np.float64],
    bonds: NDArray[np.int64] | None = None,
    origin: Sequence[float] = (0, 0, 0),
    velocities: NDArray[np.float64] | None = None,
    spins: NDArray[np.float64] | None = None,
    images: NDArray[np.int64] | None = None,
) -> str:
    """Text of a LAMMPS data file, with every digit.

    Args:
        title: first line.
        style: LAMMPS atom_style; masses are 1, or given by atom for `sphere`.
        box: lattice vectors as rows, those of a packing, shape (d, d) [length].
        types: number of atom types, and of bond types if there are bonds.
        columns: values of the style between ID and position of an atom, arrays of shape (N,).
        positions: of the atoms, shape (N, d) [length].
        bonds: type and both atoms of each bond, shape (M, 3).
        origin: lower left corner of the box, d numbers [length].
        velocities: of the atoms, shape (N, d) [length/time]; at rest if not given.
        spins: angular velocities beside them, shape (N,), of `sphere` [1/time]; 0 if not given.
        images: how often atoms have left the box through each side, shape (N, d); written if any
            has.
    """
    vectors = np.asarray(box, dtype=np.float64)
    dimension, height = len(vectors), " 0" * (3 - len(vectors))
    lines = [title, "", f"{len(positions)} atoms", f"{types} atom types"]
    if bonds is not None:
        lines += [f"{len(bonds)} bonds", f"{types} bond types"]
    sides = zip("xyz", origin, vectors.diagonal().tolist(), strict=False)
    lines += [f"{low!r} {plus(low, side)} {axis}lo {axis}hi" for axis, low, side in sides]
    if dimension == 2:
        lines += ["-0.5 0.5 zlo zhi", f"{float(vectors[1, 0])!r} 0 0 xy xz yz", ""]
    else:
        xy, xz, yz = vectors[np.tril_indices(3, -1)].tolist()
        lines += [f"{xy!r} {xz!r} {yz!r} xy xz yz", ""]
    if style != "sphere":
        lines += ["Masses", "", *(f"{n} 1" for n in range(1, types + 1)), ""]
    lines += [f"Atoms # {style}", ""]
    rows = zip(*(column.tolist() for column in columns), *positions.T.tolist(), strict=True)
    flags = [""] * len(positions)
    if images is not None and images.any():
        flags = [f" {' '.join(map(str, row))}{height}" for row in images.tolist()]
    lines += [
        f"{n} {' '.join(map(repr, row))}{height}{flag}"
        for n, (row, flag) in enumerate(zip(rows, flags, strict=True), start=1)
    ]
    if velocities is not None:
        turns = [""] * len(positions)
        if style == "sphere":
            about_z = np.zeros(len(positions)) if spins is None else spins
            turns = [f" 0 0 {w!r}" for w in about_z.tolist()]
        moving = zip(velocities.tolist(), turns, strict=True)
        lines += ["", "Velocities", ""]
        lines += [
            f"{n} {' '.join(map(repr, v))}{height}{turn}" for n, (v, turn) in enumerate(moving, 1)
        ]
    if bonds is not None:
        lines += ["", "Bonds", ""]
        lines += [f"{n} {a} {b} {c}" for n, (a, b, c) in enumerate(bonds.tolist(), start=1)]
    return "\n".join(lines) + "\n"


def sphere_columns(radius: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Diameters and densities of spheres of mass 1, arrays of shape (N,)."""
    return [2.0 * radius, 0.75 / (np.pi * radius**3)]


def is_data_file(start: str) -> bool:
    """Whether a text begins as a data file does."""
    return bool(re.search(r"^\s*\d+\s+atoms\b", start, re.M) and re.search(r"\bxlo\s+xhi\b", start))


def read_data_file(text: str) -> Particles:
    """The atoms of a data file.

    Args:
        text: of the file, as LAMMPS' `write_data` or `data_file` writes it.

    Raises:
        ValueError: the text is no such file, or lacks atoms.
    """
    head, _, body = re.sub(r"[ \t\r]+$", "", text, flags=re.M).partition("\nAtoms")
    lines = [line.partition("#")[0].split() for line in head.splitlines()[1:]]
    words = {line[-1]: line for line in lines if line}
    if {"avec", "bvec"} & words.keys():
        raise ValueError("its box is a general one: write_data without triclinic/general")
    if any(len(words.get(word, ())) != size for word, size in _EDGES.items()):
        raise ValueError("it is no LAMMPS data file of a box with atoms")
    hint, _, rows = body.partition("\n")
    table, _, _ = rows.strip("\n").partition("\n\n")  # sections of LAMMPS follow
    atoms = table.splitlines()
    between = _between(hint.strip().removeprefix("#").strip(), atoms)
    names = ["id", *between.split(), "x", "y", "z"]
    complete = sum(len(row.split()) >= len(names) for row in atoms)
    if not atoms or complete != len(atoms) or complete != int(words["atoms"][0]):
        raise ValueError(f"it has {complete} of {words['atoms'][0]} atoms")
    if all(len(row.split()) >= len(names) + 3 for row in atoms):
        names += ["ix", "iy", "iz"]
    columns = columns_of(atoms, names)
    order = by_ids(columns["id"])
    ids, kinds, *place = (columns.pop(name)[order] for name in ("id", "type", "x", "y", "z"))
    ends = [words[name][:2] for name in ("xhi", "yhi")]
    ends.append(words["zhi"][:2] if len(words.get("zhi", ())) == 4 else ["-0.5", "0.5"])
    tilts = words["yz"] if len(words.get("yz", ())) == 6 else ["0", "0", "0"]
    xy, xz, yz = map(float, tilts[:3])
    box = np.diag([minus(high, low) for low, high in ends])
    box[np.tril_indices(3, -1)] = xy, xz, yz
    count = int(words["types"][0]) if len(words.get("types", ())) == 3 else 0
    return Particles(
        np.column_stack(place),
        box,
        ids.astype(np.int64),
        kinds.astype(np.int64),
        {name: column[order] for name, column in columns.items()},
        np.array([float(low) for low, _ in ends]),
        count=count,
    )


def _between(style: str, atoms: Sequence[str]) -> str:
    """Names of the columns between ID and position."""
    if not style and atoms and len(atoms[0].split()) in (5, 8):
        return _STYLES["atomic"]
    if style not in _STYLES:
        asked = f"has the style {style}" if style else "does not name its style"
        raise ValueError(
            f"its section Atoms {asked}, and {', '.join(_STYLES)} are known: give a dump with the "
            "columns id type x y radius"
        )
    return _STYLES[style]


# Those of a frame that are read.
_ITEMS = ("NUMBER OF ATOMS", "BOX BOUNDS", "ATOMS")

# What the names of coordinates end with: in the box, unwrapped, in parts of the box, both.
_DUMP_SUFFIXES = ("", "u", "s", "su")


def dump_frame(
    number: int,
    box: NDArray[np.float64],
    species: NDArray[np.int64],
    positions: NDArray[np.float64],
    columns: Mapping[str, NDArray[Any]],
    origin: Sequence[float] = (0, 0, 0),
    shut: Sequence[bool] = (False, False, False),
) -> str:
    """Text of a frame, with every digit.

    Args:
        number: of the frame.
        box: lattice vectors as rows, those of a packing, shape (d, d) [length].
        species: of the particles, from 0, shape (N,).
        positions: shape (N, d) [length].
        columns: further values of the particles by name, arrays of shape (N,).
        origin: lower left corner of the box [length]; 0 of one that is tilted.
        shut: whether the box is not periodic along each axis.
    """
    dimension, height = len(box), "" if len(box) == 3 else "0 "
    ends = " ".join("ff" if each else "pp" for each in (*shut, False)[:3])
    sides, tilts = box.diagonal().tolist(), box[np.tril_indices(dimension, -1)].tolist()
    # LAMMPS gives the bounding box of a tilted cell and the tilts beside it.
    if not any(tilts):
        edges = [f"{low!r} {plus(low, side)}" for low, side in zip(origin, sides, strict=False)]
        edges = [ends, *[*edges, "-0.5 0.5"][:3]]
    elif dimension == 2:
        (lx, ly), (xy,) = sides, tilts
        (left, right) = _overhang(xy)
        edges = [
            f"xy xz yz {ends}",
            f"{left!r} {plus(lx, right)} {xy!r}",
            f"0 {ly!r} 0",
            "-0.5 0.5 0",
        ]
    else:
        (lx, ly, lz), (xy, xz, yz) = sides, tilts
        (left, right), (low, high) = _overhang(xy, xz), _overhang(yz)
        edges = [
            f"xy xz yz {ends}",
            f"{left!r} {plus(lx, right)} {xy!r}",
            f"{low!r} {plus(ly, high)} {xz!r}",
            f"0 {lz!r} {yz!r}",
        ]
    lines = ["ITEM: TIMESTEP", str(number), "ITEM: NUMBER OF ATOMS", str(len(species))]
    lines += [f"ITEM: BOX BOUNDS {edges[0]}", *edges[1:]]
    lines.append("ITEM: ATOMS id type x y z " + " ".join(columns))
    rows = zip(
        species.tolist(),
        positions.tolist(),
        *(column.tolist() for column in columns.values()),
        strict=True,
    )
    for n, (kind, place, *values) in enumerate(rows, start=1):
        words = " ".join(map(repr, place))
        lines.append(f"{n} {kind + 1} {words} {height}" + " ".join(map(repr, values)))
    return "\n".join(lines) + "\n"


def _overhang(*tilts: float) -> tuple[float, float]:
    """How far the corners of a tilted cell are below 0 and above its side."""
    corners = [0.0, *tilts, sum(tilts)]
    return min(corners), max(corners)


def frame_texts(path: Path) -> Sequence[slice]:
    """Where the frames of a dump stand in its bytes."""
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        starts = [found.start() for found in re.finditer(rb"^ITEM: TIMESTEP", content, re.M)]
        return [slice(a, b) for a, b in zip(starts, [*starts[1:], len(content)], strict=True)]


def read_dump_frame(text: str) -> Particles:
    """The atoms of one frame.

    Args:
        text: of the frame; its first line may be missing.

    Raises:
        ValueError: it is no frame, or lacks atoms.
    """
    lines = text.splitlines()
    heads: dict[str, int] = {}
    for n, line in enumerate(lines):
        if line.startswith("ITEM: "):
            heads |= {name: n for name in _ITEMS if line.startswith(f"ITEM: {name}")}
            if "ATOMS" in heads:
                break
    if len(heads) < 3:
        raise ValueError("it has no frame with ITEM: NUMBER OF ATOMS, BOX BOUNDS and ATOMS")
    count = int(lines[heads["NUMBER OF ATOMS"] + 1])
    first = heads["ATOMS"]
    rows = lines[first + 1 : first + 1 + count]
    # the file of a killed run ends within a row
    if len(rows) < count or (rows and not text.endswith("\n") and rows[-1] is lines[-1]):
        raise ValueError(f"the frame has {len(rows)} of {count} atoms, the last one maybe in part")
    columns = columns_of(rows, lines[first].split()[2:])
    order = by_ids(columns["id"]) if "id" in columns else np.arange(count)
    columns = {name: column[order] for name, column in columns.items()}
    at = heads["BOX BOUNDS"]
    edges = [row.split() for row in lines[at + 1 : min(at + 4, first)]]
    box, origin, periodic = _box(lines[at].split()[3:], edges)
    positions = _positions(columns, box, origin)
    ids = columns.pop("id").astype(np.int64) if "id" in columns else np.arange(1, count + 1)
    kind = columns.get("type", columns.get("element"))
    types, names = as_types(np.ones(count) if kind is None else kind)
    typed = kind is not None
    return Particles(positions, box, ids, types, columns, origin, periodic, names, typed=typed)


def _box(
    words: list[str], edges: list[list[str]]
) -> tuple[NDArray[np.float64], NDArray[np.float64], list[bool]]:
    """Lattice vectors, lower left corner, and which directions are periodic."""
    if words[:1] == ["abc"]:
        raise ValueError("its box is a general one: dump without triclinic/general")
    tilted = words[:3] == ["xy", "xz", "yz"]
    if len(edges) < 3 or any(len(edge) < 2 + tilted for edge in edges):
        raise ValueError("the bounds of its box are incomplete")
    xy, xz, yz = (float(edge[2]) for edge in edges) if tilted else (0.0, 0.0, 0.0)
    # these are the bounds of the tilted box
    below, above = zip(_overhang(xy, xz), _overhang(yz), (0.0, 0.0), strict=True)
    lows, highs = zip(*(edge[:2] for edge in edges), strict=True)
    lower = [minus(low, repr(a)) for low, a in zip(lows, below, strict=True)]
    over = [(repr(b), repr(-a)) for a, b in zip(below, above, strict=True)]
    box = np.diag([minus(h, low, *o) for h, low, o in zip(highs, lows, over, strict=True)])
    box[np.tril_indices(3, -1)] = xy, xz, yz
    ends = [end == "pp" for end in words[3 * tilted :]] or [True, True, True]
    return box, np.array(lower), ends


def _positions(
    columns: dict[str, NDArray[Any]], box: NDArray[np.float64], origin: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Positions, shape (N, 3) [length]; their columns are taken out."""
    for suffix in _DUMP_SUFFIXES:
        x, y, z = (axis + suffix for axis in "xyz")
        if x not in columns or y not in columns:
            continue
        place = np.column_stack([columns.pop(x), columns.pop(y)])
        heights = columns.pop(z) if z in columns else np.zeros(len(place))
        if suffix.startswith("s"):
            (lx, _, _), (xy, ly, _), (xz, yz, lz) = box.tolist()
            f, g, h = *place.T, heights
            x0, y0, z0 = origin.tolist()
            return np.column_stack(
                [x0 + (lx * f + xy * g + xz * h), y0 + (ly * g + yz * h), z0 + lz * h]
            )
        return np.column_stack([place, heights])
    raise ValueError(f"it has no positions, such as x and y, among its columns {' '.join(columns)}")


def universe_of(
    box: NDArray[np.float64],
    species: NDArray[np.int64],
    positions: NDArray[np.float64],
    radius: NDArray[np.float64],
) -> Universe:
    """A Universe of one frame.

    Args:
        box: lattice vectors as rows, shape (d, d) [length].
        species: of the particles, from 0, shape (N,).
        positions: from the lower left corner of the box, shape (N, d) [length].
        radius: of the particles, shape (N,) [length].
    """
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


def open_universe(path: Path, topology: Path | int | None) -> Universe:
    """The Universe of a file, with lengths as they are in it, or of a trajectory.

    Args:
        path: of the file.
        topology: file that tells the particles of a trajectory, or their number.

    Raises:
        Exception: whatever MDAnalysis and its readers raise.
    """
    import MDAnalysis

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # masses that are guessed, and the like, are not used
        if isinstance(topology, int):
            return MDAnalysis.Universe.empty(topology).load_new(str(path), convert_units=False)
        files = [path] if topology is None else [topology, path]
        return MDAnalysis.Universe(*map(str, files), convert_units=False)


def read_universe(universe: Universe, number: int, wanted: Sequence[str]) -> Particles:
    """The particles of a frame.

    Args:
        universe: of a file.
        number: of the frame, negative from the end.
        wanted: names of the attributes of atoms that become columns, if there are such.

    Raises:
        ValueError: there is no such frame.
    """
    check_frame(number, len(universe.trajectory))
    frame, atoms = universe.trajectory[number], universe.atoms
    typed = hasattr(atoms, "types")
    types, names = as_types(np.asarray(atoms.types if typed else np.ones(len(atoms))))
    box = None if frame.dimensions is None else frame.triclinic_dimensions.astype(np.float64)
    columns = {name: np.asarray(getattr(atoms, name)) for name in wanted if hasattr(atoms, name)}
    positions = frame.positions.astype(np.float64)
    ids = atoms.indices + 1
    return Particles(positions, box, ids, types, columns, names=names, typed=typed)


def in_space(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors of the plane with z = 0, those of space as they are, shape (N, 3)."""
    return np.column_stack([vectors, np.zeros((len(vectors), 3 - vectors.shape[1]))])


def box_in_space(box: NDArray[np.float64]) -> list[float]:
    """Lengths and angles [degrees] of a box; that of a plane is as high as its longer side."""
    if len(box) == 3:
        from MDAnalysis.lib.mdamath import triclinic_box

        return [float(number) for number in triclinic_box(*box)]
    a, b = np.linalg.norm(box, axis=1).tolist()
    return [a, b, max(a, b), 90.0, 90.0, float(np.degrees(np.arctan2(box[1, 1], box[1, 0])))]


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

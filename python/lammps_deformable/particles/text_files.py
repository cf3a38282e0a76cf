"""Particles in text files: LAMMPS data files and dumps, and extended XYZ, with every digit.

MDAnalysis and LAMMPS round what they read.

Source: https://github.com/libAtoms/extxyz, the specification of extended XYZ.
"""

from __future__ import annotations

import mmap
import re
from collections import deque
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Context, Decimal
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common._checks import positive, shown
from ..common.box import cartesian
from ..common.errors import ParameterError

Floats = NDArray[np.float64]

# Heights that differ by less than this part of the width are one plane, and angles of a box by
# less than this are right angles: single precision.
_PLANE = 1e-6

# Names that radii have, where none is given; those of diameters are halved.
RADII = ("radius", "diameter", "radii")

# What is told where types are needed and the file has none.
UNTYPED = "it has no types of particles: give a file that has them"


@dataclass(frozen=True)
class Particles:
    """Particles of a file, in the order of their IDs.

    Attributes:
        positions: shape (N, 3) [length].
        box: lattice vectors as rows, shape (3, 3) [length]; None if the file has none.
        ids: as the file has them, shape (N,).
        types: numbers from 1, or names, shape (N,).
        columns: other values by name, arrays of shape (N,).
        origin: lower left corner of the box, shape (3,) [length].
        periodic: whether the box is, along x, y and z.
        names: of all types; none if these are numbers.
        numbered: whether the file tells the order of the names; it is that of the alphabet if not.
        count: number of types, if the file has it.
        typed: whether the file tells the types; they are 1 if not.
        step: of the last digit of positions that are rounded, see `step_of` [length].
    """

    positions: Floats
    box: Floats | None
    ids: NDArray[np.int64]
    types: NDArray[Any]
    columns: Mapping[str, NDArray[Any]]
    origin: Floats = field(default_factory=lambda: np.zeros(3))
    periodic: Sequence[bool] = (True, True, True)
    names: Sequence[str] = ()
    numbered: bool = True
    count: int = 0
    typed: bool = True
    step: float = 0.0

    def places(self, dimension: int = 2) -> Floats:
        """Positions, shape (N, d) [length].

        Raises:
            ValueError: a number is not finite, or the particles are not in one plane and should be.
        """
        wrong = np.argwhere(~np.isfinite(self.positions))
        if len(wrong) > 0:
            n, axis = wrong[0]
            raise ValueError(f"{'xyz'[axis]} of atom {self.ids[n]} is {self.positions[n, axis]}")
        low, high = self.positions.min(axis=0), self.positions.max(axis=0)
        if dimension == 2 and high[2] - low[2] > _PLANE * (high - low)[:2].max():
            raise ValueError(
                f"its atoms fill space, z goes from {low[2]:.6g} to {high[2]:.6g}, but a packing "
                "in the plane has one z: read it with dimension=3 (in the shell --law droplet), or "
                "write the atoms of one z to a file of their own"
            )
        return self.positions[:, :dimension]

    def lattice(self, dimension: int = 2) -> Floats:
        """((lx, 0), (xy, ly)), or ((lx, 0, 0), (xy, ly, 0), (xz, yz, lz)), shape (d, d) [length].

        Raises:
            ValueError: there is no box, or another one.
        """
        if self.box is None:
            form = "(lx, ly)" if dimension == 2 else "(lx, ly, lz)"
            raise ValueError(f"it has no box: give one, such as box={form}")
        box, zero = self.box, np.triu(np.ones((3, 3), bool), 1)
        zero[2, :2] = dimension == 2
        sides = box.diagonal()[:dimension]
        off = np.abs(box[zero]).max() > _PLANE * np.abs(box).max()
        if off or not (np.isfinite(box).all() and (sides > 0.0).all()):
            raise ValueError(
                f"its box is {shown(box.tolist())}, but "
                + (
                    "the plane of a packing has lattice vectors (lx, 0, 0) and (xy, ly, 0), with "
                    "the third one along z"
                    if dimension == 2
                    else "that of a packing has lattice vectors (lx, 0, 0), (xy, ly, 0) and "
                    "(xz, yz, lz)"
                )
            )
        return np.tril(box[:dimension, :dimension])

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
        """Radius of each particle, shape (N,) [length]; `radii` as in `Packing.from_file`.

        Raises:
            ValueError: the file lacks radii, or has one that is not positive.
        """
        if isinstance(radii, Mapping):
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
        if (wrong := np.flatnonzero(~((values > 0.0) & (values < np.inf)))).size:
            n = int(wrong[0])
            raise ValueError(
                f"{name} of atom {self.ids[n]} is {values[n]:g}, which is no radius: give radii, "
                "such as radii=0.5"
            )
        return values.astype(np.float64) / (2.0 if name == "diameter" else 1.0)


def check_radii(radii: float | str | Mapping[Any, float] | None) -> None:
    """Raise a ParameterError for a radius that is not positive."""
    if isinstance(radii, Mapping) and not radii:
        raise ParameterError("radii by type must have a type, as in {1: 0.5, 2: 0.7}, not {}")
    for name, radius in radii.items() if isinstance(radii, Mapping) else ():
        positive(f"the radius of type {name}", radius)
    if not (radii is None or isinstance(radii, (str, Mapping))):
        positive("radii", radii)


# Tables of numbers and words. What cannot be read is a ValueError, which `read_particles` completes
# with the name of the file.


def _table(*columns: NDArray[Any]) -> list[str]:
    """Rows of columns, with every digit."""
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return [" ".join(map(repr, row)) for row in rows]


def _axes(vectors: NDArray[Any]) -> list[NDArray[Any]]:
    """x, y and z of vectors; z = 0 of those of the plane."""
    flat = [np.zeros(len(vectors), int)] * (3 - vectors.shape[1])
    return [*vectors.T, *flat]


def _columns_of(
    rows: Sequence[str], names: Sequence[str], texts: Collection[str] = ()
) -> dict[str, NDArray[Any]]:
    """Columns of a table: numbers where its first row has numbers, else words, as for `texts`."""
    if not rows:
        raise ValueError("it has no atoms")
    first = rows[0].split()
    if len(first) < len(names):
        raise ValueError(f"a row has {len(first)} values for the columns {' '.join(names)}")
    numeric = [k for k, name in enumerate(names) if name not in texts and _is_number(first[k])]
    values = np.loadtxt(rows, usecols=numeric, ndmin=2).T if numeric else np.empty((0, 0))
    found: dict[int, NDArray[Any]] = dict(zip(numeric, values, strict=True))
    if len(found) < len(names):
        words = list(zip(*(row.split()[: len(names)] for row in rows), strict=True))
        found |= {k: np.array(words[k]) for k in range(len(names)) if k not in found}
    return {name: found[k] for k, name in enumerate(names)}


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def as_types(words: NDArray[Any] | None, count: int) -> dict[str, Any]:
    """Types as numbers if all are whole numbers, else with their names; 1 if none are told."""
    if words is None:
        return {"types": np.ones(count, np.int64), "names": [], "typed": False}
    if words.dtype.kind in "biuf" and np.array_equal(words, np.rint(words)):
        return {"types": words.astype(np.int64), "names": []}
    texts = words.astype(str)
    names = np.unique(texts).tolist()
    if all(name.isascii() and name.isdigit() and name == str(int(name)) for name in names):
        return {"types": texts.astype(np.int64), "names": []}
    return {"types": texts, "names": names, "numbered": False}


def step_of(numbers: NDArray[Any]) -> float:
    """What the last digits of rounded numbers count, such as 1e-4 of 12.3457 and 3.14159.

    It is 0 of numbers of which most do not need all these digits, as those that a person writes.
    """
    flat = numbers.ravel()
    few = flat[:: max(1, len(flat) // _SAMPLE)]
    few = few[(few != 0.0) & np.isfinite(few)]
    if len(few) == 0:
        return 0.0
    texts = (np.format_float_scientific(x, trim="-").partition("e")[0] for x in few)
    digits = np.array([len(text.replace(".", "").lstrip("-")) for text in texts])
    most = int(digits.max())
    if most < _FEWEST or np.mean(digits >= most - 1) < 0.5:
        return 0.0
    return float(10.0 ** (np.floor(np.log10(np.abs(few).max())) + 1 - most))


# Numbers of fewer digits are not taken for rounded ones, and how many numbers tell the digits.
_FEWEST, _SAMPLE = 4, 1000


def _by_ids(columns: dict[str, NDArray[Any]], count: int) -> dict[str, NDArray[Any]]:
    """Columns in the order of IDs, which are 1, 2, ... where there are none."""
    columns = {"id": np.arange(1, count + 1)} | columns
    order = np.argsort(columns["id"], kind="stable")
    ids = columns["id"][order].astype(np.int64)
    if (same := np.flatnonzero(np.diff(ids) == 0)).size:
        raise ValueError(f"atom {ids[same[0]]} occurs twice: write each particle once")
    return {name: column[order] for name, column in columns.items()} | {"id": ids}


def check_frame(number: int, count: int) -> None:
    """Raise a ValueError for the number of a frame that a file of `count` frames lacks."""
    if not -count <= number < count:
        known = f"0 to {count - 1}, or -1 to {-count} from the end" if count > 1 else "0"
        raise ValueError(f"it has {count} frames, and no frame {number}: give {known}")


# Digits of a sum of numbers of a file: none is lost.
_EXACT = Context(prec=60)


def _plus(*numbers: float) -> str:
    """The sum with all digits: a file that gives two ends of a box keeps its length to the last."""
    total = Decimal(0)
    for number in numbers:
        total = _EXACT.add(total, Decimal(repr(number)))
    return str(total)


def _minus(a: str, *others: str) -> float:
    """The difference of numbers of a file, rounded once."""
    if not all(np.isfinite(float(word)) for word in (a, *others)):
        raise ValueError(f"its box has the bounds {' '.join((*others[:1], a))}")
    left = Decimal(a)
    for word in others:
        left = _EXACT.subtract(left, Decimal(word))
    return float(left)


def tilts_of(box: Floats) -> list[float]:
    """xy, xz, yz of a box of a plane or of space."""
    tilts: list[float] = box[np.tril_indices(len(box), -1)].tolist()
    return [*tilts, 0.0, 0.0][:3]


def box_of(sides: Sequence[float], xy: float, xz: float, yz: float) -> Floats:
    """Lattice vectors as rows, shape (3, 3)."""
    box = np.diag(sides)
    box[np.tril_indices(3, -1)] = xy, xz, yz
    return box


# LAMMPS data files


# What an atom style has behind the ID of an atom.
_STYLES = {
    "atomic": "type x y z",
    "charge": "type q x y z",
    "dipole": "type q x y z mux muy muz",
    "bond": "molecule type x y z",
    "angle": "molecule type x y z",
    "molecular": "molecule type x y z",
    "full": "molecule type q x y z",
    "sphere": "type diameter density x y z",
    "bpm/sphere": "molecule type diameter density x y z",
}

# Of the style hybrid, whose parts LAMMPS does not name: this and then what these have besides.
_HYBRID = "type x y z"

# Edges of the box that the head must have, with the number of words of their lines.
_EDGES = {"xhi": 4, "yhi": 4, "atoms": 2}


def data_file(
    title: str,
    style: str,
    box: ArrayLike,
    types: int,
    columns: Sequence[NDArray[Any]],
    positions: Floats,
    bonds: NDArray[np.int64] | None = None,
    origin: Sequence[float] = (0, 0, 0),
    velocities: Floats | None = None,
    spins: Floats | None = None,
    images: NDArray[np.int64] | None = None,
    half: float = 0.5,
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
        spins: angular velocities beside them, shape (N,), in space (N, 3), of `sphere` [1/time]; 0
            if not given.
        images: how often atoms have left the box through each side, shape (N, d); written if any
            has.
        half: the half thickness of a box in the plane, see `half_thickness` [length].
    """
    vectors, ids = np.asarray(box, np.float64), np.arange(1, len(positions) + 1)
    lines = [title, "", f"{len(positions)} atoms", f"{types} atom types"]
    if bonds is not None:
        lines += [f"{len(bonds)} bonds", f"{types} bond types"]
    sides = zip("xyz", origin, vectors.diagonal().tolist(), strict=False)
    lines += [f"{low!r} {_plus(low, side)} {axis}lo {axis}hi" for axis, low, side in sides]
    lines += [f"{-half!r} {half!r} zlo zhi"] * (3 - len(vectors))
    lines += [" ".join(map(repr, tilts_of(vectors))) + " xy xz yz", ""]
    if style != "sphere":
        lines += ["Masses", "", *(f"{n} 1" for n in range(1, types + 1)), ""]
    flags = [] if images is None or not images.any() else _axes(images)
    lines += [f"Atoms # {style}", "", *_table(ids, *columns, *_axes(positions), *flags)]
    if velocities is not None:
        none = np.zeros(len(ids), int)
        about_z = 0.0 * ids if spins is None else spins
        in_space = [*about_z.T] if about_z.ndim == 2 else [none, none, about_z]
        turns = in_space if style == "sphere" else []
        lines += ["", "Velocities", "", *_table(ids, *_axes(velocities), *turns)]
    if bonds is not None:
        lines += ["", "Bonds", "", *_table(np.arange(1, len(bonds) + 1), *bonds.T)]
    return "\n".join(lines) + "\n"


def sphere_columns(radius: Floats) -> list[Floats]:
    """Diameters and densities of spheres of mass 1, arrays of shape (N,)."""
    return [2.0 * radius, 0.75 / (np.pi * radius**3)]


def read_data_file(text: str) -> Particles:
    """The atoms of a data file, as LAMMPS' `write_data` or `data_file` writes it.

    Raises:
        ValueError: the text is no such file, or lacks atoms.
    """
    head, _, body = re.sub(r"[ \t\r]+$", "", text, flags=re.M).partition("\nAtoms")
    head, _, labels = head.partition("\nAtom Type Labels\n")
    lines = [line.partition("#")[0].split() for line in head.splitlines()[1:]]
    words = {line[-1]: line for line in lines if line}
    kinds = [line for line in lines if line[1:] == ["atom", "types"]]
    if {"avec", "bvec"} & words.keys():
        raise ValueError("its box is a general one: write_data without triclinic/general")
    if any(len(words.get(word, ())) != size for word, size in _EDGES.items()):
        raise ValueError("it is no LAMMPS data file of a box with atoms")
    hint, _, rows = body.partition("\n")
    table, _, _ = rows.strip("\n").partition("\n\n")  # sections of LAMMPS follow
    atoms, style = table.splitlines(), hint.strip().removeprefix("#").strip()
    if not style and atoms and len(atoms[0].split()) in (5, 8):
        style = "atomic"
    parts = style.split()
    if not parts or any(part not in _STYLES for part in parts[parts[0] == "hybrid" :]):
        asked = f"has the style {style}" if style else "does not name its style"
        raise ValueError(
            f"its section Atoms {asked}, and {', '.join(_STYLES)}, hybrid are known: give a dump "
            "with the columns id type x y radius"
        )
    if parts[0] == "hybrid":
        values = " ".join([_HYBRID, *map(_STYLES.__getitem__, parts[1:])]).split()
    else:
        values = _STYLES[style].split()
    names = ["id", *dict.fromkeys(values)]
    complete = sum(len(row.split()) >= len(names) for row in atoms)
    if not atoms or complete != len(atoms) or complete != int(words["atoms"][0]):
        raise ValueError(f"it has {complete} of {words['atoms'][0]} atoms")
    if style != "hybrid" and all(len(row.split()) >= len(names) + 3 for row in atoms):
        names += ["ix", "iy", "iz"]
    columns = _by_ids(_columns_of(atoms, names), len(atoms))
    ids, types, *place = (columns.pop(name) for name in ("id", "type", "x", "y", "z"))
    ends = [words[name][:2] for name in ("xhi", "yhi")]
    ends.append(words["zhi"][:2] if len(words.get("zhi", ())) == 4 else ["-0.5", "0.5"])
    tilts = words["yz"] if len(words.get("yz", ())) == 6 else ["0", "0", "0"]
    positions = np.column_stack(place)
    return Particles(
        positions,
        box_of([_minus(high, low) for low, high in ends], *map(float, tilts[:3])),
        ids,
        columns=columns,
        origin=np.array([float(low) for low, _ in ends]),
        count=int(kinds[0][0]) if kinds else 0,
        step=step_of(positions),
        **_labeled(types, labels),
    )


def _labeled(types: NDArray[Any], labels: str) -> dict[str, Any]:
    """Types by the rows of Atom Type Labels, if any, of which files have numbers or names."""
    rows = labels.strip("\n").partition("\n\n")[0].splitlines()
    named = {number: name for number, name in (row.split()[:2] for row in rows)}
    words = [f"{word:g}" if types.dtype.kind in "biuf" else word for word in types.tolist()]
    names = [name for _, name in sorted(named.items(), key=lambda row: int(row[0]))]
    if not named:
        if types.dtype.kind not in "biuf":
            raise ValueError(f"type {words[0]} has no number: it lacks Atom Type Labels")
        return {"types": types.astype(np.int64)}
    unknown = [word for word in words if word not in named and word not in names]
    if unknown:
        raise ValueError(f"its Atom Type Labels lack type {unknown[0]}")
    return {"types": np.array([named.get(word, word) for word in words]), "names": names}


# LAMMPS dumps


# Items of a frame that are read.
_ITEMS = ("NUMBER OF ATOMS", "BOX BOUNDS", "ATOMS")

# What the names of coordinates end with: in the box, unwrapped, in parts of the box, both.
_SUFFIXES_OF_XYZ = ("", "u", "s", "su")

# Of the columns of types, the first that there is.
_KINDS = ("type", "typelabel", "element")


def dump_frame(
    number: int,
    box: Floats,
    species: NDArray[np.int64],
    positions: Floats,
    columns: Mapping[str, NDArray[Any]],
    origin: Sequence[float] = (0, 0, 0),
    shut: Sequence[bool] = (False, False, False),
    half: float = 0.5,
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
        half: the half thickness of a box in the plane, see `half_thickness` [length].
    """
    tilts, ends = tilts_of(box), ["ff" if each else "pp" for each in (*shut, False)[:3]]
    # the bounds are those of the tilted box
    edges = [
        f"{low + below!r} {_plus(low, side, above)}"
        for low, side, (below, above) in zip(
            origin, box.diagonal().tolist(), _overhangs(*tilts), strict=False
        )
    ]
    edges += [f"{-half!r} {half!r}"] * (3 - len(box))
    if any(tilts):
        ends = ["xy xz yz", *ends]
        edges = [f"{edge} {tilt!r}" for edge, tilt in zip(edges, tilts, strict=True)]
    lines = ["ITEM: TIMESTEP", str(number), "ITEM: NUMBER OF ATOMS", str(len(species))]
    lines += [f"ITEM: BOX BOUNDS {' '.join(ends)}", *edges]
    lines.append("ITEM: ATOMS id type x y z " + " ".join(columns))
    ids = np.arange(1, len(species) + 1)
    lines += _table(ids, species + 1, *_axes(positions), *columns.values())
    return "\n".join(lines) + "\n"


def _overhangs(xy: float, xz: float, yz: float) -> list[tuple[float, float]]:
    """How far the corners of a tilted box are below 0 and above its sides, along x, y and z."""
    corners = ([0.0, xy, xz, xy + xz], [0.0, yz], [0.0])
    return [(min(each), max(each)) for each in corners]


def read_dump_frame(text: str) -> Particles:
    """The atoms of one frame, whose first line may be missing.

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
    count, first, at = int(lines[heads["NUMBER OF ATOMS"] + 1]), heads["ATOMS"], heads["BOX BOUNDS"]
    rows = lines[first + 1 : first + 1 + count]
    # the file of a killed run ends within a row
    if len(rows) < count or (rows and not text.endswith("\n") and rows[-1] is lines[-1]):
        raise ValueError(f"the frame has {len(rows)} of {count} atoms, the last one maybe in part")
    columns = _by_ids(_columns_of(rows, lines[first].split()[2:]), count)
    words, edges = (
        lines[at].split()[3:],
        [row.split() for row in lines[at + 1 : min(at + 4, first)]],
    )
    if words[:1] == ["abc"]:
        raise ValueError("its box is a general one: dump without triclinic/general")
    tilted = words[:3] == ["xy", "xz", "yz"]
    if len(edges) < 3 or any(len(edge) < 2 + tilted for edge in edges):
        raise ValueError("the bounds of its box are incomplete")
    tilts = [float(edge[2]) if tilted else 0.0 for edge in edges]
    over = _overhangs(*tilts)
    bounds = list(zip(edges, over, strict=True))
    origin = np.array([_minus(low, repr(below)) for (low, *_), (below, _) in bounds])
    sides = [_minus(high, low, repr(b), repr(-a)) for (low, high, *_), (a, b) in bounds]
    box = box_of(sides, *tilts)
    (positions, step), ids = _positions(columns, box, origin), columns.pop("id")
    kind = next((columns[name] for name in _KINDS if name in columns), None)
    periodic = [end == "pp" for end in words[3 * tilted :]] or [True, True, True]
    return Particles(
        positions,
        box,
        ids,
        columns=columns,
        origin=origin,
        periodic=periodic,
        step=step,
        **as_types(kind, count),
    )


def _positions(
    columns: dict[str, NDArray[Any]], box: Floats, origin: Floats
) -> tuple[Floats, float]:
    """Positions, shape (N, 3), and the step of their last digit [length]; takes their columns."""
    for suffix in _SUFFIXES_OF_XYZ:
        x, y, z = (axis + suffix for axis in "xyz")
        if x in columns and y in columns:
            plane = [columns.pop(x), columns.pop(y)]
            place = np.column_stack([*plane, columns.pop(z, np.zeros(len(plane[0])))])
            step = step_of(place[:, :2])
            if suffix.startswith("s"):
                return origin + cartesian(place, box), step * float(box.diagonal()[:2].max())
            return place, step
    raise ValueError(f"it has no positions, such as x and y, among its columns {' '.join(columns)}")


def frame_texts(path: Path) -> Sequence[slice]:
    """Where the frames of a dump stand in its bytes."""
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        starts = [found.start() for found in re.finditer(rb"^ITEM: TIMESTEP", content, re.M)]
        return [slice(a, b) for a, b in pairwise([*starts, len(content)])]


def read_dump(path: Path, number: int) -> Particles:
    """The atoms of a frame of a dump, as `read_dump_frame` reads it."""
    frames = frame_texts(path)
    check_frame(number, len(frames))
    place = frames[number]
    with path.open("rb") as file:
        file.seek(place.start)
        return read_dump_frame(file.read(place.stop - place.start).decode())


# Extended XYZ: a line with the number of particles, one of `key=value`, and one for each particle


# Columns of a file that does not tell.
_PLAIN = "species:S:1:pos:R:3"

# A pair of the second line. All else there is a comment, in which a quote is an apostrophe.
_PAIR = re.compile(r"""([\w-]+)=(?:"([^"]*)"|'([^']*)'|(\S*))""")

# What is read of it.
_KEYS = ("lattice", "properties", "origin", "pbc", "types")

# Of the columns of types, the first that there is.
_TYPES = ("species", "type", "element")

# Names of species in what is written: programs such as ASE know chemical elements only.
_ELEMENTS = (
    "H He Li Be B C N O F Ne Na Mg Al Si P S Cl Ar K Ca Sc Ti V Cr Mn Fe Co Ni Cu Zn Ga Ge As Se "
    "Br Kr Rb Sr Y Zr Nb Mo Tc Ru Rh Pd Ag Cd In Sn Sb Te I Xe Cs Ba La Ce Pr Nd Pm Sm Eu Gd Tb Dy "
    "Ho Er Tm Yb Lu Hf Ta W Re Os Ir Pt Au Hg Tl Pb Bi Po At Rn Fr Ra Ac Th Pa U Np Pu Am Cm Bk Cf "
    "Es Fm Md No Lr Rf Db Sg Bh Hs Mt Ds Rg Cn Nh Fl Mc Lv Ts Og"
)


def xyz_frame(
    box: Floats,
    species: NDArray[np.int64],
    positions: Floats,
    radius: Floats,
    origin: Sequence[float],
    shut: Sequence[bool],
    types: int,
) -> str:
    """Text of a frame, with every digit; see `dump_frame`.

    Species are chemical elements, and `types` of the second line has their order.
    """
    dimension = len(box)
    elements = _ELEMENTS.split()
    names = [*elements, *map(str, range(len(elements) + 1, types + 1))][:types]
    rows = [[*map(repr, vector[: n + 1]), "0", "0"][:3] for n, vector in enumerate(box.tolist())]
    rows += [["0", "0", "1"]] * (3 - dimension)
    head = [
        f'Lattice="{" ".join(word for row in rows for word in row)}"',
        f'Origin="{" ".join([*map(repr, origin), "-0.5"][:3])}"',
        f'pbc="{" ".join("F" if each else "T" for each in (*shut, False)[:3])}"',
        f'types="{" ".join(names)}"',
        "Properties=species:S:1:pos:R:3:radius:R:1",
    ]
    rows_of = zip(species.tolist(), _table(*_axes(positions), radius), strict=True)
    table = [f"{names[kind]} {row}" for kind, row in rows_of]
    return "\n".join([str(len(species)), " ".join(head), *table]) + "\n"


def read_xyz(path: Path, number: int) -> Particles:
    """The atoms of a frame of extended XYZ.

    Raises:
        ValueError: it is no such file, or has no such frame.
    """
    frames: deque[tuple[int, str, list[str]]] = deque(maxlen=1 if number >= 0 else -number)
    seen = 0
    with path.open() as file:
        for line in file:
            if not line.strip():
                continue
            if not line.strip().isdigit():
                raise ValueError(
                    f"a frame begins with the number of atoms, not {line.strip()[:60]!r}"
                )
            count = int(line)
            frames.append((count, file.readline(), list(islice(file, count))))
            seen += 1
            if seen == number + 1:
                break
    check_frame(number, seen)
    count, head, rows = frames[0]
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
    columns = _columns_of(rows, names, texts)
    if not all(f"pos{n}" in columns for n in range(3)):
        raise ValueError(f"it has no pos:R:3 among its columns {' '.join(names)}")
    positions = np.column_stack([columns.pop(f"pos{n}") for n in range(3)])
    kind = next((columns[name] for name in _TYPES if name in columns), None)
    order = said.get("types", "").split()
    if kind is not None and order and np.isin(kind, order).all():
        place = {name: n for n, name in enumerate(order, start=1)}
        kinds: dict[str, Any] = {"types": np.array([place[name] for name in kind.tolist()])}
        kinds["count"] = len(order)
    else:
        kinds = as_types(kind, count)
    box = None
    if "lattice" in said:
        box = _numbers("Lattice", said["lattice"], 9).reshape(3, 3)
    ends = [end[:1].upper() != "F" for end in said.get("pbc", "T T T").split()]
    if len(ends) != 3:
        raise ValueError(f"pbc must be three letters T or F, not {said['pbc']}")
    return Particles(
        positions,
        box,
        np.arange(1, count + 1),
        columns=columns,
        origin=_numbers("Origin", said.get("origin", "0 0 0"), 3),
        periodic=ends,
        step=step_of(positions),
        **kinds,
    )


def _numbers(name: str, words: str, count: int) -> Floats:
    values = np.array([float(word) for word in words.split()])
    if len(values) != count:
        raise ValueError(f"{name} must be {count} numbers, not {len(values)}")
    return values

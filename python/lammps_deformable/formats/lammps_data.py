"""LAMMPS data files, with every digit: LAMMPS itself and MDAnalysis round what they read."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .particles import Particles, by_ids, columns_of, minus, plus

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
    lines += [f"{n} {' '.join(map(repr, row))}{height}" for n, row in enumerate(rows, start=1)]
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

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
        f"{x0!r} {plus(x0, lx)} xlo xhi",
        f"{y0!r} {plus(y0, ly)} ylo yhi",
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
    (xlo, xhi, *_), (ylo, yhi, *_) = words["xhi"], words["yhi"]
    tilts = words["yz"] if len(words.get("yz", ())) == 6 else ["0", "0", "0"]
    xy, xz, yz = map(float, tilts[:3])
    box = np.array([[minus(xhi, xlo), 0.0, 0.0], [xy, minus(yhi, ylo), 0.0], [xz, yz, 1.0]])
    count = int(words["types"][0]) if len(words.get("types", ())) == 3 else 0
    return Particles(
        np.column_stack(place),
        box,
        ids.astype(np.int64),
        kinds.astype(np.int64),
        {name: column[order] for name, column in columns.items()},
        np.array([float(xlo), float(ylo)]),
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

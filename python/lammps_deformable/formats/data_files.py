"""LAMMPS data files, with every digit: LAMMPS rounds what it reads."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..particles.columns import (
    Floats,
    Particles,
    axes_of,
    box_of,
    by_ids,
    columns_of,
    exact_difference,
    exact_sum,
    step_of,
    table_rows,
    tilts_of,
)

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
    lines += [f"{low!r} {exact_sum(low, side)} {axis}lo {axis}hi" for axis, low, side in sides]
    lines += [f"{-half!r} {half!r} zlo zhi"] * (3 - len(vectors))
    lines += [" ".join(map(repr, tilts_of(vectors))) + " xy xz yz", ""]
    if style != "sphere":
        lines += ["Masses", "", *(f"{n} 1" for n in range(1, types + 1)), ""]
    flags = [] if images is None or not images.any() else axes_of(images)
    lines += [f"Atoms # {style}", "", *table_rows(ids, *columns, *axes_of(positions), *flags)]
    if velocities is not None:
        none = np.zeros(len(ids), int)
        about_z = 0.0 * ids if spins is None else spins
        in_space = [*about_z.T] if about_z.ndim == 2 else [none, none, about_z]
        turns = in_space if style == "sphere" else []
        lines += ["", "Velocities", "", *table_rows(ids, *axes_of(velocities), *turns)]
    if bonds is not None:
        lines += ["", "Bonds", "", *table_rows(np.arange(1, len(bonds) + 1), *bonds.T)]
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
    columns = by_ids(columns_of(atoms, names), len(atoms))
    ids, types, *place = (columns.pop(name) for name in ("id", "type", "x", "y", "z"))
    ends = [words[name][:2] for name in ("xhi", "yhi")]
    ends.append(words["zhi"][:2] if len(words.get("zhi", ())) == 4 else ["-0.5", "0.5"])
    tilts = words["yz"] if len(words.get("yz", ())) == 6 else ["0", "0", "0"]
    positions = np.column_stack(place)
    return Particles(
        positions,
        box_of([exact_difference(high, low) for low, high in ends], *map(float, tilts[:3])),
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
    named = dict(row.split()[:2] for row in rows)
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

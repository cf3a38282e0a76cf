"""LAMMPS dumps of atoms as text, with every digit."""

from __future__ import annotations

import mmap
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .particles import Particles, as_types, by_ids, columns_of, minus, plus

# Those of a frame that are read.
_ITEMS = ("NUMBER OF ATOMS", "BOX BOUNDS", "ATOMS")

# What the names of coordinates end with: in the box, unwrapped, in parts of the box, both.
_SUFFIXES = ("", "u", "s", "su")


def dump_frame(
    number: int,
    box: NDArray[np.float64],
    species: NDArray[np.int64],
    positions: NDArray[np.float64],
    columns: Mapping[str, NDArray[Any]],
    origin: Sequence[float] = (0, 0),
    shut: tuple[bool, bool] = (False, False),
) -> str:
    """Text of a frame of a two-dimensional system, with every digit.

    Args:
        number: of the frame.
        box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length].
        species: of the particles, from 0, shape (N,).
        positions: shape (N, 2) [length].
        columns: further values of the particles by name, arrays of shape (N,).
        origin: lower left corner of the box [length].
        shut: whether the box is not periodic along x and y.
    """
    (lx, _), (xy, ly) = box.tolist()
    x0, y0 = origin
    ends = " ".join("ff" if each else "pp" for each in shut)
    # LAMMPS gives the bounding box of a tilted cell and the tilts beside it.
    edges = (
        [f"{ends} pp", f"{x0!r} {plus(x0, lx)}", f"{y0!r} {plus(y0, ly)}", "-0.5 0.5"]
        if xy == 0.0
        else [
            f"xy xz yz {ends} pp",
            f"{min(0.0, xy)!r} {plus(lx, max(0.0, xy))} {xy!r}",
            f"0 {ly!r} 0",
            "-0.5 0.5 0",
        ]
    )
    lines = ["ITEM: TIMESTEP", str(number), "ITEM: NUMBER OF ATOMS", str(len(species))]
    lines += [f"ITEM: BOX BOUNDS {edges[0]}", *edges[1:]]
    lines.append("ITEM: ATOMS id type x y z " + " ".join(columns))
    rows = zip(
        species.tolist(),
        positions.tolist(),
        *(column.tolist() for column in columns.values()),
        strict=True,
    )
    for n, (kind, (x, y), *values) in enumerate(rows, start=1):
        lines.append(f"{n} {kind + 1} {x!r} {y!r} 0 " + " ".join(map(repr, values)))
    return "\n".join(lines) + "\n"


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
    kind = columns.get("type", columns.get("element", np.ones(count)))
    types, names = as_types(kind)
    return Particles(positions, box, ids, types, columns, origin, periodic, names)


def _box(
    words: list[str], edges: list[list[str]]
) -> tuple[NDArray[np.float64], NDArray[np.float64], tuple[bool, bool]]:
    """Lattice vectors, lower left corner, and whether x and y are periodic."""
    if words[:1] == ["abc"]:
        raise ValueError("its box is a general one: dump without triclinic/general")
    tilted = words[:3] == ["xy", "xz", "yz"]
    if len(edges) < 3 or any(len(edge) < 2 + tilted for edge in edges):
        raise ValueError("the bounds of its box are incomplete")
    xy, xz, yz = (float(edge[2]) for edge in edges) if tilted else (0.0, 0.0, 0.0)
    lx, ly, lz = (minus(high, low) for low, high, *_ in edges)
    x0, y0 = float(edges[0][0]), float(edges[1][0])
    if xy:  # these are the bounds of the tilted box
        low, high, *_ = edges[0]
        lx, x0 = minus(high, low, repr(abs(xy))), minus(low, repr(min(0.0, xy)))
    ends = [end == "pp" for end in words[3 * tilted :]] or [True, True]
    box = np.array([[lx, 0.0, 0.0], [xy, ly, 0.0], [xz, yz, lz]])
    return box, np.array([x0, y0]), (ends[0], ends[1])


def _positions(
    columns: dict[str, NDArray[Any]], box: NDArray[np.float64], origin: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Positions, shape (N, 3) [length]; their columns are taken out."""
    for suffix in _SUFFIXES:
        x, y, z = (axis + suffix for axis in "xyz")
        if x not in columns or y not in columns:
            continue
        place = np.column_stack([columns.pop(x), columns.pop(y)])
        heights = columns.pop(z) if z in columns else np.zeros(len(place))
        if suffix.startswith("s"):
            (lx, _, _), (xy, ly, _), _ = box.tolist()
            f, g = place.T
            place = origin + np.column_stack([lx * f + xy * g, ly * g])
        return np.column_stack([place, heights])
    raise ValueError(f"it has no positions, such as x and y, among its columns {' '.join(columns)}")

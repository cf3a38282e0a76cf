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
    for suffix in _SUFFIXES:
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

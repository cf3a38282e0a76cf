"""LAMMPS dumps, with every digit: MDAnalysis rounds what it reads."""

from __future__ import annotations

import mmap
import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.box import cartesian
from ..particles.columns import (
    Floats,
    Particles,
    as_types,
    axes_of,
    box_of,
    by_ids,
    check_frame,
    columns_of,
    exact_difference,
    exact_sum,
    step_of,
    table_rows,
    tilts_of,
)

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
        f"{low + below!r} {exact_sum(low, side, above)}"
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
    lines += table_rows(ids, species + 1, *axes_of(positions), *columns.values())
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
    columns = by_ids(columns_of(rows, lines[first].split()[2:]), count)
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
    origin = np.array([exact_difference(low, repr(below)) for (low, *_), (below, _) in bounds])
    sides = [exact_difference(high, low, repr(b), repr(-a)) for (low, high, *_), (a, b) in bounds]
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

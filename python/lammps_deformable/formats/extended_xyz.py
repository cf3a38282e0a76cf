"""Extended XYZ: a line with the number of particles, one of `key=value`, and one a particle.

Source: https://github.com/libAtoms/extxyz, the specification.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from .particles import Particles, as_types, columns_of

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

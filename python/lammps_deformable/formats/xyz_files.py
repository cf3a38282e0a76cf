"""Extended XYZ, with every digit.

A line has the number of particles, one `key=value`, and one each particle.

Source: https://github.com/libAtoms/extxyz, the specification.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..particles.columns import (
    Floats,
    Particles,
    as_types,
    axes_of,
    check_frame,
    columns_of,
    step_of,
    table_rows,
)

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
    rows_of = zip(species.tolist(), table_rows(*axes_of(positions), radius), strict=True)
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
    columns = columns_of(rows, names, texts)
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

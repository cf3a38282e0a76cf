"""Particles as columns of a file: what the readers of all formats give, and the writers take."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Context, Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.checks import positive, shown
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


def table_rows(*columns: NDArray[Any]) -> list[str]:
    """Rows of columns of numbers, with every digit."""
    whole = [column.dtype.kind in "iu" for column in columns]
    return core.rows_of(np.column_stack(columns).astype(np.float64), whole).splitlines()


def axes_of(vectors: NDArray[Any]) -> list[NDArray[Any]]:
    """x, y and z of vectors; z = 0 of those of the plane."""
    flat = [np.zeros(len(vectors), int)] * (3 - vectors.shape[1])
    return [*vectors.T, *flat]


def columns_of(
    rows: Sequence[str], names: Sequence[str], texts: Collection[str] = ()
) -> dict[str, NDArray[Any]]:
    """Columns of a table: numbers where its first row has numbers, else words, as for `texts`."""
    if not rows:
        raise ValueError("it has no atoms")
    first = rows[0].split()
    if len(first) < len(names):
        raise ValueError(f"a row has {len(first)} values for the columns {' '.join(names)}")
    numeric = [k for k, name in enumerate(names) if name not in texts and is_number(first[k])]
    values = np.loadtxt(rows, usecols=numeric, ndmin=2).T if numeric else np.empty((0, 0))
    found: dict[int, NDArray[Any]] = dict(zip(numeric, values, strict=True))
    if len(found) < len(names):
        words = list(zip(*(row.split()[: len(names)] for row in rows), strict=True))
        found |= {k: np.array(words[k]) for k in range(len(names)) if k not in found}
    return {name: found[k] for k, name in enumerate(names)}


def is_number(word: str) -> bool:
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


def by_ids(columns: dict[str, NDArray[Any]], count: int) -> dict[str, NDArray[Any]]:
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


def exact_sum(*numbers: float) -> str:
    """The sum with all digits: a file that gives two ends of a box keeps its length to the last."""
    total = Decimal(0)
    for number in numbers:
        total = _EXACT.add(total, Decimal(repr(number)))
    return str(total)


def exact_difference(a: str, *others: str) -> float:
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

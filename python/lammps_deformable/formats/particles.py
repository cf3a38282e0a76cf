"""Particles as a file has them, and what of it makes a packing."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Context, Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.validate import positive, shown

Floats = NDArray[np.float64]

# Heights that differ by less than this part of the width are one plane, and angles of a box by
# less than this are right angles: single precision.
_PLANE = 1e-6

# Names that radii have, where none is given; those of diameters are halved.
RADII = ("radius", "diameter", "radii")

# What is told where types are needed and the file has none.
UNTYPED = "it has no types of particles: give a file that has them"

# Digits of a sum of two numbers of a file: none is lost.
_EXACT = Context(prec=60)


@dataclass(frozen=True)
class Particles:
    """Particles of a file, in the order of their IDs.

    Attributes:
        positions: shape (N, 3) [length].
        box: lattice vectors as rows, shape (3, 3) [length]; None if the file has none.
        origin: lower left corner of the box, shape (3,) [length].
        periodic: whether the box is, along x, y and z.
        ids: as the file has them, shape (N,).
        types: numbers from 1, or names, shape (N,).
        names: of all types; none if these are numbers.
        count: number of types, if the file has it.
        typed: whether the file tells the types; they are 1 if not.
        columns: other values by name, arrays of shape (N,).
    """

    positions: Floats
    box: Floats | None
    ids: NDArray[np.int64]
    types: NDArray[Any]
    columns: Mapping[str, NDArray[Any]]
    origin: Floats = field(default_factory=lambda: np.zeros(3))
    periodic: Sequence[bool] = (True, True, True)
    names: Sequence[str] = ()
    count: int = 0
    typed: bool = True

    def places(self, dimension: int = 2) -> Floats:
        """Positions, shape (N, d) [length].

        Raises:
            ValueError: a number is not finite, or the particles are not in one plane and should be.
        """
        wrong = np.argwhere(~np.isfinite(self.positions))
        if len(wrong) > 0:
            n, axis = wrong[0]
            raise ValueError(f"{'xyz'[axis]} of atom {self.ids[n]} is {self.positions[n, axis]}")
        if dimension == 3:
            return self.positions
        low, high = self.positions.min(axis=0), self.positions.max(axis=0)
        spread = high - low
        if spread[2] > _PLANE * max(spread[0], spread[1]):
            raise ValueError(
                f"its atoms fill space, z goes from {low[2]:.6g} to {high[2]:.6g}, but a packing "
                "in the plane has one z: read it with dimension=3 (in the shell --law droplet), or "
                "write the atoms of one z to a file of their own"
            )
        return self.positions[:, :2]

    def lattice(self, dimension: int = 2) -> Floats:
        """((lx, 0), (xy, ly)), or ((lx, 0, 0), (xy, ly, 0), (xz, yz, lz)), shape (d, d) [length].

        Raises:
            ValueError: there is no box, or another one.
        """
        if self.box is None:
            form = "(lx, ly)" if dimension == 2 else "(lx, ly, lz)"
            raise ValueError(f"it has no box: give one, such as box={form}")
        if dimension == 3:
            return self._space_box(self.box)
        wrong = ~np.isfinite(self.box).all() or (self.box.diagonal()[:2] <= 0.0).any()
        sides = np.abs(self.box).max()
        if wrong or np.abs(self.box[[0, 0, 1, 2, 2], [1, 2, 2, 0, 1]]).max() > _PLANE * sides:
            raise ValueError(
                f"its box is {shown(self.box.tolist())}, but the plane of a packing has lattice "
                "vectors (lx, 0, 0) and (xy, ly, 0), with the third one along z"
            )
        return np.array([[self.box[0, 0], 0.0], self.box[1, :2]])

    @staticmethod
    def _space_box(box: Floats) -> Floats:
        above = np.abs(np.triu(box, 1)).max()
        if not (np.isfinite(box).all() and (box.diagonal() > 0.0).all()) or (
            above > _PLANE * np.abs(box).max()
        ):
            raise ValueError(
                f"its box is {shown(box.tolist())}, but that of a packing has lattice vectors "
                "(lx, 0, 0), (xy, ly, 0) and (xz, yz, lz)"
            )
        return np.tril(box)

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
        """Radius of each particle, shape (N,) [length].

        Args:
            radii: see `Packing.from_file`; checked by `check_radii`.

        Raises:
            ValueError: the file lacks radii, or has one that is not positive.
        """
        if isinstance(radii, Mapping):
            return self._radius_by_type(radii)
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
        wrong = np.flatnonzero(~((values > 0.0) & (values < np.inf)))
        if len(wrong) > 0:
            n = int(wrong[0])
            raise ValueError(
                f"{name} of atom {self.ids[n]} is {values[n]:g}, which is no radius: give radii, "
                "such as radii=0.5"
            )
        return values.astype(np.float64) / (2.0 if name == "diameter" else 1.0)

    def _radius_by_type(self, radii: Mapping[Any, float]) -> Floats:
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


def check_radii(radii: float | str | Mapping[Any, float] | None) -> None:
    """Raise a ParameterError for a radius that is not positive."""
    if isinstance(radii, Mapping) and not radii:
        raise ParameterError("radii by type must have a type, as in {1: 0.5, 2: 0.7}, not {}")
    for name, radius in radii.items() if isinstance(radii, Mapping) else ():
        positive(f"the radius of type {name}", radius)
    if not (radii is None or isinstance(radii, (str, Mapping))):
        positive("radii", radii)


def as_types(words: NDArray[Any]) -> tuple[NDArray[Any], list[str]]:
    """Types as numbers from 1, and no names, if all are whole numbers; else with their names."""
    if words.dtype.kind in "biuf" and np.array_equal(words, np.rint(words)):
        return words.astype(np.int64), []
    texts = words.astype(str)
    names = np.unique(texts).tolist()
    if all(name.isascii() and name.isdigit() and name == str(int(name)) for name in names):
        return texts.astype(np.int64), []
    return texts, names


def by_ids(ids: NDArray[Any]) -> NDArray[np.int64]:
    """The order of the IDs.

    Raises:
        ValueError: two are the same.
    """
    order = np.argsort(ids, kind="stable")
    same = np.flatnonzero(np.diff(ids[order]) == 0)
    if len(same) > 0:
        raise ValueError(f"atom {int(ids[order][same[0]])} occurs twice: write each particle once")
    return order.astype(np.int64)


def columns_of(
    rows: Sequence[str], names: Sequence[str], texts: Collection[str] = ()
) -> dict[str, NDArray[Any]]:
    """Columns of a table: numbers where its first row has numbers, else words.

    Args:
        rows: of the table.
        names: of its columns.
        texts: those of them that hold words, also where these look like numbers.

    Raises:
        ValueError: there are no rows, or one lacks a value, or has a word in place of a number.
    """
    if not rows:
        raise ValueError("it has no atoms")
    first = rows[0].split()
    if len(first) < len(names):
        raise ValueError(f"a row has {len(first)} values for the columns {' '.join(names)}")
    kept = range(len(names))
    numeric = [k for k in kept if names[k] not in texts and is_number(first[k])]
    values = np.loadtxt(rows, usecols=numeric, ndmin=2).T if numeric else np.empty((0, 0))
    found: dict[int, NDArray[Any]] = dict(zip(numeric, values, strict=True))
    if words := [k for k in kept if k not in found]:
        split = [row.split() for row in rows]
        found |= {k: np.array([row[k] for row in split]) for k in words}
    return {names[k]: found[k] for k in kept}


def check_frame(number: int, count: int) -> None:
    """Raise an error if a file of so many frames has none of this number.

    Raises:
        ValueError: it has none.
    """
    if not -count <= number < count:
        known = f"0 to {count - 1}, or -1 to {-count} from the end" if count > 1 else "0"
        raise ValueError(f"it has {count} frames, and no frame {number}: give {known}")


def is_number(word: str) -> bool:
    """Whether a word is one, such as 1e-3 or nan."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def plus(a: float, b: float) -> str:
    """a + b with all digits: a file that gives two ends of a box keeps its length to the last."""
    return str(_EXACT.add(Decimal(repr(a)), Decimal(repr(b))))


def minus(a: str, *others: str) -> float:
    """The difference of numbers of a file, rounded once.

    Raises:
        ValueError: one is no finite number.
    """
    if not all(np.isfinite(float(word)) for word in (a, *others)):
        raise ValueError(f"its box has the bounds {' '.join((*others[:1], a))}")
    left = Decimal(a)
    for word in others:
        left = _EXACT.subtract(left, Decimal(word))
    return float(left)

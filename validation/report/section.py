"""What a section of the page is made of: text, pictures, tables; numbers as text for a reader."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

Row = dict[str, Any]

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def show(value: Any, digits: int = 2) -> str:
    """A value of a row for a reader; a dash for none."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (list, tuple)):
        return ", ".join(show(each, digits) for each in value)
    if not isinstance(value, float):
        return "∞" if value == "inf" else str(value)
    if value == 0.0:
        return "0"
    mantissa, power = f"{abs(value):.{digits - 1}e}".split("e")
    sign = "−" if value < 0.0 else ""
    if -3 <= int(power) < 4:
        places = 0 if value % 1 == 0 else max(digits - 1 - int(power), 0)
        return f"{sign}{abs(value):.{places}f}"
    exponent = f"10{str(int(power)).translate(_SUPERSCRIPTS)}"
    return sign + (exponent if float(mantissa) == 1.0 else f"{mantissa}\u00a0×\u00a0{exponent}")


def span(values: Iterable[float | None], digits: int = 2) -> str:
    """The range of values, e.g. 0.71 to 0.82; a dash if there are none."""
    known = [value for value in values if value is not None]
    if not known:
        return "–"
    low, high = show(min(known), digits), show(max(known), digits)
    return low if low == high else f"{low} to {high}"


def percent(value: float) -> str:
    return f"{100 * value:g} %"


def listed(parts: Iterable[str]) -> str:
    """Parts of a sentence: a, b and c."""
    *first, last = [*parts] or ["none"]
    return f"{', '.join(first)} and {last}" if first else last


@dataclass(frozen=True)
class Picture:
    """A figure of the page: file name, caption, and a description for readers without it."""

    file: str
    caption: str
    alt: str


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        key: of the values in the rows.
        head: its title in words.
        note: meaning, below the table.
        unit: of the values.
        text: align to the left.
        show: a value as text.
    """

    key: str
    head: str
    note: str = ""
    unit: str = ""
    text: bool = False
    show: Callable[[Any], str] = show


@dataclass(frozen=True)
class Table:
    """Rows with the keys of the columns; a folded one opens on a click on its caption."""

    caption: str
    columns: Sequence[Column]
    rows: Sequence[Mapping[str, Any]]
    folded: bool = False


@dataclass(frozen=True)
class Section:
    """A part of the page: paragraphs, terms with meanings, figures, tables.

    Text is plain but for `names` between backticks.
    """

    title: str
    text: Sequence[str] = ()
    terms: Mapping[str, str] = field(default_factory=dict)
    pictures: Sequence[Picture] = ()
    tables: Sequence[Table] = ()


# Columns that several tables share.
STRAIN = Column("strain", "strain", "linear strain beyond jamming", show=percent)
SEED = Column("seed", "packing", "seed of the random start")
LAW = Column("law", "law", text=True)
SHAPE = Column(
    "I", "shape error I", "mean distance of the outline from the polygons over the radius"
)
AREA = Column("S_rms", "area error", "rms error of the area deficits over their rms")
ENERGY = Column("energy_ratio", "energy", "of the law over that of the polygons, at their centers")
PRESSURE = Column(
    "pressure_ratio", "pressure", "of the law over that of the polygons, at their centers"
)
OWN_ENERGY = Column(
    "own_energy_ratio",
    "own energy",
    "of the packing that the law relaxes to itself, over that of the polygons",
)
RESIDUAL = Column(
    "residual", "residual", "largest force on a particle over the mean contact force at the end"
)
SECONDS = Column("seconds", "time", "processor time of the law", "s")


def grouped(rows: Iterable[Row], by: Sequence[str], values: Sequence[str]) -> list[Row]:
    """A row for each combination of the keys `by`, with the ranges of the values as text."""
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(repr([row[key] for key in by]), []).append(row)
    return [
        {key: same[0][key] for key in by}
        | {key: span((row[key] for row in same), 2 + key.endswith("_ratio")) for key in values}
        | {"packings": len({row["seed"] for row in same})}
        for same in groups.values()
    ]


def stiffness(values: Any) -> str:
    """kA or kP of small and large particles; none for laws that have none."""
    return show(values).replace(", ", " | ")


def legend_below(figure: Any, ax: Any) -> None:
    """Name the lines of these axes below the whole figure."""
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=4)

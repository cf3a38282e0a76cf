"""The folder of an ensemble: tables of packings, and a summary of their means and exponents."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ...common.errors import FileError
from ...common.files import write_whole
from ...common.versions import versions
from ...io.run_folder import SUMMARY, TABLE
from .packings import Row, exponents, summarize

SCALING = "scaling.csv"

# These columns identify a packing.
_KEYS = {"law": str, "onset_pressure": float, "number": int, "seed": int}


def key(row: Mapping[str, Any]) -> tuple[Any, ...]:
    """The columns that identify a packing: law, onset pressure, number of particles, seed."""
    return tuple(row[name] for name in _KEYS)


def read_table(path: Path) -> list[Row]:
    """Rows of a table; none if it is missing.

    Raises:
        FileError: it is another table.
    """
    if not path.exists():
        return []
    try:
        with path.open(newline="") as file:
            rows = [
                {name: _KEYS.get(name, _value)(text) for name, text in row.items()}
                for row in csv.DictReader(file)
            ]
        for row in rows:
            key(row)
    except KeyError as error:
        reason = f"it lacks the column {error}"
    except (ValueError, TypeError, AttributeError) as error:
        reason = str(error)
    else:
        return rows
    raise FileError(f"{path} is no table of this command, {reason}: name another folder")


def _value(text: str) -> bool | int | float:
    if text in ("True", "False"):
        return text == "True"
    return int(text) if text.isdecimal() else float(text)


def write_tables(folder: Path, onsets: Sequence[Row], scaling: Sequence[Row]) -> None:
    """Write both tables.

    The compressed packings are written first: a row of an onset means that they are complete.

    Args:
        folder: of the ensemble.
        onsets: a row per packing, see `measure`.
        scaling: rows of compressed packings, see `measure`.
    """
    for name, rows in ((SCALING, scaling), (TABLE, onsets)):
        if rows:
            text = io.StringIO(newline="")
            writer = csv.DictWriter(text, rows[0].keys())
            writer.writeheader()
            writer.writerows(sorted(rows, key=key))
            write_whole(folder / name, text.getvalue())


def write_summary(
    folder: Path, onsets: Sequence[Row], scaling: Sequence[Row], origin: Mapping[str, Any]
) -> None:
    """Write means over the onsets, exponents of the compressed packings, and what was jammed."""
    summary = {
        **origin,
        "onset": [_without_nan(row) for row in summarize(onsets)],
        "exponents": [_without_nan(row) for row in exponents(scaling)],
        "versions": versions(),
    }
    write_whole(folder / SUMMARY, json.dumps(summary, indent=2) + "\n")


def origin_of(folder: Path) -> dict[str, Any]:
    """Options of the packing in a file that was jammed; none of random packings."""
    path = folder / SUMMARY
    summary = json.loads(path.read_text()) if path.exists() else {}
    return {name: value for name, value in summary.items() if name.startswith("from_")}


def _without_nan(row: Row) -> Row:
    """JSON has no nan: the error of a single packing, or an exponent that cannot be fitted."""
    return {name: None if value != value else value for name, value in row.items()}

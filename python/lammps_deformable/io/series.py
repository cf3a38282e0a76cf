"""Tables of states that grow row by row: CSV files that other programs read."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..common.errors import FileError
from ..common.files import write_whole, writing


def rows_in(path: Path) -> list[dict[str, str]]:
    """The rows of a table; none without the file."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def columns_in(path: Path) -> list[str]:
    """The columns that a table began with; none without the file."""
    if not path.exists():
        return []
    with path.open(newline="", errors="replace") as file:
        return next(csv.reader(file), [])


def append_row(path: Path, number: int, numbers: Mapping[str, Any]) -> None:
    """Append a row, which is in the file when this returns; later rows keep the first columns.

    Args:
        path: of the table.
        number: of the frame; 0 begins the table.
        numbers: values by column.
    """
    row = io.StringIO()
    names = (columns_in(path) if number else []) or ["frame", *numbers]
    writer = csv.DictWriter(row, names, extrasaction="ignore")
    if number == 0:
        writer.writeheader()
    writer.writerow({"frame": number} | dict(numbers))
    append(path, row.getvalue())


def keep_rows(path: Path, count: int) -> None:
    """Cut a table after its first rows; without rows it has no columns either."""
    keep(path, count + 1 if count > 0 else 0, r"(?<=\n)")


def refuse_foreign(path: Path) -> None:
    """Raise an error if there is a file that is no table of states."""
    with writing(path):  # names may be too long
        columns = columns_in(path)
    if columns and "phi" not in columns:
        raise FileError(f"{path} is no series of states: take another name")


def append(path: Path, text: str) -> None:
    """Append text to a file."""
    with writing(path), path.open("a", newline="") as file:
        file.write(text)


def keep(path: Path, count: int, boundary: str) -> None:
    """Cut a file after its first parts, which begin at the boundary (a regular expression)."""
    text = path.read_bytes().decode() if path.exists() else ""
    parts = [part for part in re.split(boundary, text) if part]
    if len(parts) > count:
        write_whole(path, "".join(parts[:count]))

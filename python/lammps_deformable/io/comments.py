"""Numbers in comments at the end of a data file: what LAMMPS itself does not save there."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray


def comment_lines(word: str, rows: NDArray[Any] | None, in_a_line: int = 1) -> str:
    """Rows of numbers behind a word, so many in a line; `none` if there are none.

    Args:
        word: with which the lines begin.
        rows: shape (M, columns); no lines at all if not given.
        in_a_line: number of rows in a line.
    """
    if rows is None:
        return ""
    flat = (rows[n : n + in_a_line].ravel().tolist() for n in range(0, len(rows), in_a_line))
    lines = [f"# {word} {' '.join(map(repr, row))}\n" for row in flat]
    return "\n" + ("".join(lines) or f"# {word} none\n")


def rows_in_comments(
    text: str, word: str, columns: int, kind: type[int] | type[float] = float
) -> NDArray[Any] | None:
    """The rows behind a word, shape (M, columns); None if the text has no such comments.

    Raises:
        ValueError: they are damaged.
    """
    lines = re.findall(rf"^# {word} (.+)$", text, re.MULTILINE)
    if not lines:
        return None
    words = [each for line in lines for each in line.split() if each != "none"]
    return np.array(words, np.dtype(kind)).reshape(-1, columns)

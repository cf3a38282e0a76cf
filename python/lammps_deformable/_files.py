"""Files that are written whole or not at all, and errors that name the file.

Also values as JSON, and back with their types. JSON has no infinity: it becomes the word "inf", and
that word becomes {"word": "inf"}.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._checks import expect, shown
from .errors import FileError, ParameterError


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file so that an interruption leaves the old one or the new one, never a part.

    Raises:
        FileError: it cannot be written.
    """
    part = path.with_name(path.name + ".part")
    with writing(path):
        part.write_bytes(content.encode() if isinstance(content, str) else content)
        part.replace(path)


def replaces(mode: object) -> bool:
    """Whether a mode replaces what is there: `w`; `x` refuses to.

    Raises:
        ParameterError: it is another.
    """
    if mode not in ("x", "w"):
        raise ParameterError(f"mode must be 'x' or 'w', not {shown(mode)}")
    return mode == "w"


def refuse_present(path: Path, overwrite: bool) -> None:
    """Raise an error rather than replace a file that nobody has asked to.

    Args:
        path: of the file.
        overwrite: somebody has.

    Raises:
        FileError: there is a file.
    """
    with writing(path):  # names may be too long
        if overwrite or not path.exists():
            return
    raise FileError(f"'{path}' is there already: replace it with mode='w', or give another name")


def make_folder(folder: str | Path) -> Path:
    """The folder, made if it is missing, with the folders that it is in.

    Raises:
        FileError: it cannot be made.
    """
    expect("folder", folder, str, Path)
    with writing(folder):
        Path(folder).mkdir(parents=True, exist_ok=True)
    return Path(folder)


@contextmanager
def writing(path: str | Path) -> Iterator[None]:
    """Let errors of the system name the file or folder that cannot be written."""
    try:
        yield
    except OSError as error:
        raise FileError(f"'{path}' cannot be written: {error.strerror or error}") from None


@contextmanager
def reading(name: str | Path) -> Iterator[None]:
    """Let errors of a damaged file, or of a part of it, name what cannot be read."""
    try:
        yield
    except (ValueError, TypeError, LookupError) as error:
        reason = f"it lacks {error}" if isinstance(error, KeyError) else str(error)
        reason = reason.split(";")[0]  # what follows is advice on NumPy
        raise FileError(f"{name} cannot be read: {reason}") from None


# As Python writes them, and reads them again.
_NUMBERS = ("inf", "-inf", "nan")

_WORD = "word"


def as_json(name: str, value: Any) -> Any:
    """A value for `json.dumps`; `from_json` returns it, with tuples and arrays as lists.

    Raises:
        ParameterError: JSON cannot hold it; the message has this name.
    """
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if isinstance(value, float) and not math.isfinite(value):
        return str(float(value))
    if isinstance(value, str):
        return {_WORD: str(value)} if value in _NUMBERS else str(value)
    if value is None or isinstance(value, (bool, int, float)):
        return value
    if isinstance(value, (list, tuple)):
        return [as_json(name, each) for each in value]
    if isinstance(value, Mapping):
        for key in value:
            expect(f"a name in {name}", key, str)
        found = {key: as_json(f"{name}[{key!r}]", each) for key, each in value.items()}
        return {_WORD: found} if found.keys() == {_WORD} else found
    raise ParameterError(
        f"{name} must be what JSON can hold, numbers, words, and lists and dictionaries of them, "
        f"not {shown(value)}: give its numbers, or str() of it"
    )


def from_json(value: Any) -> Any:
    """The inverse of `as_json`, of what `json.loads` returns.

    Raises:
        TypeError, ValueError: it is damaged.
    """
    if isinstance(value, str):
        return float(value) if value in _NUMBERS else value
    if isinstance(value, list):
        return [from_json(each) for each in value]
    if isinstance(value, dict):
        marked = value[_WORD] if value.keys() == {_WORD} else value
        if isinstance(marked, str):
            return marked
        return {key: from_json(each) for key, each in dict(marked).items()}
    return value


def check_parameters(parameters: object) -> None:
    """Refuse parameters of a run that its summary cannot hold."""
    expect("parameters", parameters, Mapping, type(None))
    as_json("parameters", parameters)


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

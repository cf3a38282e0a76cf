"""Files that are written whole or not at all, and errors that name the file.

Also values as JSON, and back with their types. JSON has no infinity: it becomes the word "inf", and
that word becomes {"word": "inf"}.
"""

from __future__ import annotations

import fcntl
import math
import os
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .checks import expect, shown
from .errors import FileError, ParameterError

if TYPE_CHECKING:
    from mpi4py import MPI


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file so that an interruption leaves the old one or the new one, never a part.

    Raises:
        FileError: it cannot be written.
    """
    with written_whole(path, path.name + ".part") as part:
        part.write_bytes(content.encode() if isinstance(content, str) else content)


@contextmanager
def written_whole(path: Path, name: str | None = None) -> Iterator[Path]:
    """The path of a part beside a file, which becomes the file at the end, and else vanishes.

    Args:
        path: of the file.
        name: of the part, which has the suffix of the file if not given.

    Raises:
        FileError: it cannot be written.
    """
    part = path.with_name(name or f"{path.stem}.part{path.suffix}")
    with writing(path):
        try:
            yield part
            part.replace(path)
        except BaseException:  # such as a full disk
            with suppress(OSError):
                part.unlink()
            raise


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


def at_home(path: str | Path) -> Path:
    """The path, with the home folder in the place of `~`."""
    return Path(os.path.expanduser(path))


def make_folder(folder: str | Path) -> Path:
    """The folder, made if it is missing, with the folders that it is in.

    Raises:
        FileError: it cannot be made.
    """
    expect("folder", folder, str, Path)
    folder = at_home(folder)
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
    return folder


@contextmanager
def writing(path: str | Path) -> Iterator[None]:
    """Let errors of the system name the file or folder that cannot be written."""
    try:
        yield
    except OSError as error:
        raise FileError(f"'{path}' cannot be written: {error.strerror or error}") from None


@contextmanager
def alone_in(folder: Path, comm: MPI.Comm, check: Callable[[], object]) -> Iterator[None]:
    """Let no other process write a run to the folder meanwhile.

    The lock is one of the system on the folder itself: it leaves no file behind, and ends with the
    process, however that ends. Where a file system has no locks nothing is locked.

    Args:
        folder: made if it is missing.
        comm: ranks that write together; rank 0 holds the lock.
        check: called by rank 0 behind the lock; it raises a FileError where another process has
            written since the folder was looked at.

    Raises:
        FileError: another process writes to it, or has done so; on all ranks.
    """
    lock, refused = None, None
    try:
        if comm.rank == 0:
            try:
                lock = _locked(make_folder(folder))
                check()
            except FileError as error:
                refused = str(error)
        refused = comm.bcast(refused)
        if refused is not None:
            raise FileError(refused)
        yield
    finally:
        if lock is not None:
            os.close(lock)


def _locked(folder: Path) -> int:
    """A descriptor of the folder that locks it until it is closed.

    Raises:
        FileError: another one locks it.
    """
    with writing(folder):
        lock = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(lock)
        raise FileError(
            f"the run in '{folder}' is being written, by another process or simulation: wait for "
            "it, or name another folder"
        ) from None
    except OSError:
        pass  # of a file system without locks
    return lock


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

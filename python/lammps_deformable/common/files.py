"""Files that are written whole or not at all, and errors that name the file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import FileError
from .validate import expect


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file so that an interruption leaves the old one or the new one, never a part.

    Raises:
        FileError: it cannot be written.
    """
    part = path.with_name(path.name + ".part")
    with writing(path):
        part.write_bytes(content.encode() if isinstance(content, str) else content)
        part.replace(path)


def refuse_present(path: Path, overwrite: bool, *ways: str) -> None:
    """Raise an error rather than replace a file that nobody has asked to.

    Args:
        path: of the file.
        overwrite: somebody has.
        ways: further ways out to name in the error.

    Raises:
        FileError: there is a file.
    """
    expect("overwrite", overwrite, bool)
    with writing(path):  # names may be too long
        if overwrite or not path.exists():
            return
    ways_out = ", ".join((*ways, "replace it with overwrite=True"))
    raise FileError(f"'{path}' is there already: {ways_out}, or give another name")


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

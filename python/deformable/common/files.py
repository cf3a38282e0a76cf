"""Files that are written whole or not at all."""

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

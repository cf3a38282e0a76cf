"""Lines of output and progress bars, only on rank 0; progress bars only on a terminal."""

from __future__ import annotations

import sys
from multiprocessing import parent_process
from typing import Any

from tqdm import tqdm

from .ranks import independent, world


def progress(description: str, unit: str, total: int | None = None, initial: int = 0) -> tqdm[Any]:
    """A progress bar on stderr, which tqdm hides if stderr is no terminal."""
    hidden = world().rank > 0 or independent() or parent_process() is not None or None
    return tqdm(
        desc=description, unit=unit, total=total, initial=initial, leave=False, disable=hidden
    )


def print_once(line: str) -> None:
    """Print a line once, above any progress bar."""
    if world().rank == 0:
        tqdm.write(line, file=sys.stdout)

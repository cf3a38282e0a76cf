"""Lines of output and progress, only on rank 0: a bar on a terminal, elsewhere a line a minute."""

from __future__ import annotations

import sys
from io import StringIO
from multiprocessing import parent_process
from typing import Any

from tqdm import tqdm

from .ranks import independent, world

# Seconds between lines of progress where there is no terminal.
_LINES = 60.0


class _Lines(tqdm):  # type: ignore[type-arg]
    """Progress as lines of text, for logs."""

    def display(self, msg: str | None = None, pos: int | None = None) -> bool:
        """Print a line; an empty message would clear a bar."""
        if msg is None:
            print(self, file=sys.stderr, flush=True)
        return False

    def set_postfix(self, *values: Any, **named: Any) -> None:
        """Show these values from the next line on, not at once."""
        super().set_postfix(*values, **named | {"refresh": False})


def progress(description: str, unit: str, total: int | None = None, initial: int = 0) -> tqdm[Any]:
    """Progress on stderr: a bar on a terminal, elsewhere a line a minute after the first minute."""
    hidden = world().rank > 0 or independent() or parent_process() is not None
    shared = {"desc": description, "unit": unit, "total": total, "initial": initial}
    if total is None:
        shared["bar_format"] = "{desc}: {n_fmt} {unit}s [{elapsed}{postfix}]"
    if sys.stderr.isatty():
        return tqdm(**shared, leave=False, disable=hidden)
    lines = {"mininterval": _LINES, "delay": _LINES, "miniters": 1}
    # `tqdm.write` refreshes bars on stderr, but a line that is printed stays
    return _Lines(**shared, leave=False, disable=hidden, file=StringIO(), **lines)


def print_once(line: str) -> None:
    """Print a line once, above any progress bar."""
    if world().rank == 0:
        tqdm.write(line, file=sys.stdout)

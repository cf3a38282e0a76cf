"""Lines of output and progress, only on rank 0: a bar on a terminal, elsewhere a line a minute.

Protocols work while their states are asked for; a call that nobody iterates over says so.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from io import StringIO
from multiprocessing import parent_process
from typing import Any, TypeVar

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


T = TypeVar("T")


class Steps(Iterator[T]):
    """The results of steps, each done when it is asked for.

    Args:
        name: of the protocol.
        results: of its steps.
        start: returns the result before the first step, for a record, or None; it is called at
            most once, and before the first step.

    Warns:
        RuntimeWarning: it is thrown away before the first step.
    """

    def __init__(
        self, name: str, results: Iterator[T], start: Callable[[], T | None] | None = None
    ) -> None:
        self._name, self._begun, self._start = name, False, start
        self._results: Any = results  # a generator

    def __next__(self) -> T:
        self._begun = True
        result: T = next(self._results)
        return result

    def start(self) -> T | None:
        """The result before the first step; None if that is over, or if there is none."""
        begun, self._begun = self._begun, True
        return None if begun or self._start is None else self._start()

    def close(self) -> None:
        """End the protocol here."""
        self._begun = True
        self._results.close()

    def __del__(self) -> None:
        if not self._begun:
            warnings.warn(
                f"{self._name} has done nothing: iterate over it, as in `for state in "
                f"{self._name}(...)`, or take list({self._name}(...))",
                RuntimeWarning,
                stacklevel=2,
            )


def waits_for_all(results: Iterable[object]) -> bool:
    """Whether no rank has a result before all of them have asked for it, as in protocols.

    Only then do all find the same files beforehand: else one may have written its result already.
    """
    return isinstance(results, Steps) or world().size == 1


def start_of(results: Iterable[T]) -> Callable[[], T | None]:
    """Returns the result before the first step, always the same; None if they know none."""
    return cache(results.start) if isinstance(results, Steps) else lambda: None

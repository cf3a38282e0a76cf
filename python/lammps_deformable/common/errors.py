"""Errors and warnings; their messages name the bad value and the way out."""

from __future__ import annotations

import sys
import warnings
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

# Modules whose frames stand between those of this package.
_BETWEEN = ("contextlib", "functools")


class DeformableError(Exception):
    """Any error of this package."""


class ParameterError(DeformableError, ValueError):
    """A parameter has a value that cannot work."""


class UndefinedError(ParameterError, AttributeError):
    """An object of this kind has no such attribute, so that `hasattr` says no."""


class FileError(DeformableError, RuntimeError):
    """A folder or file cannot be read."""


class LammpsError(DeformableError, RuntimeError):
    """LAMMPS refused a command; the message is one line of LAMMPS' error.

    It names atoms by their IDs: atom 1 is particle 0.
    """


class CallError(DeformableError, RuntimeError):
    """A simulation is called by two threads at a time, or not by all of its ranks."""


class StalledWarning(UserWarning):
    """A relaxation stopped before it reached its tolerance."""


class UnjammedWarning(UserWarning):
    """A packing is loose: it rearranged and lost its contact forces, or it has been expanded."""


class BeyondModelWarning(UserWarning):
    """Particles are deformed further than their law describes, e.g. past confluence."""


class JumpWarning(UserWarning):
    """Particles move by about half a box from one state to the next, and cannot be followed."""


class AbsentWarning(UserWarning):
    """Particles are in some states and not in others: how many can be followed."""


class OpeningWarning(UserWarning):
    """Contacts are about to open, where derivatives by parameters jump."""


class LackingWarning(UserWarning):
    """A file lacks digits or particles that its state depends on."""


class UnsavedWarning(UserWarning):
    """A saved state lacks walls or excluded pairs that were given to LAMMPS."""


def renamed(old: str, new: str) -> Any:
    """An attribute that is not there any more, and tells its new name."""

    def told(owner: object) -> None:
        kind = type(owner).__name__
        raise UndefinedError(f"{kind}.{old} is {kind}.{new} now")

    return property(told)


# Warnings that are kept from their user: their categories, and those that came. Of each thread, as
# filters of Python are of the whole process.
_collectors: ContextVar[tuple[tuple[tuple[type[Warning], ...], list[Warning]], ...]] = ContextVar(
    "collectors", default=()
)


@contextmanager
def collected(*categories: type[Warning]) -> Iterator[list[Warning]]:
    """Warnings of this package and thread that are given meanwhile, which nobody else sees.

    Args:
        categories: of these warnings; all if not given.
    """
    found: list[Warning] = []
    before = _collectors.set((*_collectors.get(), (categories or (Warning,), found)))
    try:
        yield found
    finally:
        _collectors.reset(before)


def warn(message: str | Warning, category: type[Warning] | None = None) -> None:
    """Give a warning of the line that called this package, as all others are its own.

    Args:
        message: in one line, or a warning that was collected.
        category: of the warning; that of the message if not given.
    """
    given = message if isinstance(message, Warning) else (category or UserWarning)(message)
    for categories, found in reversed(_collectors.get()):
        if isinstance(given, categories):
            found.append(given)
            return
    level, frame = 1, sys._getframe()
    while frame.f_back and _is_own(frame.f_globals.get("__name__")):
        level, frame = level + 1, frame.f_back
    warnings.warn(given, stacklevel=level)


def _is_own(module: object) -> bool:
    name = str(module)  # code of `exec` may have anything
    return name in _BETWEEN or name.partition(".")[0] == __name__.partition(".")[0]

"""Packages that a user may not have: one line says how to get them."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType


def optional(package: str, extra: str) -> ModuleType:
    """Import a package of an optional extra.

    Raises:
        ImportError: it is missing; the message names the extra.
    """
    try:
        return import_module(package)
    except ImportError:
        raise ImportError(
            f"this needs {package}: pip install 'lammps-deformable[{extra}]'"
        ) from None

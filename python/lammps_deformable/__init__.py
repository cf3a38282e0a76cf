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
from typing import Any

import lazy_loader

_load, _, __all__ = lazy_loader.attach_stub(__name__, __file__)
__all__ = [name for name in __all__ if name != "core"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return _load("core").version
    if name == "potentials":
        from pathlib import Path

        from lammps_deformable_plugin import directory

        return Path(directory(), "potentials")
    try:
        return _load(name)
    except AttributeError as error:
        if str(error) != f"No {__name__} attribute {name}":
            raise
    # in Python's words, which then proposes the nearest name
    what = f"module {__name__!r} has no attribute {name!r}"
    raise AttributeError(what, name=name, obj=sys.modules[__name__])


def __dir__() -> list[str]:
    return [*__all__, "__version__", "core", "potentials"]


@atexit.register
def _end() -> None:
    """Tell other ranks that this one ends: they may wait for it."""
    if "mpi4py.MPI" in sys.modules:
        from .common.ranks import end

        end()

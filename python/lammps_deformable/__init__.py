"""Deformable particles of the plane, and droplets in space, with one center each, in LAMMPS.

    import lammps_deformable as ld

    packing = ld.bidisperse(128, radii=(0.5, 0.7), seed=1)
    jammed = ld.jam(packing)
    sim = ld.Simulation(jammed, ld.Ring(kA=1.0))
    for state in ld.compress(sim, strain=0.01, steps=10):
        print(state.phi, state.pressure)
    state.plot()

Names load when first used, so that the import takes no time.
"""

from __future__ import annotations

import atexit
import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from .common.errors import BeyondModelWarning as BeyondModelWarning
    from .common.errors import CallError as CallError
    from .common.errors import FileError as FileError
    from .common.errors import JumpWarning as JumpWarning
    from .common.errors import LammpsError as LammpsError
    from .common.errors import ParameterError as ParameterError
    from .common.errors import StalledWarning as StalledWarning
    from .common.errors import UnjammedWarning as UnjammedWarning
    from .common.errors import UnsavedWarning as UnsavedWarning
    from .common.fits import jackknife as jackknife
    from .common.parallel import parallel_map as parallel_map
    from .comparison import Comparison as Comparison
    from .comparison import compare as compare
    from .engine.disks import Disks as Disks
    from .engine.droplet_simulation import DropletSimulation as DropletSimulation
    from .engine.polygon_simulation import PolygonSimulation as PolygonSimulation
    from .engine.simulation import Simulation as Simulation
    from .engine.spheres import Spheres as Spheres
    from .model.crystal import cubic as cubic
    from .model.crystal import triangular as triangular
    from .model.droplet import Droplet as Droplet
    from .model.friction import Friction as Friction
    from .model.laws import Ring as Ring
    from .model.laws import Sector as Sector
    from .model.packing import Packing as Packing
    from .model.plane_walls import Circle as Circle
    from .model.plane_walls import Disk as Disk
    from .model.plane_walls import Polygon as Polygon
    from .model.plane_walls import Segment as Segment
    from .model.plane_walls import rectangle as rectangle
    from .model.polygon_walls import Walls as Walls
    from .model.polygons import PolygonModel as PolygonModel
    from .model.random_packing import bidisperse as bidisperse
    from .model.random_packing import polydisperse as polydisperse
    from .model.space_walls import Ball as Ball
    from .model.space_walls import Cone as Cone
    from .model.space_walls import Cylinder as Cylinder
    from .model.space_walls import Post as Post
    from .model.space_walls import Sphere as Sphere
    from .model.space_walls import cuboid as cuboid
    from .model.wall_base import Plane as Plane
    from .protocols.compression import compress as compress
    from .protocols.creep import creep as creep
    from .protocols.jamming import jam as jam
    from .protocols.moduli import Modulus as Modulus
    from .protocols.moduli import bulk_modulus as bulk_modulus
    from .protocols.moduli import shear_modulus as shear_modulus
    from .protocols.motion import move as move
    from .protocols.oscillation import DynamicModulus as DynamicModulus
    from .protocols.oscillation import dynamic_modulus as dynamic_modulus
    from .protocols.oscillation import oscillate as oscillate
    from .protocols.polish import polish as polish
    from .protocols.settling import settle as settle
    from .protocols.shear import shear as shear
    from .protocols.starts import push_off as push_off
    from .runs.analysis import export as export
    from .runs.log import log as log
    from .runs.movie import movie as movie
    from .runs.outlined import state_in_file as state_in_file
    from .runs.recording import compress_in as compress_in
    from .runs.recording import record as record
    from .runs.recording import shear_in as shear_in
    from .runs.run import Run as Run
    from .state.disk_state import DiskState as DiskState
    from .state.displacements import unwrapped as unwrapped
    from .state.droplet_state import DropletState as DropletState
    from .state.polygon_state import PolygonState as PolygonState
    from .state.secondary import resolve_secondary as resolve_secondary
    from .state.sphere_state import SphereState as SphereState
    from .state.state import State as State

    __version__: str
    potentials: Path

_HOMES = {
    "PolygonSimulation": "engine.polygon_simulation",
    "PolygonState": "state.polygon_state",
    "PolygonModel": "model.polygons",
    "Ball": "model.space_walls",
    "BeyondModelWarning": "common.errors",
    "CallError": "common.errors",
    "Circle": "model.plane_walls",
    "Comparison": "comparison",
    "Cone": "model.space_walls",
    "Cylinder": "model.space_walls",
    "Disk": "model.plane_walls",
    "DiskState": "state.disk_state",
    "Disks": "engine.disks",
    "Droplet": "model.droplet",
    "DropletSimulation": "engine.droplet_simulation",
    "DropletState": "state.droplet_state",
    "DynamicModulus": "protocols.oscillation",
    "FileError": "common.errors",
    "Friction": "model.friction",
    "JumpWarning": "common.errors",
    "LammpsError": "common.errors",
    "Modulus": "protocols.moduli",
    "Packing": "model.packing",
    "ParameterError": "common.errors",
    "Plane": "model.wall_base",
    "Polygon": "model.plane_walls",
    "Post": "model.space_walls",
    "Ring": "model.laws",
    "Run": "runs.run",
    "Sector": "model.laws",
    "Segment": "model.plane_walls",
    "Simulation": "engine.simulation",
    "Sphere": "model.space_walls",
    "SphereState": "state.sphere_state",
    "Spheres": "engine.spheres",
    "StalledWarning": "common.errors",
    "State": "state.state",
    "UnjammedWarning": "common.errors",
    "UnsavedWarning": "common.errors",
    "Walls": "model.polygon_walls",
    "bidisperse": "model.random_packing",
    "bulk_modulus": "protocols.moduli",
    "compare": "comparison",
    "compress": "protocols.compression",
    "compress_in": "runs.recording",
    "creep": "protocols.creep",
    "cubic": "model.crystal",
    "cuboid": "model.space_walls",
    "dynamic_modulus": "protocols.oscillation",
    "export": "runs.analysis",
    "jackknife": "common.fits",
    "jam": "protocols.jamming",
    "log": "runs.log",
    "move": "protocols.motion",
    "movie": "runs.movie",
    "oscillate": "protocols.oscillation",
    "parallel_map": "common.parallel",
    "polish": "protocols.polish",
    "polydisperse": "model.random_packing",
    "push_off": "protocols.starts",
    "record": "runs.recording",
    "rectangle": "model.plane_walls",
    "resolve_secondary": "state.secondary",
    "settle": "protocols.settling",
    "shear": "protocols.shear",
    "shear_in": "runs.recording",
    "shear_modulus": "protocols.moduli",
    "state_in_file": "runs.outlined",
    "triangular": "model.crystal",
    "unwrapped": "state.displacements",
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
        import_module(".common.ranks", __name__).end()


def __dir__() -> list[str]:
    return [*__all__, "__version__", "core", "potentials"]

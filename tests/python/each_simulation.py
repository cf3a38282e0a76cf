"""A small one of each kind of simulation."""

from collections.abc import Callable
from typing import Any

import lammps_deformable as ld
from lammps_deformable import (
    DeformablePolygon,
    Disks,
    Droplet,
    PolygonSimulation,
    Ring,
    Simulation,
    Spheres,
)

PLANE = ld.bidisperse(4, seed=1).at(0.3)
SPACE = ld.bidisperse(4, dimension=3, seed=1).at(0.2)
MAKERS: dict[str, Callable[[], Any]] = {
    "rings": lambda: Simulation(PLANE, Ring()),
    "droplets": lambda: Simulation(SPACE, Droplet()),
    "disks": lambda: Disks(PLANE),
    "spheres": lambda: Spheres(SPACE),
    "polygons": lambda: PolygonSimulation(PLANE, DeformablePolygon(20, smooth=False)),
}

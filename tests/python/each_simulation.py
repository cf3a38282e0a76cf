"""A small one of each kind of simulation."""

from collections.abc import Callable
from typing import Any

import lammps_deformable as ld
from lammps_deformable import DeformablePolygon, Droplet, Ring, Simulation, SoftContact

PLANE = ld.bidisperse(4, seed=1).at(0.3)
SPACE = ld.bidisperse(4, dimension=3, seed=1).at(0.2)
MAKERS: dict[str, Callable[[], Any]] = {
    "rings": lambda: Simulation(PLANE, Ring()),
    "droplets": lambda: Simulation(SPACE, Droplet()),
    "disks": lambda: Simulation(PLANE, SoftContact()),
    "spheres": lambda: Simulation(SPACE, SoftContact()),
    "polygons": lambda: Simulation(PLANE, DeformablePolygon(20, smooth=False)),
}

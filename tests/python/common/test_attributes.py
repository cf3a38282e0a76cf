"""What an object lacks is no attribute of it, so that `hasattr` answers."""

from collections.abc import Callable

import deformable
import pytest
from deformable import Disks, Droplet, PolygonModel, PolygonSimulation, Ring, Simulation, Spheres
from deformable.engine.lammps import Engine

PLANE = deformable.bidisperse(4, seed=1).at(0.3)
SPACE = deformable.bidisperse(4, dimension=3, seed=1).at(0.2)

MAKERS: dict[str, Callable[[], object]] = {
    "plane": lambda: PLANE,
    "space": lambda: SPACE,
    "rings": lambda: Simulation(PLANE, Ring()),
    "droplets": lambda: Simulation(SPACE, Droplet()),
    "disks": lambda: Disks(PLANE),
    "spheres": lambda: Spheres(SPACE),
    "polygons": lambda: PolygonSimulation(PLANE, PolygonModel(vertices=20)),
}


@pytest.mark.parametrize("name", MAKERS)
def test_hasattr_answers(name: str) -> None:
    made = MAKERS[name]()
    asked = [made]
    if isinstance(made, Engine):
        asked.append(made.state())
    for each in asked:
        for attribute in dir(type(each)):
            hasattr(each, attribute)
    if len(asked) > 1:
        made.close()
        for attribute in dir(type(made)):
            hasattr(made, attribute)
        assert not hasattr(made, "lmp")


def test_a_packing_has_the_room_of_its_dimension() -> None:
    assert (hasattr(PLANE, "area"), hasattr(PLANE, "volume")) == (True, False)
    assert (hasattr(SPACE, "area"), hasattr(SPACE, "volume")) == (False, True)
    assert getattr(SPACE, "outlines", None) is None

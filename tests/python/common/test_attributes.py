"""What an object lacks is no attribute of it, so that `hasattr` answers."""

import pytest
from each_simulation import MAKERS, PLANE, SPACE
from lammps_deformable import Simulation

EACH = {"plane": lambda: PLANE, "space": lambda: SPACE, **MAKERS}


@pytest.mark.parametrize("name", ["plane", "space", "rings", "droplets", "polygons"])
def test_hasattr_answers(name: str) -> None:
    made = EACH[name]()
    asked = [made]
    if isinstance(made, Simulation):
        asked.append(made.state())
    for each in asked:
        for attribute in [name for name in dir(type(each)) if not name.startswith("_")]:
            hasattr(each, attribute)
    if len(asked) > 1:
        made.close()
        for attribute in [name for name in dir(type(made)) if not name.startswith("_")]:
            hasattr(made, attribute)
        assert not hasattr(made, "lmp")

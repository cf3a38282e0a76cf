"""What an object lacks is no attribute of it, so that `hasattr` answers."""

import pytest
from each_simulation import MAKERS, PLANE, SPACE
from lammps_deformable.lammps import Engine

EACH = {"plane": lambda: PLANE, "space": lambda: SPACE, **MAKERS}


@pytest.mark.parametrize("name", EACH)
def test_hasattr_answers(name: str) -> None:
    made = EACH[name]()
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

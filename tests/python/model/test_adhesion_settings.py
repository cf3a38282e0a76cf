"""Adhesion as a setting of laws and walls."""

import math
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.commands import species_file, wall_commands
from lammps_deformable.laws import pair_matrix

DROPLET: dict[str, Any] = {"kA": math.inf, "kP": 0.0, "tension": 1.0, "contact": "curved"}
MATRIX = [[0.3, 0.1], [0.1, 0.0]]


def test_a_number_and_a_matrix() -> None:
    assert ld.Ring(**DROPLET).adhesion == 0.0
    assert not ld.Ring(**DROPLET)._sticks
    assert not ld.Sector()._sticks
    for given in (0.2, np.float32(0.2), MATRIX, np.array(MATRIX)):
        law = ld.Ring(**DROPLET, adhesion=given)
        assert law._sticks
        assert pair_matrix("adhesion", law.adhesion, 2).shape == (2, 2)
        assert eval(repr(law), {"Ring": ld.Ring, "inf": math.inf}) == law
    law = ld.Ring(**DROPLET, adhesion=MATRIX)
    assert law.adhesion == ((0.3, 0.1), (0.1, 0.0))
    assert hash(law) != hash(ld.Ring(**DROPLET))


def test_species_file() -> None:
    """A line for each pair that sticks; those of a number are all pairs."""

    def lines(adhesion: Any) -> list[str]:
        text = species_file(ld.Ring(**DROPLET, adhesion=adhesion), [0.5, 0.7])
        return [line for line in text.splitlines() if line.startswith("adhesion")]

    assert lines(0.0) == []
    assert lines(MATRIX) == ["adhesion s1 s1 0.3", "adhesion s1 s2 0.1"]
    assert lines(0.2) == [f"adhesion {pair} 0.2" for pair in ("s1 s1", "s1 s2", "s2 s2")]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"adhesion": -0.1}, "not -0.1"),
        ({"adhesion": math.nan}, "not nan"),
        ({"adhesion": "much"}, "a number, or a matrix.*'much'"),
        ({"adhesion": [0.1, 0.2]}, "a number, or a matrix"),
        ({"adhesion": [[0.1, 0.2]]}, "a number, or a matrix"),
        ({"adhesion": [[0.1, 0.2], [0.3]]}, "a number, or a matrix"),
        ({"adhesion": [[0.1, 0.2], [0.3, 0.1]]}, "species 0 and 1 have 0.2 and 0.3"),
        ({"adhesion": [[0.1, -0.2], [-0.2, 0.1]]}, "not -0.2"),
        ({"adhesion": MATRIX, "tension": [1.0, 1.0, 1.0]}, "there are 3 species.*not 2"),
        ({"adhesion": 2.0}, "above half of it, 1, not 1.*engulfs"),
        ({"adhesion": MATRIX, "tension": [0.15, 1.0]}, "above half of it, 0.15, not 0.15"),
        ({"adhesion": 0.1, "tension": 0.0, "kP": 1.0}, "without a tension"),
        ({"adhesion": 0.1, "tension": 0.0, "kA": 1.0, "kP": math.inf}, "kP = inf"),
        ({"adhesion": 0.1, "skin": 0.1}, "skin of 0, not 0.1"),
        ({"adhesion": 0.1, "contact": "balanced"}, "contact='curved', not 'balanced'"),
        ({"adhesion": 0.1, "contact": "radical"}, "contact='curved', not 'radical'"),
    ],
)
def test_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ld.ParameterError, match=message) as error:
        ld.Ring(**(DROPLET | change))
    assert "\n" not in str(error.value)


def test_number_of_species() -> None:
    with pytest.raises(ld.ParameterError, match=r"there are 3 species.*not 2"):
        ld.Ring(**DROPLET, adhesion=MATRIX)._species_parameters([0.5, 0.6, 0.7])


WALLS = [
    ld.Plane((0, 0), (1, 0), adhesion=0.3),
    ld.Sphere(5.0, (0, 0), adhesion=0.3),
    ld.Sphere(1.0, (0, 0), inside=False, adhesion=0.3),
    ld.Segment((0, 0), (1, 0), adhesion=0.3),
    ld.PolygonWall(((0, 0), (1, 0), (0, 1)), adhesion=0.3),
]


@pytest.mark.parametrize("wall", WALLS, ids=[wall._kind for wall in WALLS])
def test_walls(wall: Any) -> None:
    """Kept when walls are stretched, and written for LAMMPS."""
    assert wall._stretched(2.0, 2.0).adhesion == 0.3
    assert wall_commands([wall]).splitlines()[0].endswith("adhesion 0.3")
    values = {name: value for name, value in vars(wall).items() if name != "adhesion"}
    assert "adhesion" not in wall_commands([type(wall)(**values)])
    for bad in (-0.3, math.inf, "much"):
        with pytest.raises(ld.ParameterError, match=f"adhesion .*of a {type(wall).__name__}"):
            type(wall)(**values, adhesion=bad)


def test_rectangle() -> None:
    assert [wall.adhesion for wall in ld.BoxWall((2, 1)).parts] == [0.0] * 4
    assert [wall.adhesion for wall in ld.BoxWall((2, 1), adhesion=0.2).parts] == [0.2] * 4


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (ld.Ring(), "plane 1: adhesion needs contact lines that bend"),
        (ld.Sector(), "plane 1: adhesion needs contact lines that bend"),
        (ld.Ring(contact="curved"), "plane 1, species 0: .*kP = inf"),
        (ld.Ring(**(DROPLET | {"tension": [1.0, 0.1]})), "species 1: .*above half"),
    ],
)
def test_particles_that_stick_to_no_wall(law: Any, message: str) -> None:
    packing = ld.Packing(
        np.array([[1.0, 1.0], [3.0, 1.0]]),
        [0.5, 0.7],
        np.diag([4.0, 2.0]),
        species=[0, 1],
        walls=ld.BoxWall((4, 2), adhesion=0.3),
    )
    with pytest.raises(ld.ParameterError, match=message):
        ld.Simulation(packing, law)

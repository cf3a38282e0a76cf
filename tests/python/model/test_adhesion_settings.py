"""Adhesion as a setting of laws and walls."""

import math
from dataclasses import replace
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.particles.commands import wall_commands
from lammps_deformable.particles.laws import pair_matrix
from lammps_deformable.particles.species_file import species_file
from refusals import refused

DROPLET: dict[str, Any] = {"kA": math.inf, "kP": 0.0, "tension": 1.0, "contact": "curved"}
MATRIX = [[0.3, 0.1], [0.1, 0.0]]


def test_a_number_and_a_matrix() -> None:
    assert ld.Ring(**DROPLET).adhesion == 0.0
    assert not ld.Ring(**DROPLET).sticks
    assert not ld.Sector().sticks
    for given in (0.2, np.float32(0.2), MATRIX, np.array(MATRIX)):
        law = ld.Ring(**DROPLET, adhesion=given)
        assert law.sticks
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


def test_refused() -> None:
    for change, message in (
        ({"adhesion": -0.1}, "not -0.1"),
        ({"adhesion": [[0.1, 0.2], [0.3]]}, "a number, or a matrix"),
        ({"adhesion": [[0.1, 0.2], [0.3, 0.1]]}, "species 0 and 1 have 0.2 and 0.3"),
        ({"adhesion": MATRIX, "tension": [1.0, 1.0, 1.0]}, "there are 3 species.*not 2"),
        ({"adhesion": MATRIX, "tension": [0.15, 1.0]}, "above half of it, 0.15, not 0.15"),
        ({"adhesion": 0.1, "tension": 0.0, "kP": 1.0}, "without a tension"),
        ({"adhesion": 0.1, "skin": 0.1}, "skin of 0, not 0.1"),
        ({"adhesion": 0.1, "contact": "radical"}, "contact='curved', not 'radical'"),
    ):
        with refused(message):
            ld.Ring(**(DROPLET | change))


WALLS = [
    ld.Plane((0, 0), (1, 0), adhesion=0.3),
    ld.Sphere(5.0, (0, 0), adhesion=0.3),
    ld.Sphere(1.0, (0, 0), inside=False, adhesion=0.3),
    ld.Segment((0, 0), (1, 0), adhesion=0.3),
    ld.PolygonWall(((0, 0), (1, 0), (0, 1)), adhesion=0.3),
]


def test_walls() -> None:
    """Kept when walls are stretched, and written for LAMMPS."""
    for wall in WALLS:
        assert wall._stretched(2.0, 2.0).adhesion == 0.3
        assert wall_commands([wall]).splitlines()[0].endswith("adhesion 0.3")
        assert "adhesion" not in wall_commands([replace(wall, adhesion=0.0)])
        with pytest.raises(ld.ParameterError, match=f"adhesion .*of a {type(wall).__name__}"):
            replace(wall, adhesion=math.inf)


def test_rectangle() -> None:
    assert [wall.adhesion for wall in ld.BoxWall((2, 1)).parts] == [0.0] * 4
    assert [wall.adhesion for wall in ld.BoxWall((2, 1), adhesion=0.2).parts] == [0.2] * 4


def test_particles_that_stick_to_no_wall() -> None:
    for law, message in (
        (ld.Ring(), "plane 1: adhesion needs contact lines that bend"),
        (ld.Ring(**(DROPLET | {"tension": [1.0, 0.1]})), "species 1: .*above half"),
    ):
        packing = ld.Packing(
            np.array([[1.0, 1.0], [3.0, 1.0]]),
            [0.5, 0.7],
            np.diag([4.0, 2.0]),
            species=[0, 1],
            walls=ld.BoxWall((4, 2), adhesion=0.3),
        )
        with refused(message):
            ld.Simulation(packing, law)
    with refused("adhesion to walls, and soft contacts have none"):
        ld.Simulation(packing, ld.SoftContact())
    with refused("adhesion, whose packings have no pressure at an onset"):
        ld.jam(packing)


def test_walls_with_adhesion_are_kept_while_particles_are_pushed_off() -> None:
    start = ld.bidisperse(8, seed=1).between(ld.BoxWall((8, 7), adhesion=0.3))
    assert start.push_off().walls == start.walls

"""LAMMPS commands and species files of contact laws."""

import math

import lammps_deformable as ld
import numpy as np
from lammps_deformable.particles.commands import pair_style, pair_style_arguments
from lammps_deformable.particles.species_file import species_file


def test_species_file_has_a_line_for_each_species() -> None:
    text = species_file(ld.Ring(kA=2.5), [0.5, 0.7])
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    assert lines == ["s1 0.5 2.5 inf 0.0", "s2 0.7 2.5 inf 0.0"]
    assert "UNITS: lj" in text.splitlines()[0]


def test_species_have_stiffnesses_of_their_own() -> None:
    ring = ld.Ring(kA=[1.0, math.inf], kP=[math.inf, 2.0], skin=0.1)
    text = species_file(ring, [0.5, 0.7])
    assert text.endswith("s1 0.5 1.0 inf 0.1\ns2 0.7 inf 2.0 0.1\n")
    sector = species_file(ld.Sector(kP=3.0), [1.0])
    assert sector.endswith("s1 1.0 inf 3.0 0.0\n")


def test_tension_is_a_keyword() -> None:
    ring = ld.Ring(kA=[math.inf, 1.0], kP=[0.0, 2.0], tension=[1.5, 0.0])
    text = species_file(ring, [0.5, 0.7])
    assert text.endswith("s1 0.5 inf 0.0 0.0 tension 1.5\ns2 0.7 1.0 2.0 0.0\n")


def test_pair_style_has_contact_and_reach() -> None:
    ring = ld.Ring(reach=np.float64(0.4))
    assert pair_style(ring) == "deformable/ring"
    assert pair_style_arguments(ring) == "contact balanced reach 0.4"
    assert pair_style(ld.Sector()) == "deformable/sector"
    assert pair_style_arguments(ld.Sector()) == ""

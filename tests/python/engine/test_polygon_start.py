"""Starts that polygons of beads refuse."""

import lammps_deformable as ld
import numpy as np
import pytest
from naive_polygons import ALONE, LONE_BEADS, pair, square
from refusals import refused

pytestmark = pytest.mark.filterwarnings("error")


def test_walls_are_around_one_particle() -> None:
    for packing, height, message in (
        (pair(2.0), 0.5, "single particle at the origin"),
        (ld.Packing([[0.1, 0.0]], 0.5, 3.0 * np.eye(2)), 0.5, "at the origin"),
        (ld.Packing([[0.0, 0.0]], 0.5, np.eye(2)), 0.5, "wider than the particle"),
        (ALONE, 0.47, r"a wall at 0\.47 cuts through the particle of radius 0\.5"),
    ):
        with refused(message):
            ld.Simulation._within(packing, LONE_BEADS, square(height))


def test_polygons_do_not_start_in_each_other() -> None:
    ld.Simulation(pair(1.4), ld.DeformablePolygon(20, smooth=False)).close()  # by 0.01
    with pytest.raises(
        ld.ParameterError, match=r"particles 0 and 1 overlap by 0\.0808.*at jamming"
    ):
        ld.Simulation(pair(1.3), ld.DeformablePolygon(20, smooth=False))


def test_overlaps_are_found_in_any_cell_of_the_lattice() -> None:
    for shear in (2.0, 42.0, -38.0):  # one lattice
        packing = ld.Packing([[0.0, 0.0], [0.0, 0.65]], 0.5, [[4.0, 0.0], [shear, 1.2]])
        with pytest.raises(ld.ParameterError, match=r"0 and 1 overlap by 0\.35"):
            ld.Simulation(packing, ld.DeformablePolygon(20, smooth=False))


def test_a_ring_does_not_meet_itself() -> None:
    message = r"particle 0 reaches its own image, 0\.98 away.*repeat the packing"
    lone = ld.Packing([[0.0, 0.0]], 0.5, [[0.98, 0.0], [0.0, 2.0]])
    with pytest.raises(ld.ParameterError, match=message):
        ld.Simulation(lone, ld.DeformablePolygon(20, smooth=False))
    with ld.Simulation(pair(1.5), ld.DeformablePolygon(20, smooth=False)) as sim:
        sim.deform(np.diag([0.9, 2.5]))
        with pytest.raises(ld.ParameterError, match=r"reaches its own image, 0\.9 away"):
            sim.relax(0.01)

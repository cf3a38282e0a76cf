"""Two packings side by side: equal sizes, and the distance of their centers."""

from dataclasses import replace

import numpy as np
import pytest
from lammps_deformable import DeformablePolygon, Ring, Simulation, State, bidisperse, jam
from lammps_deformable.reference.comparison import centers_rms, matching, standard_polygons


@pytest.fixture(scope="module")
def pair() -> tuple[State, State]:
    """Rings, and particles of the ring law, both strained by 6 %."""
    start = jam(bidisperse(8, seed=1)).packing
    states = []
    for packing in (
        Simulation(start, DeformablePolygon(25, smooth=False)),
        Simulation(start, Ring()),
    ):
        with packing as sim:
            sim.deform(0.94 * start.box)
            states.append(sim.relax())
    exact, own = states
    return exact, own


def moved(exact: State, step: np.ndarray) -> State:
    return replace(exact, packing=exact.packing.replace(positions=exact.packing.positions + step))


def test_distance_of_centers(pair):
    """Neither drift nor periodic images nor rattlers count; a particle that moves does."""
    exact, own = pair
    same = replace(exact, packing=exact.packing.replace(positions=own.packing.positions))
    touching = np.bincount(np.concatenate([exact.contacts["i"], exact.contacts["j"]]), minlength=8)
    held = np.flatnonzero((touching >= 3) & ~own.rattlers)
    assert len(held) >= 3
    assert centers_rms(same, own) == pytest.approx(0.0, abs=1e-15)
    images = np.random.default_rng(1).integers(-2, 3, (8, 2)) @ own.packing.box
    drifted = moved(same, images + np.array([0.3, -2.0]))
    assert centers_rms(drifted, own) == pytest.approx(0.0, abs=1e-14)
    step = np.zeros((8, 2))
    step[held[-1]] = 0.03, 0.04
    share = 1.0 / len(held)
    expected = 0.05 * np.sqrt(share * (1.0 - share)) / own.packing.radii.mean()
    assert centers_rms(moved(drifted, step), own) == pytest.approx(expected)


def test_rattlers_do_not_count(pair):
    exact, own = pair
    loose = exact.contacts["i"][0]
    there = (exact.contacts["i"] != loose) & (exact.contacts["j"] != loose)
    contacts = exact.contacts
    exact = replace(exact, _table=contacts[there])
    step = np.zeros((8, 2))
    step[loose] = 0.1
    assert centers_rms(exact, own) == centers_rms(moved(exact, step), own)
    assert centers_rms(replace(exact, _table=contacts[:0]), own) is None
    assert centers_rms(exact, replace(own, pressure_tensor=1e-7 * own.pressure_tensor)) is None


@pytest.mark.parametrize("smooth", [True, False])
def test_matching_rings_have_the_same_effective_radii(smooth):
    packing = bidisperse(4, seed=1)
    for number in (40, 100):
        model = standard_polygons(number, smooth=smooth)
        polygons = model.polygons(matching(packing, model).species_radii)
        # ten steps leave the rounding of sums of a few terms
        np.testing.assert_allclose(polygons.effective_radius, packing.species_radii, rtol=1e-14)

"""Particles that come and go are followed by their labels."""

from dataclasses import replace

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.state.labels import divided, remaining
from refusals import refused

GONE, MOTHER = 7, 3


@pytest.fixture(scope="module")
def states() -> tuple[ld.State, ld.State, ld.State]:
    """A crystal; moved, with all; and the same without one particle, and with one divided."""
    packing = ld.crystal("hex", (4, 3), phi=0.85)
    with ld.Simulation(packing, ld.Ring()) as sim:
        before = sim.state()
    rng = np.random.default_rng(4)
    moved = packing.positions + 0.05 * rng.normal(size=packing.positions.shape)
    images = np.zeros(moved.shape, np.int64)
    before = replace(before, images=images, time=0.0)
    whole = replace(before, packing=packing.replace(positions=moved), time=1.0)
    two = divided(whole, np.array([MOTHER]), np.array([[1.0, 0.0]]), np.array([0.5]), 100)
    left = np.arange(len(two.packing)) != GONE
    return before, whole, remaining(two, left)


def test_displacements(states: tuple[ld.State, ld.State, ld.State]) -> None:
    before, whole, now = states
    with pytest.warns(ld.AbsentWarning, match="23 particles are followed, .* of 24 before and 24"):
        found = now.displacements(before)
    assert found.shape == now.packing.positions.shape
    expected = np.delete(whole.displacements(before), GONE, axis=0)
    same = np.arange(len(expected)) != MOTHER
    np.testing.assert_allclose(found[:-1][same], expected[same], rtol=0, atol=1e-14)
    assert np.isnan(found[-1]).all()
    np.testing.assert_array_equal(now.displacements(now), 0.0)


def test_a_state_in_another_order(states: tuple[ld.State, ld.State, ld.State]) -> None:
    before, whole, _ = states
    order = np.random.default_rng(1).permutation(len(whole.packing))
    packing = whole.packing
    mixed = replace(
        whole,
        packing=packing.replace(
            positions=packing.positions[order], radii=packing.radii[order],
            species=packing.species[order],
        ),
        labels=order,
    )  # fmt: skip
    expected = whole.local_strain(before)
    found = mixed.local_strain(before)
    np.testing.assert_allclose(found.gradient, expected.gradient[order], rtol=1e-12, atol=1e-14)
    np.testing.assert_array_equal(found.neighbors, expected.neighbors[order])


@pytest.mark.filterwarnings("ignore::lammps_deformable.AbsentWarning")
def test_local_strain(states: tuple[ld.State, ld.State, ld.State]) -> None:
    """That of particles far from those that came and went is the same."""
    before, whole, now = states
    expected, found = whole.local_strain(before), now.local_strain(before)
    full = np.delete(expected.neighbors, GONE) == found.neighbors[:-1]
    mother = whole.packing.positions[MOTHER]
    near = np.linalg.norm(now.packing.positions[:-1] - mother, axis=1) < 1e-9
    assert np.isnan(found.d2min[-1])
    assert found.neighbors[-1] == 0
    assert np.isnan(found.gradient[-1]).all()
    assert np.isfinite(found.d2min[:-1]).all()
    assert 0 < full.sum() < len(full)
    assert not near.any()
    assert found.neighbors[:-1].sum() == expected.neighbors.sum() - 2 * expected.neighbors[GONE]


@pytest.mark.filterwarnings("ignore::lammps_deformable.AbsentWarning")
def test_msd(states: tuple[ld.State, ld.State, ld.State]) -> None:
    before, whole, now = states
    run = ld.Run([before, whole, replace(now, time=2.0)])
    with pytest.warns(ld.AbsentWarning, match="23 of 25 particles are in all states"):
        places = run.unwrapped()
    assert places.shape == (3, 25, 2)
    assert np.isnan(places[2, GONE]).all()
    assert np.isnan(places[:2, 24]).all()
    times, msd = run.msd([1, 2])
    np.testing.assert_array_equal(times, [1.0, 2.0])
    first = np.sum((places[1] - places[0]) ** 2, axis=1)[:24]
    then = np.sum((places[2] - places[1]) ** 2, axis=1)
    then = then[np.isfinite(then)]
    assert len(then) == 23
    assert msd[0] == pytest.approx(np.append(first, then).mean())


def test_a_tissue() -> None:
    """Cells of a dish: a record by labels, through divisions and deaths."""
    dish = ld.Packing([[4.0, 4.0]], 0.5, (8.0, 8.0)).between(ld.Sphere(3.0, (4.0, 4.0)))
    with ld.Simulation(dish, ld.Ring(kA=20.0, kP=2.0, tension=1.0)) as sim:
        run = sim.proliferate(1.0, division=1.2, time=3.0, steps=3, death=0.2, seed=3)
    assert len(run[-1].packing) > 2
    with pytest.warns(ld.AbsentWarning, match="particles are in all states"):
        _, msd = run.msd([0, 1])
    assert msd[0] == 0.0
    assert msd[1] > 0.0


def test_refused(states: tuple[ld.State, ld.State, ld.State]) -> None:
    before, _, now = states
    with refused("a Packing does not tell which it has: give the state before"):
        now.displacements(before.packing)
    fewer = ld.crystal("hex", (2, 2), phi=0.85)
    with refused("before has 8 particles and this state 24: particles without labels"):
        before.displacements(fewer)

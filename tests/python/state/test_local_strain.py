"""D^2_min and local strain against a loop, and in a homogeneous strain."""

import lammps_deformable as ld
import numpy as np
import pytest


def fit(old: np.ndarray, new: np.ndarray) -> tuple[np.ndarray, float]:
    """Gradient and D^2_min of vectors by least squares."""
    solution, *_ = np.linalg.lstsq(old, new, rcond=None)
    return solution.T - np.eye(2), float(np.sum((new - old @ solution) ** 2))


def test_as_a_loop(state: ld.State) -> None:
    before = state
    with ld.Simulation(before, before.law) as sim:
        now = sim.shear(0.08, steps=2, tolerance=1e-3)[-1]
    found = now.local_strain(before)
    gradient, d2min, neighbors = found
    reach = 3.0 * before.packing.radii.mean()
    old, new = before.packing, now.packing
    places = old.positions + now.displacements(before)
    for n in range(len(old)):
        rows = []
        for m in range(len(old)):
            for a in range(-2, 3):
                for b in range(-2, 3):
                    v = old.positions[m] + (a, b) @ old.box - old.positions[n]
                    w = places[m] + (a, b) @ new.box - places[n]
                    if 0.0 < np.hypot(*v) < reach:
                        rows.append((v, w))
        expected, left = fit(*np.array(rows).swapaxes(0, 1))
        assert neighbors[n] == len(rows)
        assert gradient[n] == pytest.approx(expected, abs=1e-10)
        assert d2min[n] == pytest.approx(left, rel=1e-8)
    assert d2min.max() > 1e-3
    assert np.array_equal(found.strain, (gradient + gradient.transpose(0, 2, 1)) / 2.0)


def test_a_rotation_is_no_strain_and_leaves_nothing() -> None:
    walls = ld.Sphere(8.0, (0.0, 0.0))
    packing = ld.bidisperse(40, seed=1).between(walls)
    angle = 0.3
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    with ld.Simulation(
        packing.replace(positions=packing.positions @ turn.T), ld.SoftContact()
    ) as disks:
        found = disks.state().local_strain(packing, r_max=6.0)
    assert found.gradient == pytest.approx(np.broadcast_to(turn - np.eye(2), (40, 2, 2)), abs=1e-11)
    assert found.d2min.max() < 1e-22


def test_too_few_neighbors_tell_no_strain() -> None:
    places = [[1.0, 1.0], [2.0, 1.0], [3.0, 1.0], [5.0, 1.0]]
    row = ld.Packing(places, 0.5, np.diag([9.0, 9.0]))
    with ld.Simulation(row, ld.SoftContact()) as disks:
        found = disks.state().local_strain(row, r_max=1.5)
    assert found.neighbors.tolist() == [1, 2, 1, 0]
    assert np.isnan(found.gradient).all()
    assert np.isnan(found.d2min).all()

"""S(k) against a sum over pairs of particles, the peaks of a lattice, and density waves."""

import lammps_deformable as ld
import numpy as np
import pytest
from crystal import crystal


def state_of(packing: ld.Packing) -> ld.State:
    with ld.Simulation(packing, ld.SoftContact()) as disks:
        return disks.state()


def test_as_a_sum_over_pairs() -> None:
    packing = ld.bidisperse(10, phi=0.5, aspect=1.5, tilt=-1.3, seed=4)
    k, s = state_of(packing).structure_factor(k_max=6.0, bins=12)
    waves = 2.0 * np.pi * np.linalg.inv(packing.box).T  # rows, a_i b_j = 2 pi delta_ij
    found: list[list[float]] = [[] for _ in range(12)]
    apart = packing.positions[:, None] - packing.positions
    for h in range(-40, 41):
        for m in range(-40, 41):
            wave = h * waves[0] + m * waves[1]
            length = float(np.hypot(*wave))
            if 0.0 < length < 6.0:
                found[int(length / 0.5)].append(float(np.cos(apart @ wave).sum()) / 10)
    assert k == pytest.approx(0.25 + 0.5 * np.arange(12))
    for each, values in zip(s, found, strict=True):
        assert each == pytest.approx(np.mean(values) if values else np.nan, nan_ok=True)


def test_refusals() -> None:
    state = state_of(ld.bidisperse(10, seed=1))
    for k_max, bins, told in (
        (0.0, 100, "k_max"),
        (5.0, 0, "bins"),
        ("far", 100, "k_max"),
        (1e12, 9, "smaller"),
    ):
        with pytest.raises(ld.ParameterError, match=told):
            state.structure_factor(bins, k_max)
    walls = ld.BoxWall((8.0, 8.0)).parts
    for each in (walls, walls[:2]):
        walled = state_of(ld.bidisperse(10, seed=1).between(each))
        with pytest.raises(ld.ParameterError, match="needs a periodic box"):
            walled.structure_factor(bins=100, k_max=5.0)
    post = ld.Sphere(0.5, (3.0, 3.0), inside=False)
    around = state_of(ld.bidisperse(20, phi=0.2, seed=1).between(post))
    assert np.isfinite(around.structure_factor(k_max=5.0, bins=2)[1]).all()


def test_density_waves_are_those_of_the_structure_factor() -> None:
    packing = ld.bidisperse(10, phi=0.5, aspect=1.5, tilt=-1.3, seed=4)
    state = state_of(packing)
    wave = 2.0 * np.pi * np.linalg.inv(packing.box)[:, 1]  # a row of the reciprocal lattice
    length = float(np.hypot(*wave))
    (_, s) = state.structure_factor(k_max=1.0001 * length, bins=20_000)
    rho = state.density_waves([wave, -wave, 0.0 * wave])
    assert 10.0 * abs(rho[0]) ** 2 == pytest.approx(s[-2:][~np.isnan(s[-2:])].max())
    assert rho[1] == pytest.approx(rho[0].conjugate())
    assert rho[2] == pytest.approx(1.0 + 0.0j)


def test_density_waves_of_a_lattice() -> None:
    """1 at its reciprocal lattice, with the phase of where it lies, and 0 elsewhere."""
    lattice = crystal(0.01, 8, 8)
    moved = lattice.replace(positions=lattice.positions + np.array([0.1, 0.2]))
    side = 4.0 * np.pi / (np.sqrt(3.0) * 0.99)
    peaks = side * np.array([[0.0, 1.0], [np.sqrt(0.75), 0.5]])
    rho = state_of(moved).density_waves(peaks)
    assert rho == pytest.approx(np.exp(1j * peaks @ [0.1, 0.2]), abs=1e-12)
    beside = peaks + np.array([2.0 * np.pi / lattice.box[0, 0], 0.0])
    assert np.abs(state_of(moved).density_waves(beside)).max() < 1e-12


def test_waves_that_do_not_fit_are_refused() -> None:
    state = state_of(ld.bidisperse(10, seed=1))
    with pytest.raises(ld.ParameterError, match="is no wave vector of the box") as error:
        state.density_waves([[1.0, 0.3]])
    nearest = eval(str(error.value).split("nearest one is ")[1])
    assert state.density_waves([nearest]).shape == (1,)
    for wrong in ([1.0, 0.0], np.zeros((2, 3)), "x", [[np.nan, 0.0]]):
        with pytest.raises(ld.ParameterError, match="k must"):
            state.density_waves(wrong)
    walled = state_of(ld.bidisperse(10, seed=1).between(ld.BoxWall((8.0, 8.0))))
    with pytest.raises(ld.ParameterError, match="needs a periodic box"):
        walled.density_waves([[0.0, 0.0]])


def test_a_run_has_the_mean_of_its_states() -> None:
    with ld.Simulation(ld.crystal("sc", 3, phi=0.4), ld.SoftContact()) as sim:
        run = sim.compress(strain=0.1, steps=2)
    k, s = run.structure_factor(bins=8, k_max=8.0)
    each = np.array([state.structure_factor(bins=8, k_max=8.0)[1] for state in run])
    some = ~np.isnan(each)  # the smaller box has other waves
    assert 0 < some.sum() < some.size
    for mean, values, found in zip(s, each.T, some.T, strict=True):
        assert mean == pytest.approx(values[found].mean() if found.any() else np.nan, nan_ok=True)
    assert k == pytest.approx(0.5 + np.arange(8))
    r, g = run.radial_distribution(bins=5, r_max=1.0)
    assert r == pytest.approx(0.1 + 0.2 * np.arange(5))
    assert g == pytest.approx(np.mean([state.radial_distribution(5, 1.0)[1] for state in run], 0))
    with pytest.raises(ld.ParameterError, match="no states"):
        run[:0].structure_factor(bins=8, k_max=8.0)

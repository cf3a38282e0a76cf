"""g(r) by freud, with the density of the room that centers have, and g_6(r)."""

import lammps_deformable as ld
import numpy as np
import pytest

pytest.importorskip("freud")


@pytest.mark.parametrize(
    "walls",
    [(), (ld.Sphere(6.0, (6.0, 6.0)),), ld.BoxWall((10, 12)).parts[2:]],
    ids=["periodic", "circle", "channel"],
)
def test_points_at_random_places(walls: tuple) -> None:
    """g = 1 at all distances, to the noise of the number of pairs."""
    number = 3000
    places = ld.Packing(
        np.random.default_rng(1).random((number, 2)) * [12.0, 12.0], 1e-3, np.diag([12.0, 12.0])
    )
    if walls:
        places = places.between(walls, seed=1)
    with ld.Simulation(places, ld.Ring()) as sim:
        r, g = sim.state().radial_distribution(r_max=4.5, bins=15)
    pairs = number**2 / 2.0 * 2.0 * np.pi * r * 0.3 / places.volume
    # 1 % for the room around the places, by random directions
    assert np.abs(g - 1.0).max() < 5.0 / np.sqrt(pairs.min()) + 0.01


def state_of(packing: ld.Packing) -> ld.State:
    with ld.Simulation(packing, ld.SoftContact()) as disks:
        return disks.state()


@pytest.mark.parametrize(
    ("walls", "k"), [((), 6), (ld.BoxWall((6.0, 7.0)), 4)], ids=["periodic", "walls"]
)
def test_hexatic_correlation_as_a_sum_over_pairs(walls: tuple, k: int) -> None:
    packing = ld.bidisperse(40, phi=0.8, tilt=0.0 if walls else 0.4, seed=3)
    state = state_of((packing.between(walls) if walls else packing).push_off())
    r, g = state.hexatic_correlation(r_max=2.3, bins=10, k=k)
    psi, box = state.hexatic(k), state.packing.box
    apart = (state.packing.positions[:, None] - state.packing.positions) @ np.linalg.inv(box)
    distance = np.linalg.norm((apart - (0.0 if walls else np.rint(apart))) @ box, axis=-1)
    assert r == pytest.approx(0.115 + 0.23 * np.arange(10), rel=1e-5)  # freud's single precision
    for low, each in zip(0.23 * np.arange(10), g, strict=True):
        i, j = np.nonzero((distance > low) & (distance < low + 0.23) & ~np.eye(40, dtype=bool))
        expected = np.mean((psi[i].conj() * psi[j]).real) if len(i) else np.nan
        assert each == pytest.approx(expected, abs=1e-6, nan_ok=True)
    assert np.isnan(g[0])


def test_refusals() -> None:
    state = state_of(ld.bidisperse(10, seed=1))
    told = ((9, 0.0, {}, "r_max"), (0, 5.0, {}, "bins"), (9, 1.0, {"k": 0}, "k must"))
    for bins, r_max, named, message in (*told, (9, 99.0, {}, "too large")):
        with pytest.raises(ld.ParameterError, match=message):
            state.hexatic_correlation(bins, r_max, **named)
    leaning = ld.bidisperse(10, aspect=1.5, tilt=0.4, seed=1)
    (lx, _), (xy, ly) = leaning.box
    most = min(ly, lx * ly / np.hypot(xy, ly)) / 2.0
    with pytest.raises(ld.ParameterError, match=f"r_max = 99 .* below {most:.4g}, half"):
        state_of(leaning).radial_distribution(bins=100, r_max=99.0)
    assert len(state_of(leaning).radial_distribution(bins=100, r_max=0.999 * most)[0])

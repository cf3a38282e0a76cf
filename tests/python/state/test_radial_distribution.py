"""g(r) by freud, with the density of the room that centers have."""

import deformable
import numpy as np
import pytest

pytest.importorskip("freud")


@pytest.mark.parametrize(
    "walls",
    [
        (),
        deformable.rectangle(10, 12),
        (deformable.Circle((6.0, 6.0), 6.0),),
        deformable.rectangle(10, 12)[2:],
        (deformable.Disk((5.0, 6.0), 2.0),),
    ],
    ids=["periodic", "rectangle", "circle", "channel", "obstacle"],
)
def test_points_at_random_places(walls: tuple) -> None:
    """g = 1 at all distances, to the noise of the number of pairs."""
    number = 3000
    places = deformable.Packing(
        np.random.default_rng(1).random((number, 2)) * [12.0, 12.0],
        np.zeros(number, dtype=int),
        np.array([1e-3]),
        np.diag([12.0, 12.0]),
    )
    if walls:
        places = places.between(walls, seed=1)
    with deformable.Simulation(places, deformable.Ring()) as sim:
        r, g = sim.state().radial_distribution(4.5, bins=15)
    pairs = number**2 / 2.0 * 2.0 * np.pi * r * 0.3 / places.area
    # 1 % for the room around the places, by random directions
    assert np.abs(g - 1.0).max() < 5.0 / np.sqrt(pairs.min()) + 0.01

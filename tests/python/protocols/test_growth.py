"""Radii that grow to the onset of jamming, in a box or between walls that stay."""

import lammps_deformable as ld
import numpy as np
import pytest

STARTS = {
    "box": ld.bidisperse(24, tilt=0.2, seed=3),
    "own radii": ld.polydisperse(20, lambda rng, n: rng.uniform(0.4, 0.6, 20), seed=2),
    "obstacle": ld.bidisperse(24, seed=2).between(ld.Sphere(1.0, (5.0, 4.0), inside=False)),
}


@pytest.mark.parametrize("start", STARTS.values(), ids=STARTS.keys())
def test_disks_are_those_of_the_shrinking_box(start: ld.Packing) -> None:
    grown, shrunk = ld.jam(start, grow=True).packing, ld.jam(start).packing
    np.testing.assert_array_equal(grown.box, start.box)
    assert grown.walls == start.walls
    scale = start.box[1, 1] / shrunk.box[1, 1]
    assert scale > 1.0
    # area of the container and obstacles by polygons, at two scales
    assert grown.phi == pytest.approx(shrunk.phi, rel=1e-12)
    np.testing.assert_allclose(grown.radii, scale * shrunk.radii, rtol=1e-12)
    np.testing.assert_allclose(grown.positions, scale * shrunk.positions, rtol=1e-12)
    with ld.Simulation(grown, ld.SoftContact()) as disks:
        assert 1e-6 < disks.state().pressure < 2e-6


def test_particles_grow_to_their_onset() -> None:
    """The pressure is that of the grown packing; kA/kP has a length."""
    start, law = ld.bidisperse(16, seed=4), ld.Ring(kA=1.0, kP=0.5)
    grown = ld.jam(start, law, pressure=1e-10, grow=True).packing
    np.testing.assert_array_equal(grown.box, start.box)
    assert grown.radii.max() / grown.radii.min() == pytest.approx(1.4, rel=1e-12)
    with ld.Simulation(grown, law) as sim:
        assert 1e-10 < sim.state().pressure < 2e-10


def test_a_box_that_stays_has_no_free_shape() -> None:
    with pytest.raises(ld.ParameterError, match="grow=True keeps the box, and free='tri'"):
        ld.jam(STARTS["box"], free="tri", grow=True)

"""Packings in three dimensions: volume, crystals, and what is for the plane only."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import Packing
from lammps_deformable.common.box import cartesian, fractional, nearest_image, widths
from refusals import refused
from scipy import stats

BOX = np.array([[3.0, 0.0, 0.0], [-1.2, 2.5, 0.0], [0.7, -0.4, 2.0]])
SPHERES = ld.bidisperse(8, sizes=(0.5, 0.7), phi=0.4, dimension=3, seed=1)


def test_a_tilted_box() -> None:
    fractions = np.random.default_rng(1).normal(size=(4, 5, 3))
    assert cartesian(fractions, BOX) == pytest.approx(fractions @ BOX, rel=1e-13, abs=1e-13)
    assert fractional(cartesian(fractions, BOX), BOX) == pytest.approx(fractions, rel=1e-13)
    assert widths(BOX) == pytest.approx(1.0 / np.linalg.norm(np.linalg.inv(BOX), axis=0))
    flat = np.array([[3.0, 0.0], [-1.2, 2.5]])
    assert cartesian(np.array([1, -1]), flat).tolist() == [4.2, -2.5]
    near = 0.49 * np.random.default_rng(2).uniform(-1.0, 1.0, (9, 3)) * BOX.diagonal()
    cells = np.random.default_rng(3).integers(-3, 4, (9, 3))
    assert nearest_image(near + cells @ BOX, BOX, (False,) * 3) == pytest.approx(near, abs=1e-12)


def test_phi_is_that_of_spheres() -> None:
    volume = np.sum(4.0 / 3.0 * np.pi * SPHERES.radii**3)
    assert SPHERES.phi == pytest.approx(0.4)
    assert SPHERES.phi * SPHERES.volume == pytest.approx(volume)
    assert SPHERES.at(0.6).volume == pytest.approx(volume / 0.6)
    assert SPHERES.at(0.6, grow=True).phi == pytest.approx(0.6)
    assert SPHERES.box == pytest.approx(np.cbrt(SPHERES.volume) * np.eye(3))
    high = ld.bidisperse(8, phi=0.4, dimension=3, aspect=2.0, tilt=0.5, seed=1)
    lx, ly, lz = high.box.diagonal()
    assert (ly / lx, lz / lx, high.box[1, 0] / ly) == pytest.approx((1.0, 2.0, 0.5))
    assert high.volume == pytest.approx(lx * ly * lz)
    drawn = ld.polydisperse(9, stats.lognorm(0.2, scale=0.5), phi=0.5, dimension=3, seed=1)
    assert drawn.phi == pytest.approx(0.5)
    assert drawn.positions.shape == (9, 3)


def test_refusals() -> None:
    for make, told in (
        (lambda: SPHERES.outlines, "outlines is for packings in the plane"),
        (
            lambda: SPHERES.between(ld.Sphere(9, (0, 0))),
            r"wall 1, Sphere.* in 2 dimensions, .* give its points as \(x, y, z\)",
        ),
        (lambda: ld.polydisperse(1, [1.0], dimension="3D", seed=1), "dimension must be a whole"),
        (lambda: Packing(np.zeros((2, 3)), 1, (1, 1)), "3 columns, so .* not 2"),
        (lambda: Packing([[0, 0, 0]], 1, BOX + np.triu(np.ones((3, 3)), 1)), "box must be"),
        (
            lambda: Packing([[0, 0, 0]], 1, [[1, 0, 0], [0, 1, 0], [40, 0, 1]]),
            "tilted by at most 30 .* xz = 0 has the same images",
        ),
        (lambda: ld.Simulation(SPHERES, ld.Ring()), "law Ring is .* `Droplet`"),
        (
            lambda: ld.Simulation(SPHERES, ld.DeformablePolygon(50, smooth=False)),
            "a polygon is for packings in the plane",
        ),
    ):
        with refused(told):
            make()

"""Positions and fractions of lattice vectors."""

import numpy as np
import pytest
from lammps_deformable.box import cartesian, fractional

BOX = np.array([[3.0, 0.0], [-1.2, 2.5]])


def test_positions_are_a_product_with_the_box() -> None:
    fractions = np.random.default_rng(1).normal(size=(4, 5, 2))
    assert cartesian(fractions, BOX) == pytest.approx(fractions @ BOX, rel=1e-14, abs=1e-14)
    assert fractional(cartesian(fractions, BOX), BOX) == pytest.approx(fractions, rel=1e-14)


def test_one_vector() -> None:
    assert cartesian(np.array([1, -1]), BOX).tolist() == [4.2, -2.5]

"""Fits of power laws."""

import pytest
from deformable.common.fits import power_law


def test_exponent_of_a_power_law() -> None:
    x = [0.1, 0.3, 2.0, 5.0]
    assert power_law(x, [-4.0 * value**-1.5 for value in x]) == pytest.approx(-1.5, rel=1e-14)


def test_least_squares() -> None:
    """Points at log x = -1, 0, 1 and log y = 1, 0, 2: the slope is (2 - 1)/2."""
    e = 2.718281828459045
    assert power_law([1 / e, 1.0, e], [e, 1.0, e * e]) == pytest.approx(0.5, rel=1e-14)

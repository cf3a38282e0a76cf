"""Fits of power laws, and errors by leaving out samples."""

from collections.abc import Sequence

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.parallel import power_law


def test_exponent_of_a_power_law() -> None:
    x = [0.1, 0.3, 2.0, 5.0]
    assert power_law(x, [-4.0 * value**-1.5 for value in x]) == pytest.approx(-1.5, rel=1e-14)


def test_least_squares() -> None:
    """Points at log x = -1, 0, 1 and log y = 1, 0, 2: the slope is (2 - 1)/2."""
    e = 2.718281828459045
    assert power_law([1 / e, 1.0, e], [e, 1.0, e * e]) == pytest.approx(0.5, rel=1e-14)


def test_the_jackknife_of_a_mean_is_its_standard_error() -> None:
    values = np.random.default_rng(1).normal(size=(9, 3))
    found, error = ld.jackknife(lambda some: np.mean(some, axis=0), values)
    assert found == pytest.approx(values.mean(axis=0), rel=1e-14)
    assert error == pytest.approx(values.std(axis=0, ddof=1) / 3.0, rel=1e-12)


def test_the_jackknife_of_a_square() -> None:
    """Of samples 1, 2, 6: the square of their mean, 9, without each 16, 12.25 and 2.25."""

    def square(some: Sequence[float]) -> float:
        return float(np.mean(some)) ** 2

    found, error = ld.jackknife(square, [1.0, 2.0, 6.0])
    assert (found, error) == pytest.approx((9.0, np.sqrt(2.0 * np.var([16.0, 12.25, 2.25]))))


def test_one_sample_has_no_error() -> None:
    with pytest.raises(ld.ParameterError, match="at least 2 for an error, not 1"):
        ld.jackknife(np.mean, [1.0])

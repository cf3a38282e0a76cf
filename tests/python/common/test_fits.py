"""Errors by leaving out samples."""

from collections.abc import Sequence

import lammps_deformable as ld
import numpy as np
import pytest


def test_the_jackknife_of_a_mean_is_its_standard_error() -> None:
    values = np.random.default_rng(1).normal(size=(9, 3))
    found, error = ld.jackknife(values, lambda some: np.mean(some, axis=0))
    assert found == pytest.approx(values.mean(axis=0), rel=1e-14)
    assert error == pytest.approx(values.std(axis=0, ddof=1) / 3.0, rel=1e-12)


def test_the_jackknife_of_a_square() -> None:
    """Of samples 1, 2, 6: the square of their mean, 9, without each 16, 12.25 and 2.25."""

    def square(some: Sequence[float]) -> float:
        return float(np.mean(some)) ** 2

    found, error = ld.jackknife([1.0, 2.0, 6.0], square)
    assert (found, error) == pytest.approx((9.0, np.sqrt(2.0 * np.var([16.0, 12.25, 2.25]))))


def test_one_sample_has_no_error() -> None:
    with pytest.raises(ld.ParameterError, match="at least 2 for an error, not 1"):
        ld.jackknife([1.0])
    # the mean is the default
    assert ld.jackknife([1.0, 3.0]) == (2.0, pytest.approx(1.0, rel=1e-15))

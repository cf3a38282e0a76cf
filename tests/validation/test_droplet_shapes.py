"""Exact osmotic pressures of crystals."""

import pytest

from validation.droplet_shapes.__main__ import exact


@pytest.mark.slow
def test_crystals() -> None:
    """fcc at phi = 0.81, as the page of the study has it."""
    assert exact("fcc", 0.81)["exact"] == pytest.approx(0.1206, rel=2e-3)

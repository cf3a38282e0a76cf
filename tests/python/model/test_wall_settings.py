"""Walls as settings."""

from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest


@pytest.mark.parametrize(
    ("angle", "height", "message"),
    [
        ([0.0, 3.0], [1.0, 1.0], "less than half a turn"),
        ([0.0, 1.0, 2.0], [1.0, 1.0, 1.0], "less than half a turn"),
        ([0.0, 4.0, 2.0], [1.0, 1.0, 1.0], "must increase through one turn"),
        ([0.0, np.nan, 4.0], [1.0, 1.0, 1.0], "angle of walls must be finite numbers"),
        (None, None, "angle of walls must be finite numbers"),
        ([], [], "must increase"),
        ([0.0, 2.0, 4.0], "high", "height of walls must be finite numbers, not 'high'"),
        ([0.0, [2.0, 4.0]], [1.0, 1.0, 1.0], "angle of walls must be finite numbers"),
        ([0.0, 2.0, 4.0], [1.0, 1.0], "3 positive numbers"),
        ([0.0, 2.0, 4.0], [1.0, 0.0, 1.0], "3 positive numbers"),
    ],
)
def test_walls_are_a_polygon(angle: Any, height: Any, message: str) -> None:
    with pytest.raises(ld.ParameterError, match=message):
        ld.Walls(angle, height)

"""The rules for radius, kA, kP and skin."""

import numpy as np
import pytest
from contacts import IRREGULAR, soft_ring
from lammps_deformable import core

INF, NAN = np.inf, np.nan


def test_radius():
    assert core.invalid_radius(1e-300) is None
    for radius in (0.0, -0.5, INF, NAN):
        assert f"not {radius:g}" in core.invalid_radius(radius)


def test_valid_stiffness():
    for stiffness in ((1.0, 1.0), (INF, 1e-300), (1e300, INF)):
        assert core.invalid_stiffness(*stiffness) is None


@pytest.mark.parametrize(
    ("kA", "kP", "message"),
    [
        (0.0, 1.0, "kA .*not 0"),
        (NAN, 1.0, "kA .*not nan"),
        (1.0, 0.0, "kP .*not 0"),
        (1.0, NAN, "kP .*not nan"),
        (INF, INF, "kA and kP .*both be inf"),
    ],
)
def test_invalid_stiffness(kA, kP, message):
    with pytest.raises(ValueError, match=message) as error:
        soft_ring(IRREGULAR, kA, kP)
    assert str(error.value) == core.invalid_stiffness(kA, kP)


def test_skin():
    for skin in (-0.1, 1.2, NAN):
        with pytest.raises(ValueError, match=f"skin .*radius 1.2, not {skin:g}") as error:
            soft_ring(IRREGULAR, 1.0, 1.0, skin)
        assert str(error.value) == core.invalid_skin(skin, IRREGULAR.radius)
    assert core.invalid_skin(0.0, 1.2) is core.invalid_skin(np.nextafter(1.2, 0), 1.2) is None


def test_skin_of_an_unknown_radius():
    assert core.invalid_skin(0.0) is core.invalid_skin(1e300) is None
    for skin in (-0.1, INF, NAN):
        assert f"not {skin:g}" in core.invalid_skin(skin)


def test_sectors_conserve_one_quantity_and_have_no_skin():
    assert core.invalid_for_sectors(1.0, INF) is core.invalid_for_sectors(INF, 2.0) is None
    assert "kA = 1 and kP = 0.5" in core.invalid_for_sectors(1.0, 0.5)
    assert "kA = inf and kP = inf" in core.invalid_for_sectors(INF, INF)
    assert "skin" in core.invalid_for_sectors(1.0, INF, 0.1)

"""Invalid input raises a ValueError that names it; the rules for radius, kA, kP and skin."""

from functools import partial

import numpy as np
import pytest
from contacts import IRREGULAR, LAWS, soft_ring
from lammps_deformable import core, core_for_tests

ANGLE, INDENTATION = [0.0, 2.0, 4.0], [0.01, 0.02, 0.01]
BAD = [
    (1.0, ANGLE[:2], INDENTATION, "angle has 2.*indentation has 3"),
    (1.0, [0.0, np.nan, 4.0], INDENTATION, r"angle\[1\] is .*nan"),
    (1.0, ANGLE, [0.01, -np.inf, 0.01], r"indentation\[1\] is -inf"),
    (1.0, ANGLE, [0.01, 1.2, 0.01], r"indentation\[1\] is 1.2"),  # behind the center
    (0.0, ANGLE, INDENTATION, "radius is 0"),
    (np.nan, ANGLE, INDENTATION, "radius is nan"),
    (np.inf, ANGLE, INDENTATION, "radius is inf"),
]


def assert_refused(law, message, radius, angle, indentation):
    """By the law, and by the outline of the law."""
    arguments = radius, np.array(angle), np.array(indentation)
    for call in (LAWS[law], partial(core.outline, law)):
        with pytest.raises(ValueError, match=message):
            call(*arguments)


@pytest.mark.parametrize("law", LAWS)
def test_bad_contacts(law):
    for radius, angle, indentation, message in BAD:
        assert_refused(law, message, radius, angle, indentation)


def test_sectors_that_cannot_exist():
    for angle in ([0.5, 0.5, 3.0], [0.0, 3.0, 2 * np.pi]):  # one direction, also by a turn
        assert_refused("sector", "angle: .*same direction", 1.0, angle, INDENTATION)
        assert_refused("area_sector", "indentation: .*area", 1.0, angle, INDENTATION)
    hexagon = 2 * np.pi * np.arange(6) / 6
    assert_refused("area_sector", "indentation: .*area", 1.0, hexagon, np.full(6, 0.2))


def test_outline_options():
    arguments = 1.0, np.array(ANGLE), np.array(INDENTATION)
    with pytest.raises(ValueError, match="law is 'star'"):
        core.outline("star", *arguments)
    with pytest.raises(ValueError, match="points is 3"):
        core.outline("ring", *arguments, 3)


def test_lists_and_whole_numbers_are_taken():
    assert core.ring(1, [0, 2, 4], [0.01, 0.02, 0.01]).area_deficit > 0
    assert core.contact_line([1, 1], [1, 1], [1, 1]).tolist() == [0.5, 0.5]


def test_bad_contact_lines():
    for arguments, message in (
        ((0.0, 1.0, 1.0), "distance is 0"),
        ((1.0, -1.0, 1.0), "radius_i is -1"),
        (([1.0, 1.0], [1.0], [1.0, 1.0]), "length"),
        (([1.0, np.nan], [1.0, 1.0], [1.0, 1.0]), r"distance\[1\] is .*nan"),
    ):
        with pytest.raises(ValueError, match=message):
            core.contact_line(*arguments)


# ---- the rules for parameters ----


INF, NAN = np.inf, np.nan


def test_radius():
    assert core_for_tests.invalid_radius(1e-300) is None
    for radius in (0.0, -0.5, INF, NAN):
        assert f"not {radius:g}" in core_for_tests.invalid_radius(radius)


def test_valid_stiffness():
    for stiffness in ((1.0, 1.0), (INF, 1e-300), (1e300, INF)):
        assert core.invalid_stiffness(*stiffness) is None


def test_invalid_stiffness():
    for kA, kP, message in (
        (0.0, 1.0, "kA .*not 0"),
        (NAN, 1.0, "kA .*not nan"),
        (1.0, 0.0, "kP .*not 0"),
        (1.0, NAN, "kP .*not nan"),
        (INF, INF, "kA and kP .*both be inf"),
    ):
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

"""Invalid input raises a ValueError that names it."""

from functools import partial

import numpy as np
import pytest
from contacts import LAWS
from lammps_deformable import core

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

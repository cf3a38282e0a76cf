"""Invalid input raises a ValueError that names it."""

from functools import partial

import numpy as np
import pytest
from contacts import LAWS
from lammps_deformable import core

ANGLE, INDENTATION = [0.0, 2.0, 4.0], [0.01, 0.02, 0.01]
BAD = {
    "unequal lengths": (1.0, ANGLE[:2], INDENTATION, "angle has 2.*indentation has 3"),
    "angle nan": (1.0, [0.0, np.nan, 4.0], INDENTATION, r"angle\[1\] is .*nan"),
    "angle inf": (1.0, [0.0, 2.0, np.inf], INDENTATION, r"angle\[2\] is inf"),
    "indentation nan": (1.0, ANGLE, [np.nan, 0.02, 0.01], r"indentation\[0\] is .*nan"),
    "indentation inf": (1.0, ANGLE, [0.01, -np.inf, 0.01], r"indentation\[1\] is -inf"),
    "radius zero": (0.0, ANGLE, INDENTATION, "radius is 0"),
    "radius negative": (-1.0, ANGLE, INDENTATION, "radius is -1"),
    "radius nan": (np.nan, ANGLE, INDENTATION, "radius is nan"),
    "radius inf": (np.inf, ANGLE, INDENTATION, "radius is inf"),
    "behind the center": (1.0, ANGLE, [0.01, 1.2, 0.01], r"indentation\[1\] is 1.2"),
}


def assert_refused(law, message, radius, angle, indentation):
    """By the law, and by the outline of the law."""
    arguments = radius, np.array(angle), np.array(indentation)
    for call in (LAWS[law], partial(core.outline, law)):
        with pytest.raises(ValueError, match=message):
            call(*arguments)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("radius", "angle", "indentation", "message"), BAD.values(), ids=BAD)
def test_bad_contacts(law, radius, angle, indentation, message):
    assert_refused(law, message, radius, angle, indentation)


@pytest.mark.parametrize("angle", [[0.5, 0.5, 3.0], [0.0, 3.0, 2 * np.pi]], ids=["equal", "a turn"])
def test_sectors_need_different_directions(angle):
    assert_refused("sector", "angle: .*same direction", 1.0, angle, INDENTATION)
    assert_refused("area_sector", "indentation: .*area", 1.0, angle, INDENTATION)


def test_area_sector_that_cannot_exist():
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


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.0, 1.0, 1.0), "distance is 0"),
        ((np.inf, 1.0, 1.0), "distance is inf"),
        ((1.0, -1.0, 1.0), "radius_i is -1"),
        (([1.0, 1.0], [1.0], [1.0, 1.0]), "length"),
        ((np.nan, 0.5, 0.5), r"distance is .*nan"),
        (([1.0, np.nan], [1.0, 1.0], [1.0, 1.0]), r"distance\[1\] is .*nan"),
    ],
)
def test_bad_contact_lines(arguments, message):
    with pytest.raises(ValueError, match=message):
        core.contact_line(*arguments)

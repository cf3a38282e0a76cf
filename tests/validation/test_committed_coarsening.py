"""What validation/coarsening/README.md says follows from the committed foams."""

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from validation.coarsening import __main__ as coarsening
from validation.coarsening import angles

FOLDER = Path(__file__).parents[2] / "validation" / "coarsening"
FOAMS = json.loads((FOLDER / "coarsening_256.json").read_text())
STICKING = json.loads((FOLDER / "angles.json").read_text())


def of(dimension: int, phi: float) -> list[dict]:
    return [foam for foam in FOAMS if (foam["dimension"], foam["phi"]) == (dimension, phi)]


def test_foams_are_those_of_the_program() -> None:
    found = {(foam["dimension"], foam["phi"], foam["thickness"]) for foam in FOAMS}
    assert found == set(coarsening.CASES)
    for foam in FOAMS:
        numbers = [row["number"] for row in foam["rows"]]
        assert numbers[0] == foam["number"] == 256
        assert numbers[-1] <= coarsening.LEFT * 256
        assert (np.diff(numbers) <= 0).all()


def test_growth_of_dry_and_of_wet_foams() -> None:
    for phi, exponent in ((0.98, 1 / 2), (0.70, 1 / 3)):
        found = np.mean([coarsening.growth(foam)[0] for foam in of(2, phi)])
        assert found == pytest.approx(exponent, abs=0.08)
    slopes = [np.nanmean([row["slope"] for row in of(2, phi)[0]["rows"]]) for phi in (0.98, 0.9)]
    assert 0.3 < slopes[0] < 0.7
    assert slopes[1] < 0.3 * slopes[0]


def test_a_small_foam(tmp_path: Path) -> None:
    foam = coarsening.age(2, 0.95, 0.02, 32, 1)
    assert [row["time"] for row in foam["rows"]] == sorted(row["time"] for row in foam["rows"])
    assert foam["rows"][-1]["sauter"] > 1.5


def test_bubbles_that_stick_keep_films_where_others_part() -> None:
    parted, lower = angles.PHIS.index(0.82), 0.0
    for angle in angles.ANGLES:
        rates, errors = angles.rates_of(STICKING, angle)
        if angle == 0:
            assert rates[parted:].max() == 0.0
        else:  # a plateau, the higher the larger the angle
            assert rates[parted:] == pytest.approx(rates[parted], rel=0.1)
            assert rates[parted] > lower + 5.0 * errors[parted]
        lower = rates[parted]


def test_a_small_foam_that_sticks() -> None:
    found = angles.expand(5, 16, 1)
    assert len(found["rates"]) == len(angles.PHIS)
    assert min(found["rates"]) > 0.02

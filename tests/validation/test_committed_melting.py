"""What docs/melting.md and the README of the study say follows from the committed measurements.

Run as a script, this writes tables and sentences into the page.
"""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from committed_page import check, write

from validation.melting import __main__ as melting
from validation.melting import measure, results

pytest.importorskip("matplotlib")
pytest.importorskip("freud")

ROOT = Path(__file__).parents[2]
FOLDER, PAGE = ROOT / "validation" / "melting", ROOT / "docs" / "melting.md"
RESULT, SMALL = (json.loads((FOLDER / f"{name}.json").read_text()) for name in ("full", "small"))
STAGES = results.stages(RESULT)


def at(number: int, start: str, temperature: float) -> list[dict]:
    return STAGES[number, RESULT["phi"], start, 1, temperature]


def known() -> str:
    return results.summary(RESULT)


def took() -> str:
    """Processor time of all legs, of one with its measurements, and of polygons."""
    cost = RESULT["polygons"]
    legs = [leg for ramp in RESULT["ramps"] if ramp["number"] == 1024 for leg in ramp["legs"]]
    each = 1e6 * np.mean([leg["seconds"] for leg in legs]) / results.LEG / 1024
    slower = cost["microseconds"] / cost["step"] / each
    hours = results.seconds(RESULT) * slower / 3600.0
    return (
        f"{results.seconds(RESULT) / 60.0:.0f} minutes of processor time. Polygons of "
        f"{cost['vertices']} vertices, cold and at phi = 0.88, take {cost['microseconds']:.1f} "
        f"microseconds for a step of a particle, and their steps are {cost['step']:.2g} long, so "
        f"that a unit of time takes {slower:.0f} times as long, and all of this would take "
        f"{hours:.0f} hours"
    )


SENTENCES = {
    known: r"Crystal at rest: p = .*? s of processor time\.",
    took: r"\d+ minutes of processor time\. Polygons of .*? (days|hours)",
}


def test_the_page_follows_from_the_measurements() -> None:
    check(PAGE, (table(RESULT) for table in results.TABLES), SENTENCES)


def test_they_are_all_that_the_script_measures() -> None:
    for name, result in (("small", SMALL), ("full", RESULT)):
        for ramp, plan in zip(result["ramps"], melting.PLANS[name], strict=True):
            assert tuple(ramp[key] for key in ("number", "phi", "start", "seed")) == plan[:4]
            stages = [temperature for temperature, legs in plan[4] for _ in range(legs)]
            assert [leg["T"] for leg in ramp["legs"]] == stages


def test_the_log_is_that_of_the_small_run(capsys: pytest.CaptureFixture[str]) -> None:
    results.show(SMALL)
    assert capsys.readouterr().out == (FOLDER / "small.log").read_text()


def test_gases_follow_virial_coefficients() -> None:
    """The next terms are 0.53 x^3 for hard disks, and 5 standard errors of the motion."""
    for thin in (*SMALL["dilute"], *RESULT["dilute"]):
        x = 2.0 * thin["phi"]
        assert abs(thin["z"] - thin["virial"]) < 5.0 * thin["error"] + 0.7 * x**3


def test_baths_have_their_temperature() -> None:
    """N 25 velocities a leg, with two components each."""
    for result in (SMALL, RESULT):
        for (number, *_), legs in results.stages(result).items():
            found = np.mean([leg["bath"] for leg in legs])
            assert abs(found - 1.0) < 5.0 / math.sqrt(number * 25 * len(legs)) + 0.02


def test_crystal_melts_between_two_temperatures_and_the_liquid_is_one() -> None:
    assert results.value(at(1024, "crystal", 0.0775), "Bragg")[0] > 0.3
    assert results.value(at(1024, "crystal", 0.08), "Bragg")[0] < 0.05
    for number, temperature in ((256, 0.06), (256, 0.07), (256, 0.08), (1024, 0.08)):
        both = [at(number, start, temperature) for start in ("crystal", "random")]
        for name in ("psi_6", "defects", "p", "energy"):
            found, error = results.difference(*both, name)
            assert abs(found) < 1.4 * error


def test_exponents_by_size_are_those_by_moduli_and_of_a_solid() -> None:
    for temperature in (0.06, 0.07, 0.075):
        small, large = (at(number, "crystal", temperature) for number in (256, 1024))
        by_size, error = results.between_sizes(small, large, "Bragg")
        by_moduli, other = results.value(large, "eta_K by moduli")
        assert abs(by_size - by_moduli) < 2.0 * math.hypot(error, other)
        assert by_moduli < 1.0 / 3.0
    young, error = results.value(at(1024, "crystal", 0.0775), "Y a^2/T")
    assert abs(young - 16.0 * math.pi) < 2.0 * error


def test_long_steps_and_a_loose_balance_change_no_average_but_another_law_does() -> None:
    rows = {(row["settings"], row["T"]): row for row in RESULT["checks"]}
    for temperature in (0.06, 0.1):
        used, exact, other = (rows[name, temperature] for name in measure.SETTINGS)
        for name in ("energy", "pressure"):
            (a, da), (b, db) = used[name], exact[name]
            assert abs(a - b) < 1.3 * math.hypot(da, db)
        (a, da), (b, db) = used["energy"], other["energy"]
        assert a - b > 3.0 * math.hypot(da, db)


def test_no_packing_at_rest_has_less_energy_than_the_crystal() -> None:
    for row in RESULT["quenches"]:
        crystal = row["defects"] == 0.0
        assert abs(row["excess"]) < 1e-3 if crystal else row["excess"] > 0.1
        assert crystal == (row["T"] == 0.07)


if __name__ == "__main__":
    write(PAGE, (table(RESULT) for table in results.TABLES), SENTENCES)

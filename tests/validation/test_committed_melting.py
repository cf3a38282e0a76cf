"""What docs/melting.md and the README of the study say follows from the committed measurements."""

import math

import numpy as np
import pytest

from validation.melting import __main__ as melting
from validation.melting import measure, results
from validation.melting.documented import FOLDER, RESULT, SMALL, at

pytest.importorskip("matplotlib")
pytest.importorskip("freud")
SHOWN = {"full": (RESULT, results.TABLES), "small": (SMALL, results.FEW_TABLES)}


def test_they_are_all_that_the_script_measures() -> None:
    for name, result in (("small", SMALL), ("full", RESULT)):
        for ramp, plan in zip(result["ramps"], melting.PLANS[name], strict=True):
            assert tuple(ramp[key] for key in ("number", "phi", "start", "seed")) == plan[:4]
            stages = [temperature for temperature, legs in plan[4] for _ in range(legs)]
            assert [leg["T"] for leg in ramp["legs"]] == stages


@pytest.mark.parametrize("name", SHOWN)
def test_the_log_has_all_tables(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    results.show(*SHOWN[name])
    assert capsys.readouterr().out == (FOLDER / f"{name}.log").read_text()


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


def test_one_start_and_the_other_differ_where_the_liquid_has_little_time() -> None:
    found, error = results.difference(
        *(at(1024, start, 0.075) for start in ("crystal", "random")), "energy"
    )
    assert found < -2.0 * error

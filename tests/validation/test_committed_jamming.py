"""The tables in validation/jamming show what docs/jamming.md says."""

import itertools
import json
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from validation.jamming.__main__ import read_table, write_tables
from validation.jamming.packings import exponents, measure, summarize

FOLDER = Path(__file__).parents[2] / "validation" / "jamming"
ONSETS, SCALING = read_table(FOLDER / "table.csv"), read_table(FOLDER / "scaling.csv")
SUMMARY = json.loads((FOLDER / "summary.json").read_text())
BISECTION = json.loads((FOLDER / "bisection" / "summary.json").read_text())["onset"]
NUMBERS = (16, 32, 64, 128, 256, 512)


def onset(law, pressure, number):
    (row,) = (
        row
        for row in SUMMARY["onset"]
        if (row["law"], row["onset_pressure"], row["number"]) == (law, pressure, number)
    )
    return row


def exponent(law, number=128):
    (row,) = (row for row in SUMMARY["exponents"] if (row["law"], row["number"]) == (law, number))
    return row


def test_tables_are_as_the_command_writes_them(tmp_path):
    write_tables(tmp_path, ONSETS, SCALING)
    for name in ("table.csv", "scaling.csv"):
        assert (tmp_path / name).read_bytes() == (FOLDER / name).read_bytes()


def test_summary_is_that_of_the_tables():
    for written, found in (("onset", summarize(ONSETS)), ("exponents", exponents(SCALING))):
        for ours, theirs in zip(SUMMARY[written], found, strict=True):
            for name, value in theirs.items():
                same = ours[name] == value or np.isclose(ours[name], value, rtol=1e-9)
                assert same, name


def test_all_sizes_are_there_and_nothing_stalled():
    for law in ("disk", "radical"):
        for number in NUMBERS:
            assert onset(law, 1e-7, number)["packings"] >= 3
    for row in ONSETS:
        assert not row["stalled"]
        assert row["onset_pressure"] < row["pressure"] <= 2.001 * row["onset_pressure"]


def test_onsets_are_isostatic_where_overlaps_vanish():
    """Disks at 1e-7 and rings at 1e-16 are 3e-7 and 3e-6 above phi_J: 2 N' - 1 contacts.

    Contacts are added once p N^2 is of order 1, that is from 1000 disks on.
    """
    near = [row for row in ONSETS if row["law"] == "disk" or row["onset_pressure"] == 1e-16]
    more = np.array([row["contacts"] - row["isostatic"] for row in near])
    number = np.array([row["number"] for row in near])
    assert more.min() == 0
    assert np.mean(more[number <= 512] == 0) > 0.9
    assert (more[number > 512] <= 0.003 * number[number > 512]).all()


def test_rings_and_disks_jam_at_the_same_phi():
    for number in NUMBERS:
        rings, disks = onset("radical", 1e-16, number), onset("disk", 1e-7, number)
        error = np.hypot(rings["phi_error"], disks["phi_error"])
        assert abs(rings["phi"] - disks["phi"]) < 2.0 * error


def test_radical_and_balanced_rings_jam_at_the_same_phi():
    """The starts are the same, so that the errors of independent packings are upper bounds."""
    for number in (16, 32, 64, 128):
        balanced, radical = (onset(law, 1e-7, number) for law in ("balanced", "radical"))
        for name in ("phi", "contacts"):
            error = np.hypot(balanced[f"{name}_error"], radical[f"{name}_error"])
            assert abs(balanced[name] - radical[name]) < 2.0 * error


@pytest.mark.parametrize(("law", "factor"), [("radical", 4.9), ("balanced", 3.3)])
def test_pressure_of_rings_at_the_onset(law, factor):
    """p = factor x^3, x from phi_J of the disks with the same seed; medians over packings."""
    rows = {
        (row["law"], row["seed"]): row
        for row in ONSETS
        if (row["number"], row["onset_pressure"]) == (128, 1e-7)
    }
    found = [
        row["pressure"] / (row["phi"] - rows["disk", seed]["phi"]) ** 3
        for (name, seed), row in rows.items()
        if name == law
    ]
    assert np.median(found) == pytest.approx(factor, abs=0.05)


@pytest.mark.parametrize(("law", "power"), [("disk", 1.0), ("radical", 3.0)])
def test_exponents_are_those_of_the_contact_energies(law, power):
    """p ~ x for disks and x^3 for rings, bulk moduli one less.

    Both exponents are larger by up to 0.1: z grows by a tenth in two decades of x, and with it the
    factor before the power.
    """
    found = exponent(law)
    assert -0.01 < found["pressure"] - power < 0.1
    assert -0.01 < found["bulk_modulus"] - (power - 1.0) < 0.1


def test_shear_moduli_rise_faster_than_bulk_moduli():
    """The exponent is larger by 1/2 in large packings, by less in small ones."""
    for law, power in (("disk", 0.5), ("radical", 2.5)):
        found = exponent(law)
        assert abs(found["shear_modulus"] - power) < 2.0 * found["shear_modulus_error"]
    assert 2.0 < exponent("radical", 64)["shear_modulus"] < 2.5


def test_moduli_are_of_linear_response():
    share = np.mean([row["shear_linear"] and row["bulk_linear"] for row in SCALING])
    assert share > 0.95


@pytest.mark.slow
@pytest.mark.parametrize(("law", "pressure", "number"), [("disk", 1e-7, 64), ("radical", 1e-7, 64)])
def test_ensembles_are_those_of_the_page(law, pressure, number):
    """Where a packing jams is chaotic: another machine may find other ones with the same mean."""
    found = [measure(law, pressure, number, seed)[0] for seed in range(101, 111)]
    (fresh,) = summarize(found)
    kept = onset(law, pressure, number)
    for name in ("phi", "excess_contacts", "rattlers"):
        error = np.hypot(fresh[f"{name}_error"], kept[f"{name}_error"])
        assert abs(fresh[name] - kept[name]) < 4.0 * error + 1e-12


def test_onsets_from_the_rigid_side_are_of_the_same_ensemble():
    """As bisection with FIRE found them: chi^2 of nine means, which 1 % of equal ones exceed."""
    squares = []
    for number, name in itertools.product((64, 256, 512), ("phi", "excess_contacts", "rattlers")):
        before, now = (
            next(row for row in rows if (row["law"], row["number"]) == ("disk", number))
            for rows in (BISECTION, SUMMARY["onset"])
        )
        error = np.hypot(before[f"{name}_error"], now[f"{name}_error"])
        squares.append(((before[name] - now[name]) / error) ** 2)
    assert sum(squares) == pytest.approx(16.5, abs=0.05)  # as docs/jamming.md says
    assert sum(squares) < chi2.ppf(0.99, len(squares))


def test_summary_of_the_bisection_is_that_of_its_table():
    for written, found in zip(
        BISECTION, summarize(read_table(FOLDER / "bisection" / "table.csv")), strict=True
    ):
        for name, value in found.items():
            assert written[name] == value or np.isclose(written[name], value, rtol=1e-9), name
        assert found["stalled"] == 0

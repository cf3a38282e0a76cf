"""Ensembles at and above the onset of jamming: means, exponents, tables."""

from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest

from validation.finite_strain import shear_modulus
from validation.jamming.__main__ import read_table, write_tables
from validation.jamming.packings import (
    Row,
    before_rearrangement,
    contact_law,
    excess_coordination,
    exponents,
    is_significant,
    jackknife,
    measure,
    summarize,
)


def test_exponents_of_power_laws_are_exact() -> None:
    x = np.geomspace(1e-4, 1e-2, 7) * np.ones((5, 1))
    slope, error = jackknife(x, 3.0 * x**2.5)
    assert slope == pytest.approx(2.5, rel=1e-12)
    assert error < 1e-12


def test_error_of_an_exponent_is_that_of_independent_slopes() -> None:
    """Packings of the law x^(1 + s), s small and random: their mean has the error of the mean s."""
    spread = 1e-3 * np.random.default_rng(1).standard_normal(20)
    x = np.geomspace(0.1, 10.0, 7) * np.ones((20, 1))
    slope, error = jackknife(x, x ** (1.0 + spread[:, None]))
    assert slope == pytest.approx(1.0 + spread.mean(), abs=1e-5)
    assert error == pytest.approx(np.std(spread, ddof=1) / np.sqrt(20), rel=0.01)


def test_what_changes_sign_has_no_exponent() -> None:
    x = np.geomspace(0.1, 10.0, 3) * np.ones((4, 1))
    assert all(np.isnan(jackknife(x, x - 1.0)))
    assert np.isnan(jackknife(x[:1], x[:1])[1])


def test_means_that_are_not_significant_are_left_out() -> None:
    """Fewer than three packings, or a mean below two standard errors: here 2.1, 1.9, and two."""
    spread = np.array([-1.0, 1.0, -1.0, 1.0])
    error = np.std(spread, ddof=1) / 2.0
    columns = [2.1 * error + spread, 1.9 * error + spread, np.array([1.0, 1.0, np.nan, np.nan])]
    assert is_significant(np.column_stack(columns)).tolist() == [True, False, False]
    assert is_significant(np.array([[1.0, 0.0, -1.0]])).tolist() == [True, False, False]


def test_excess_coordination() -> None:
    """Ten particles have 19 contacts at the onset; each further contact adds 2/10 to z."""
    row = {"law": "disk", "isostatic": 19, "contacts": 24}
    assert excess_coordination(row) == pytest.approx(2.0 * 5 / 10, rel=1e-15)


def test_shear_modulus_is_the_mean_over_directions() -> None:
    """Of simple and of pure shear; a small packing is far from isotropic."""
    number, seed, delta = 12, 2, 4e-4
    _, (row,) = measure("disk", 1e-7, number, seed, (delta,))
    jammed = ld.jam(ld.bidisperse(number, seed=seed), None, tolerance=1e-6).packing
    with ld.Simulation(jammed, ld.SoftContact()) as disks:
        onset = disks.relax()
        disks.deform(jammed.at(onset.phi + delta).box)
        state = disks.relax(1e-8)
    simple, pure = (shear_modulus(state, 0.01 * delta, pure=pure).value for pure in (False, True))
    assert abs(simple - pure) > 0.1 * max(abs(simple), abs(pure))
    # each is good to 1 %
    assert abs(row["shear_modulus"] - (simple + pure) / 2.0) < 0.01 * max(abs(simple), abs(pure))


def cubic(seed: int, break_at: int = 7) -> list[Row]:
    """A packing with p = x^3, K = phi dp/dphi, that loses half of its pressure at a point."""
    rows = []
    for n in range(7):
        x = 1e-4 * 2.0**n
        phi, part = 0.84 + x, 1.0 if n < break_at else 0.5
        row = {"seed": seed, "excess_phi": x, "phi": phi, "pressure": part * x**3}
        rows.append(row | {"bulk_modulus": part * 3.0 * phi * x**2})
    return rows


@pytest.mark.parametrize("break_at", [1, 7])
def test_packings_count_until_they_rearrange(break_at: int) -> None:
    assert before_rearrangement(cubic(1, break_at)) == cubic(1)[:break_at]
    both = [*cubic(1, break_at), *cubic(2)]
    assert len(before_rearrangement(both)) == break_at + 7


def test_means_and_their_errors() -> None:
    rows = [measure("disk", 1e-7, 8, seed)[0] for seed in (2, 5, 6)]
    (summary,) = summarize(rows)
    phi = [row["phi"] for row in rows]
    assert summary["phi"] == pytest.approx(np.mean(phi))
    assert summary["phi_error"] == pytest.approx(np.std(phi, ddof=1) / np.sqrt(3))
    assert summary["packings"] == 3


@pytest.mark.slow
def test_rings_follow_a_cubic_law_and_disks_a_linear_one() -> None:
    """One packing of 12: until its contacts change, S and overlap are quadratic and linear."""
    for law, pressure, power in (("disk", 1e-7, 1.0), ("radical", 1e-16, 3.0)):
        _, rows = measure(law, pressure, 12, 3, (1e-4, 2e-4, 4e-4))
        (found,) = exponents(rows)
        assert found["pressure"] == pytest.approx(power, abs=0.05 * power)
        assert found["bulk_modulus"] == pytest.approx(power - 1.0, abs=0.1)
        assert all(row["bulk_linear"] and row["shear_linear"] for row in rows)


def test_names_of_laws() -> None:
    assert contact_law("disk") == ld.SoftContact()
    assert contact_law("curved") == ld.Ring(contact="curved")
    with pytest.raises(KeyError):
        contact_law("disks")


def test_tables_come_back_as_they_were(tmp_path: Path) -> None:
    row: Row = {"law": "disk", "onset_pressure": 1e-7, "number": 8, "seed": 1, "phi": 0.8}
    row |= {"contacts": 15, "stalled": False, "linear": True, "error": float("inf")}
    write_tables(tmp_path, [row], [])
    assert read_table(tmp_path / "table.csv") == [row]
    assert read_table(tmp_path / "scaling.csv") == []


def test_other_tables_are_refused(tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text("law,number,seed\nradical,8,1\n")
    with pytest.raises(ld.FileError, match=r"table\.csv is no table of this command"):
        read_table(tmp_path / "table.csv")

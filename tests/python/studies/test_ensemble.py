"""Ensembles at the onset: means, exponents, the command and what it keeps."""

import csv
import json
from pathlib import Path

import deformable
import numpy as np
import pytest
from deformable.cli import main as cli
from deformable.cli.jam import LawName, _read, _tables
from deformable.studies.ensemble import (
    LAWS,
    Row,
    excess_coordination,
    exponents,
    jackknife,
    measure,
    summarize,
    unbroken,
    well_known,
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


def test_means_that_are_not_known_are_left_out() -> None:
    """Fewer than three packings, or a mean below two standard errors: here 2.1, 1.9, and two."""
    spread = np.array([-1.0, 1.0, -1.0, 1.0])
    error = np.std(spread, ddof=1) / 2.0
    columns = [2.1 * error + spread, 1.9 * error + spread, np.array([1.0, 1.0, np.nan, np.nan])]
    assert well_known(np.column_stack(columns)).tolist() == [True, False, False]


def test_excess_coordination() -> None:
    """Ten particles that bear have 19 contacts at the onset; each contact more is 2/10 to z."""
    row = {"isostatic": 19, "contacts": 24}
    assert excess_coordination(row) == pytest.approx(2.0 * 5 / 10, rel=1e-15)


def test_shear_modulus_is_the_mean_over_directions() -> None:
    """That of simple and of pure shear; a small packing is far from isotropic."""
    number, seed, delta = 12, 2, 4e-4
    _, (row,) = measure("disk", 1e-7, number, seed, (delta,))
    jammed = deformable.jam(deformable.bidisperse(number, seed=seed), None, tolerance=1e-6)
    with deformable.Disks(jammed) as disks:
        onset = disks.relax()
        disks.deform(jammed.at(onset.phi + delta).box)
        state = disks.relax(1e-8)
    simple, pure = (
        deformable.shear_modulus(state, 0.01 * delta, 1e-8, pure).value for pure in (False, True)
    )
    assert abs(simple - pure) > 0.1 * max(abs(simple), abs(pure))
    # each is good to 1 %
    assert abs(row["shear_modulus"] - (simple + pure) / 2.0) < 0.01 * max(abs(simple), abs(pure))


def cubic(seed: int, break_at: int = 7) -> list[Row]:
    """A packing with p = x^3, K = phi dp/dphi, that loses half of its pressure at a point."""
    rows = []
    for n in range(7):
        x = 1e-4 * 2.0**n
        phi, left = 0.84 + x, 1.0 if n < break_at else 0.5
        row = {"seed": seed, "excess": x, "phi": phi, "pressure": left * x**3}
        rows.append(row | {"bulk_modulus": left * 3.0 * phi * x**2})
    return rows


@pytest.mark.parametrize("break_at", [1, 4, 7])
def test_packings_count_until_they_rearrange(break_at: int) -> None:
    assert unbroken(cubic(1, break_at)) == cubic(1)[:break_at]
    both = [*cubic(1, break_at), *cubic(2)]
    assert len(unbroken(both)) == break_at + 7


def test_means_and_their_errors() -> None:
    rows = [measure("disk", 1e-7, 8, seed)[0] for seed in (2, 5, 6)]
    (summary,) = summarize(rows)
    phi = [row["phi"] for row in rows]
    assert summary["phi"] == pytest.approx(np.mean(phi))
    assert summary["phi_error"] == pytest.approx(np.std(phi, ddof=1) / np.sqrt(3))
    assert summary["packings"] == 3


def test_rings_follow_a_cubic_law_and_disks_a_linear_one() -> None:
    """One packing of 12: until its contacts change, S and overlap are quadratic and linear."""
    for law, window, power in (("disk", 1e-7, 1.0), ("radical", 1e-16, 3.0)):
        _, rows = measure(law, window, 12, 2, (1e-4, 2e-4, 4e-4))
        (found,) = exponents(rows)
        assert found["pressure"] == pytest.approx(power, abs=0.05 * power)
        assert found["bulk_modulus"] == pytest.approx(power - 1.0, abs=0.1)
        assert all(row["bulk_linear"] and row["shear_linear"] for row in rows)


def test_laws_of_the_command_are_those_of_the_ensembles() -> None:
    assert [law.value for law in LawName] == list(LAWS)


def jam(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr("sys.argv", ["deformable", "jam", *arguments])
    with pytest.raises(SystemExit) as end:
        cli.main()
    return int(end.value.code or 0)


def test_command_keeps_what_it_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    ask = ("--number", "8", "10", "--seeds", "2", "--workers", "1", "--out", "run")
    assert jam(monkeypatch, *ask, "--law", "disk") == 0
    first = (tmp_path / "run" / "table.csv").read_text()
    assert "disk, N = 8: phi_J = 0." in capsys.readouterr().out
    assert jam(monkeypatch, *ask, "--law", "disk") == 0
    assert (tmp_path / "run" / "table.csv").read_text() == first  # with the seconds
    assert jam(monkeypatch, *ask[:2], *ask[3:], "--law", "ring") == 0
    table = (tmp_path / "run" / "table.csv").read_text().splitlines()
    assert set(first.splitlines()) < set(table)
    rows = list(csv.DictReader(table))
    assert [(row["law"], row["number"], row["seed"]) for row in rows] == [
        *(("disk", number, seed) for number in ("8", "10") for seed in ("1", "2")),
        *(("ring", "8", seed) for seed in ("1", "2")),
    ]
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert [row["number"] for row in summary["onset"]] == [8, 10, 8]
    assert (tmp_path / "run" / "onset.png").stat().st_size > 5_000


def test_command_keeps_what_is_done_when_it_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)

    def fails_at_three(law: str, window: float, number: int, seed: int, above: object) -> object:
        if seed == 3:
            raise deformable.LammpsError("out of luck")
        return measure(law, window, number, seed)

    monkeypatch.setattr("deformable.cli.jam.measure", fails_at_three)
    ask = ("--number", "8", "--seeds", "4", "--workers", "1", "--law", "disk", "--out", "run")
    assert jam(monkeypatch, *ask) == 2
    assert capsys.readouterr().err.endswith("error: out of luck\n")
    assert [row["seed"] for row in _read(tmp_path / "run" / "table.csv")] == [1, 2]


def test_command_leaves_other_folders_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    packing = deformable.jam(deformable.bidisperse(4, seed=1))
    with deformable.Simulation(packing, deformable.Ring()) as sim:
        sim.state().save(tmp_path / "run")
    before = (tmp_path / "run" / "summary.json").read_text()
    for out, message in ((str(tmp_path / "run"), "holds a run"), ("", "a folder needs a name")):
        assert jam(monkeypatch, "--number", "8", "--seeds", "1", "--out", out) == 2
        assert message in capsys.readouterr().err
    assert (tmp_path / "run" / "summary.json").read_text() == before


def test_tables_come_back_as_they_were(tmp_path: Path) -> None:
    row: Row = {"law": "disk", "window": 1e-7, "number": 8, "seed": 1, "phi": 0.8}
    row |= {"contacts": 15, "stalled": False, "linear": True, "error": float("inf")}
    _tables(tmp_path, [row], [])
    assert _read(tmp_path / "table.csv") == [row]


def test_command_follows_packings_upwards(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = str(tmp_path / "run")
    ask = ("--number", "8", "--seeds", "1", "--law", "disk", "--workers", "1", "--out", out)
    assert jam(monkeypatch, *ask) == 0
    assert jam(monkeypatch, *ask, "--above", "0.01") == 0
    with (tmp_path / "run" / "scaling.csv").open() as file:
        excess = [float(row["excess"]) for row in csv.DictReader(file)]
    assert excess == pytest.approx([0.01 / 2.0**n for n in reversed(range(7))], rel=1e-6)
    (fit,) = json.loads((tmp_path / "run" / "summary.json").read_text())["exponents"]
    assert fit["pressure"] == pytest.approx(1.0, abs=0.1)
    assert fit["pressure_error"] is None  # of a single packing
    assert (tmp_path / "run" / "scaling.png").stat().st_size > 5_000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--number", "0"], "number must be at least 1, not 0"),
        (["--seeds", "0"], "seeds must be at least 1, not 0"),
        (["--pressure", "-1"], "pressure must be a positive number, not -1.0"),
        (["--above", "-1"], "above must lie between 0 and 0.1, not -1.0"),
        (["--above", "0.01"], "with the ring law take at most 5e-14"),
        (["--workers", "0"], "workers must be at least 1, not 0"),
    ],
)
def test_bad_input_is_one_line(
    arguments: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert jam(monkeypatch, *arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert message in line


def test_a_table_of_something_else_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "table.csv").write_text("law,number\nring,many\n")
    assert jam(monkeypatch, "--out", str(tmp_path)) == 2
    assert "table.csv is no table of this command" in capsys.readouterr().err

"""The command `deformable jam`, and what it keeps in its folder."""

import csv
import json
from pathlib import Path

import lammps_deformable as ld
import pytest
from lammps_deformable.cli import main as cli
from lammps_deformable.studies.ensemble.packings import measure
from lammps_deformable.studies.ensemble.tables import read_table


def jam(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr("sys.argv", ["deformable", "jam", *arguments])
    with pytest.raises(SystemExit) as end:
        cli.main()
    return int(end.value.code or 0)


def test_command_keeps_what_it_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    ask = ("8", "--seeds", "2", "--workers", "1", "--out", "run")
    assert jam(monkeypatch, "10", *ask, "--law", "disk") == 0
    first = (tmp_path / "run" / "table.csv").read_text()
    assert "disk, N = 8: phi_J = 0." in capsys.readouterr().out
    assert jam(monkeypatch, "10", *ask, "--law", "disk") == 0
    assert (tmp_path / "run" / "table.csv").read_text() == first  # with the seconds
    assert jam(monkeypatch, *ask, "--law", "balanced") == 0
    table = (tmp_path / "run" / "table.csv").read_text().splitlines()
    assert set(first.splitlines()) < set(table)
    rows = list(csv.DictReader(table))
    assert [(row["law"], row["number"], row["seed"]) for row in rows] == [
        *(("balanced", "8", seed) for seed in ("1", "2")),
        *(("disk", number, seed) for number in ("8", "10") for seed in ("1", "2")),
    ]
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert [row["number"] for row in summary["onset"]] == [8, 8, 10]
    assert (tmp_path / "run" / "onset.png").stat().st_size > 5_000


def test_command_keeps_what_is_done_when_it_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)

    def fails_at_three(
        law: str, pressure: float, number: int, seed: int, *others: object
    ) -> object:
        if seed == 3:
            raise ld.LammpsError("out of luck")
        return measure(law, pressure, number, seed)

    monkeypatch.setattr("lammps_deformable.cli.jam.measure", fails_at_three)
    ask = ("8", "--seeds", "4", "--workers", "1", "--law", "disk", "--out", "run")
    assert jam(monkeypatch, *ask) == 2
    assert capsys.readouterr().err.endswith("error: out of luck\n")
    assert [row["seed"] for row in read_table(tmp_path / "run" / "table.csv")] == [1, 2]


def test_command_leaves_other_folders_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    packing = ld.jam(ld.bidisperse(4, seed=1))
    with ld.Simulation(packing, ld.Ring()) as sim:
        sim.state().save(tmp_path / "run")
    before = (tmp_path / "run" / "summary.json").read_text()
    for out, message in ((str(tmp_path / "run"), "holds a run"), ("", "a folder needs a name")):
        assert jam(monkeypatch, "8", "--seeds", "1", "--out", out) == 2
        assert message in capsys.readouterr().err
    assert (tmp_path / "run" / "summary.json").read_text() == before


def test_command_follows_packings_upwards(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = str(tmp_path / "run")
    ask = ("8", "--seeds", "1", "--pressure", "1e-7", "--workers", "1", "--out", out)
    assert jam(monkeypatch, *ask) == 0
    assert jam(monkeypatch, *ask, "--excess-phi", "0.01") == 0
    out, err = capsys.readouterr()
    assert "nan" not in out  # what a single packing does not tell
    assert err == ""
    with (tmp_path / "run" / "scaling.csv").open() as file:
        excess = [float(row["excess_phi"]) for row in csv.DictReader(file)]
    assert excess == pytest.approx([0.01 / 2.0**n for n in reversed(range(7))], rel=1e-6)
    (fit,) = json.loads((tmp_path / "run" / "summary.json").read_text())["exponents"]
    assert fit["pressure"] == pytest.approx(1.0, abs=0.1)
    assert fit["pressure_error"] is None  # of a single packing
    assert (tmp_path / "run" / "scaling.png").stat().st_size > 5_000


def test_packings_are_saved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also those that are in the table already."""
    monkeypatch.chdir(tmp_path)
    ask = ("8", "--law", "radical", "--seeds", "2", "--workers", "1", "--out", "run")
    assert jam(monkeypatch, *ask) == 0
    assert not (tmp_path / "run" / "packings").exists()
    assert jam(monkeypatch, *ask, "--save") == 0
    rows = read_table(tmp_path / "run" / "table.csv")
    folders = sorted((tmp_path / "run" / "packings").iterdir())
    assert [folder.name for folder in folders] == ["radical_1e-06_8_1", "radical_1e-06_8_2"]
    for row, folder in zip(rows, folders, strict=True):
        with ld.Run(folder).simulation() as sim:
            assert sim.state().phi == pytest.approx(row["phi"], rel=1e-12)
    assert jam(monkeypatch, "8", "--save", "--out", "disks") == 2
    assert not (tmp_path / "disks").exists()


def test_the_packing_in_a_file_is_jammed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    start = ld.bidisperse(10, (0.5, 0.6), phi=0.7, seed=4)
    start.to_file("a.xyz")
    ask = ("--from", "a.xyz", "--law", "radical", "--out", "run")
    assert jam(monkeypatch, *ask, "--save") == 0
    (row,) = read_table(tmp_path / "run" / "table.csv")
    expected, _ = measure("radical", 1e-6, 10, 1, start=start)
    assert row["number"] == 10
    assert row["phi"] == pytest.approx(expected["phi"], rel=1e-6)
    with ld.Run(tmp_path / "run" / "packings" / "radical_1e-06_10_1").simulation() as sim:
        assert sim.state().packing.radii.tolist() == [0.5, 0.6]
    assert jam(monkeypatch, *ask) == 0
    assert capsys.readouterr().err == ""
    for wrong, told in (
        (("8", "--out", "run"), "holds onsets of the packing in 'a.xyz': name another folder"),
        (("8", *ask), "a number of particles is about random ones: leave it out"),
        (("--seeds", "3", *ask), "--seeds is about random ones: leave it out"),
        (("8", "--from-radii", "0.5"), "--from-radii is about the file of a packing"),
        (("--from", "b.xyz"), "'b.xyz' cannot be read: No such file"),
        ((), "give numbers of particles, e.g. jam 16 32 64, or --from FILE"),
    ):
        assert jam(monkeypatch, *wrong) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert told in line
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.xyz", "run"]

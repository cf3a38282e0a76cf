"""`python -m validation.jamming`: ensembles, and what they keep in their folder."""

import csv
import json
from pathlib import Path

import lammps_deformable as ld
import pytest

from validation.jamming import __main__ as jamming
from validation.jamming.packings import contact_law, dimension_of, excess_coordination, measure


def ensemble(*words: str) -> None:
    jamming.main([*words, "--workers", "1", "--out", "run"])


@pytest.fixture(autouse=True)
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path / "run"


@pytest.mark.slow
def test_it_keeps_what_it_has(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ask = ("8", "--seeds", "2")
    ensemble("10", *ask)
    first = (run / "table.csv").read_text()
    assert "disk, N = 8: phi_J = 0." in capsys.readouterr().out
    ensemble("10", *ask)
    assert (run / "table.csv").read_text() == first  # with the seconds
    ensemble(*ask, "--law", "balanced")
    table = (run / "table.csv").read_text().splitlines()
    assert set(first.splitlines()) < set(table)
    rows = list(csv.DictReader(table))
    assert [(row["law"], row["number"], row["seed"]) for row in rows] == [
        *(("balanced", "8", seed) for seed in ("1", "2")),
        *(("disk", number, seed) for number in ("8", "10") for seed in ("1", "2")),
    ]
    summary = json.loads((run / "summary.json").read_text())
    assert [row["number"] for row in summary["onset"]] == [8, 8, 10]
    assert (run / "onset.png").stat().st_size > 5_000


def test_it_keeps_what_is_done_when_it_fails(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    called, unlucky = [], 3

    def fails(law: str, pressure: float, number: int, seed: int, *others: object) -> object:
        if seed == unlucky:
            raise ld.LammpsError("out of luck")
        called.append(seed)
        return measure(law, pressure, number, seed)

    monkeypatch.setattr(jamming, "measure", fails)
    with pytest.raises(ld.LammpsError, match="out of luck"):
        ensemble("8", "--seeds", "4")
    unlucky = 0
    ensemble("8", "--seeds", "4")
    assert called == [1, 2, 3, 4]
    assert [row["seed"] for row in jamming.read_table(run / "table.csv")] == [1, 2, 3, 4]


@pytest.mark.slow
def test_it_follows_packings_upwards(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ask = ("8", "--seeds", "1", "--pressure", "1e-7")
    ensemble(*ask)
    ensemble(*ask, "--excess-phi", "0.01")
    assert "nan" not in capsys.readouterr().out  # what a single packing does not tell
    with (run / "scaling.csv").open() as file:
        excess = [float(row["excess_phi"]) for row in csv.DictReader(file)]
    assert excess == pytest.approx([0.01 / 2.0**n for n in reversed(range(7))], rel=1e-6)
    (fit,) = json.loads((run / "summary.json").read_text())["exponents"]
    assert fit["pressure"] == pytest.approx(1.0, abs=0.1)
    assert fit["pressure_error"] is None  # of a single packing
    assert (run / "scaling.png").stat().st_size > 5_000


@pytest.mark.slow
def test_packings_are_saved(run: Path) -> None:
    """Also those that are in the table already."""
    ask = ("8", "--law", "radical", "--seeds", "2")
    ensemble(*ask)
    assert not (run / "packings").exists()
    ensemble(*ask, "--save")
    rows = jamming.read_table(run / "table.csv")
    folders = sorted((run / "packings").iterdir())
    assert [folder.name for folder in folders] == ["radical_1e-06_8_1", "radical_1e-06_8_2"]
    for row, folder in zip(rows, folders, strict=True):
        with ld.Run(folder).simulation() as sim:
            assert sim.state().phi == pytest.approx(row["phi"], rel=1e-12)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("8", "--law", "sphere", "--tension", "2"), "law sphere has no tension: leave it out"),
        (("8", "--law", "sphere", "--save"), "soft spheres have none: give another --law"),
        (("8", "--law", "droplet", "--excess-phi", "0.04"), "with the droplet law it may be"),
    ],
)
def test_nonsense_is_told(run: Path, words: tuple[str, ...], message: str) -> None:
    with pytest.raises(ld.ParameterError, match=message):
        ensemble(*words)
    assert not run.exists()


def test_names_of_laws_in_tables() -> None:
    assert contact_law("droplet") == ld.Droplet()
    assert contact_law("droplet, tension 2.0") == ld.Droplet(2.0)
    assert contact_law("sphere") == ld.SoftContact()
    assert [dimension_of(name) for name in ("sphere", "disk", "droplet", "radical")] == [3, 2, 3, 2]
    # ten contacts more, of 20 particles that are no rattlers
    for law, least in (("disk", 39), ("sphere", 58)):
        row = {"law": law, "contacts": least + 10, "isostatic": least}
        assert excess_coordination(row) == pytest.approx(1.0)


@pytest.mark.slow
def test_spheres_and_droplets_touch_at_the_same_phi(run: Path) -> None:
    for law in ("sphere", "droplet"):
        ensemble("12", "--law", law, "--seeds", "1", "--pressure", "1e-7")
    rows = jamming.read_table(run / "table.csv")
    assert [row["law"] for row in rows] == ["droplet", "sphere"]
    assert rows[0]["phi"] == pytest.approx(rows[1]["phi"], abs=3e-4)
    assert not any(row["stalled"] for row in rows)

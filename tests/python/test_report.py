"""The folder of a report: what is in it, what is kept after an interruption, what is refused."""

import csv
import json
from pathlib import Path

import lammps_deformable as ld
import pytest
from lammps_deformable.reference import comparison, report
from programs import command

SETTINGS = {"vertices": (19, 38), "strain": 0.01, "steps": 1, "workers": 1}


@pytest.fixture(scope="module")
def start() -> ld.Packing:
    return ld.jam(ld.bidisperse(6, seed=1)).packing


def test_files_of_a_report(tmp_path: Path) -> None:
    """From the shell, of a packing in a file."""
    ld.jam(ld.bidisperse(6, seed=1)).packing.export(tmp_path / "a.xyz")
    words = ("--vertices", "19,38", "--steps", 1, "--strain", 0.01, "--workers", 1, "--out", "new")
    done = command("report", "--from", "a.xyz", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    folder = tmp_path / "new"
    content = json.loads((folder / "report.json").read_text())
    assert content["parameters"]["from_file"] == "a.xyz"
    assert content["parameters"]["vertices"] == [19, 38]
    with (folder / "report.csv").open() as file:
        rows = list(csv.DictReader(file))
    methods = [row["method"] for row in content["rows"]]
    assert [row["method"] for row in rows] == methods
    assert [line.split()[0] for line in done.stdout.splitlines()][1:3] == ["disk", "sector"]
    assert methods[-1] == "reference"
    assert float(rows[-1]["seconds"]) == content["rows"][-1]["seconds"]
    names = {"report.json", "report.csv", "error_against_time.png"}
    assert {path.name for path in folder.iterdir()} == names
    before = (folder / "report.json").read_bytes()
    done = command("report", *words, cwd=tmp_path)
    assert "'new' holds a report: replace it with --overwrite" in done.stderr
    assert (folder / "report.json").read_bytes() == before
    for wrong, told in (
        (("--from", "a.xyz", "--seed", 2), "--seed is about a random one: leave it out"),
        (("--vertices", "many"), "vertices must be whole numbers such as 38,57, not many"),
        (("--dimension", 4), "--dimension must be 2 or 3, not 4"),
        (
            ("--dimension", 3, "--beads", "19"),
            "--beads is about polygons in the plane: leave it out",
        ),
        (("--from-frame", 1), "--from-frame is about the file of a packing: give --from too"),
    ):
        done = command("report", *wrong, "--out", "other", cwd=tmp_path)
        assert told in done.stderr
    assert not (tmp_path / "other").exists()


def test_an_interrupted_report_goes_on(
    start: ld.Packing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Methods that are complete are not measured again."""
    began = []

    def timed(sim: ld.Simulation, *arguments: object) -> object:
        if isinstance(sim.law, ld.Ring):
            began.append(sim.law)
        if len(began) == 3:
            raise KeyboardInterrupt
        return measured(sim, *arguments)

    measured = comparison.timed
    monkeypatch.setattr(comparison, "timed", timed)
    with pytest.raises(KeyboardInterrupt):
        report.write_report(tmp_path, start, **SETTINGS)
    assert [each.name for each in tmp_path.iterdir()] == ["parts"]
    assert len(report.write_report(tmp_path, start, **SETTINGS).rows) == 8
    assert len(began) == 3 + 2  # of four laws that come to rest, two were complete
    assert not (tmp_path / "parts").exists()
    first = (tmp_path / "report.json").read_bytes()
    with pytest.raises(ld.FileError, match="holds a report: replace it with --overwrite"):
        report.write_report(tmp_path, start, **SETTINGS)
    assert (tmp_path / "report.json").read_bytes() == first
    report.write_report(tmp_path, start, overwrite=True, **SETTINGS)
    assert (tmp_path / "report.json").read_bytes() != first  # the seconds


def test_a_run_is_not_replaced(start: ld.Packing, tmp_path: Path) -> None:
    with ld.Simulation(start, ld.Ring()) as sim:
        sim.state().save(tmp_path / "run")
    with pytest.raises(ld.FileError, match="run' holds a run: name another folder"):
        report.write_report(tmp_path / "run", start, overwrite=True)

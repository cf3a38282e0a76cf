"""The command line, as a user sees it."""

import csv
import json
import os
import re
import subprocess
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
import ranks
from lammps_deformable import core
from lammps_deformable.cli import main as cli
from programs import command, program


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    result = command(*arguments, cwd=cwd)
    assert "Traceback" not in result.stdout + result.stderr
    return result


def test_compress_writes_everything_and_goes_further(tmp_path: Path) -> None:
    options = ("--number", "24", "--strain", "0.01", "--steps", "2", "--seed", "3", "--out", "run")
    result = program("deformable", "compress", *options, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    assert "jammed at phi = 0.8" in result.stdout
    out = tmp_path / "run"
    assert {"packing.data", "summary.json", "series.csv", "trajectory.lammpstrj"} <= {
        file.name for file in out.iterdir()
    }
    pytest.importorskip("matplotlib")
    assert (out / "packing.png").stat().st_size > 10_000

    result = run("compress", "--append", "--out", "run", "--steps", "1", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    with (out / "series.csv").open() as file:
        phi = [float(row["phi"]) for row in csv.DictReader(file)]
    assert len(phi) == 4
    assert phi == sorted(phi)
    parameters = json.loads((out / "summary.json").read_text())["parameters"]
    assert parameters["before"]["seed"] == 3


def test_sector_warns_on_one_line(tmp_path: Path) -> None:
    options = ("--number", "16", "--law", "sector", "--strain", "0.02", "--steps", "1")
    result = run("compress", *options, cwd=tmp_path)
    assert result.returncode == 0
    assert result.stderr.startswith("warning: relaxation stalled at phi = 0.")
    assert result.stderr.count("\n") == 1


REFUSED = {
    ("compress", "--number", "8"): [
        (["--number", "0"], ["number", "0"]),
        (["--radii", "0.5", "--seed", "2"], ["--radii", "a valid number"]),
        (["--seed", "--resume"], ["--seed", "a valid integer"]),
        (["--out", "/proc/none"], ["'/proc/none'", "written"]),
        (["--law", "sector", "--kP", "1"], ["sector", "kP = 1"]),
        (["--law", "sector", "--reach", "0.2"], ["--reach", "sector"]),
        (["--law", "sector", "--adhesion", "1"], ["--adhesion", "curved"]),
        (["--law", "sector", "--tension", "1"], ["--tension", "ring laws"]),
        (["--polydispersity", "0.1", "--fraction", "0.2"], ["--polydispersity", "--fraction"]),
        (["--resume", "--out", "nowhere"], ["'nowhere'"]),
        (["--resume", "--append"], ["--resume", "--append", "--overwrite"]),
        (["--tolerance", "2"], ["tolerance", "0.01", "2.0"]),
        (["--aspect", "1000"], ["aspect", "3.95", "1000"]),
        (["--out", ""], ["folder", "''"]),
        (["--out", "/dev/null/run"], ["'/dev/null' is a file"]),
    ],
    ("jam",): [
        (["--pressure", "-1"], ["pressure", "-1.0"]),
        (["--law", "sector", "--reach", "1"], ["--reach is an option of ring laws"]),
    ],
}


def test_errors_are_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In this process, which has loaded what a command loads; before any work."""
    monkeypatch.chdir(tmp_path)
    for start, rows in REFUSED.items():
        for more, words in rows:
            monkeypatch.setattr("sys.argv", ["deformable", *start, *more])
            with pytest.raises(SystemExit) as end:
                cli.main()
            out, error = capsys.readouterr()
            assert (end.value.code, out, error.count("\n")) == (2, "", 1), more
            assert error.startswith("error: ")
            assert [word for word in words if word not in error] == [], error
            assert not list(tmp_path.iterdir())


def test_report_compresses(tmp_path: Path) -> None:
    result = run("report", "--strain", "nan", cwd=tmp_path)
    assert result.returncode == 2
    assert result.stderr.startswith("error: strain ")
    assert result.stderr.endswith("nan\n")


def test_ranks_are_refused(tmp_path: Path) -> None:
    result = launch("report", cwd=tmp_path)
    assert result.returncode != 0
    (line,) = [line for line in result.stderr.splitlines() if line.startswith("error")]
    assert line.startswith("error: report ")
    assert line.endswith(": start it without mpiexec")
    assert "Traceback" not in result.stderr
    assert not list(tmp_path.iterdir())


def launch(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """The command on two ranks."""
    return program("deformable", *arguments, cwd=cwd, ranks=2)


def test_error_on_one_rank_ends_all(tmp_path: Path) -> None:
    """Only rank 0 makes the folder: the other rank must not wait for it for ever."""
    result = launch("compress", "--number", "8", "--out", "/proc/run", cwd=tmp_path)
    assert result.returncode != 0
    assert "error: '/proc/run' cannot be written" in result.stderr
    assert "'/proc/run'" in result.stderr
    assert "Traceback" not in result.stderr


WRONG = {
    "compress --bubbles 3": "error: No such option: --bubbles",
    "compress --number many": "error: Invalid value for '--number': ",
    "bubble": "error: No such command 'bubble'",
    "plot --help": "Usage: deformable plot ",
    "": "Usage: deformable [OPTIONS] COMMAND",
}


def test_ranks_print_once_what_is_wrong(tmp_path: Path) -> None:
    """Commands one after another, in processes that load only once what they need."""
    script = f"""
import sys
from lammps_deformable.cli.main import main
for words in {[*WRONG]}:
    sys.argv = ["deformable", *words.split()]
    try:
        main()
    except SystemExit as end:
        assert (end.code or 0) == (0 if "--help" in words else 2), words
"""
    result = ranks.launch(script, tmp_path, 2)
    assert result.returncode == 0, result.stderr
    for line in WRONG.values():
        assert (result.stdout + result.stderr).count(line) == 1, line
    assert [path.suffix for path in tmp_path.iterdir()] == [".py"]


def test_an_interruption_tells_how_to_go_on(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object, **settings: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(ld.Run, "__init__", interrupted)
    monkeypatch.setattr("sys.argv", ["deformable", "movie", "run"])
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert end.value.code == 130
    found = capsys.readouterr().err
    assert found.startswith("interrupted: ")
    assert "--resume" in found
    assert found.count("\n") == 1


def test_warnings_of_a_command_come_from_any_rank(tmp_path: Path) -> None:
    """Packings are measured on any rank, and only that rank knows of what went wrong there."""
    script = """
import sys, warnings
from mpi4py import MPI
from lammps_deformable.cli import main as cli
@cli.app.command("speak")
def speak():
    if MPI.COMM_WORLD.rank == 1:
        warnings.warn("only here", UserWarning)
    MPI.COMM_WORLD.barrier()
sys.argv = ["deformable", "speak"]
cli.main()
"""
    result = ranks.launch(script, tmp_path, 2)
    assert (result.returncode, result.stderr) == (0, "warning: only here\n")


def test_another_lammps_is_refused_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before its library is loaded, which may bring another MPI."""
    metadata = tmp_path / "lammps-2024.8.29.3.0.dist-info" / "METADATA"
    metadata.parent.mkdir()
    metadata.write_text("Metadata-Version: 2.1\nName: lammps\nVersion: 2024.8.29.3.0\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    for arguments in (("info",), ("compress", "--number", "8", "--out", "run")):
        result = program("deformable", *arguments, cwd=tmp_path)
        assert result.returncode == 2
        (line,) = result.stderr.splitlines()
        assert "this is lammps 2024.8.29.3.0" in line
        assert f"lammps[mpi]=={core.lammps_wheel}" in line


def test_version(tmp_path: Path) -> None:
    result = program("deformable", "--version", cwd=tmp_path)
    assert (result.returncode, result.stdout, result.stderr) == (0, f"{ld.__version__}\n", "")


def test_info_of_a_complete_installation(tmp_path: Path) -> None:
    result = program("deformable", "info", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    source = Path(__file__).parents[3] / "src"  # whose headers name the styles
    names = {
        f"{kind.lower()} style {style}"
        for header in source.rglob("*.h")
        for kind, style in re.findall(r"^(Pair|Fix|Compute)Style\((\S+),", header.read_text(), re.M)
    }
    told = re.findall(r"^(\w+ style) +(\S+): registered$", result.stdout, re.M)
    assert {" ".join(words) for words in told} == names
    assert "the same" in result.stdout


def test_polydispersity(tmp_path: Path) -> None:
    options = ("--number", "16", "--polydispersity", "0.1", "--steps", "1", "--seed", "2")
    result = run("compress", *options, cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    summary = json.loads((tmp_path / "compress" / "summary.json").read_text())
    assert summary["parameters"]["polydispersity"] == 0.1
    with ld.Run(tmp_path / "compress").simulation() as sim:
        radius = sim.state().packing.radii
    assert len(np.unique(radius)) == 16
    # mean 0.5 and standard deviation 0.05 are known to 0.05/sqrt(16) and less
    assert radius.mean() == pytest.approx(0.5, abs=0.05)
    assert radius.std() == pytest.approx(0.05, abs=0.03)
    result = run("compress", "--append", "--steps", "1", cwd=tmp_path)
    assert result.returncode == 0, result.stderr


def test_the_onset_is_saved(tmp_path: Path) -> None:
    done = command("jam", "--number", 12, "--seed", 3, "--law", "radical", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    with ld.Run(tmp_path / "jam").simulation() as sim:
        state = sim.state()
    expected = ld.jam(ld.bidisperse(12, seed=3), ld.Ring(contact="radical"), tolerance=1e-6).packing
    assert state.packing.phi == pytest.approx(expected.phi, rel=1e-9)
    assert f"phi_J = {state.phi:.6g}, " in done.stdout
    assert (tmp_path / "jam" / "packing.png").stat().st_size > 5_000
    done = command("jam", "--number", 12, cwd=tmp_path)
    assert "'jam' holds a run" in done.stderr
    assert "overwrite" in done.stderr


def test_a_run_reaches_its_targets(tmp_path: Path) -> None:
    result = run(
        "compress", "--number", "16", "--steps", "2", "--phi", "0.87", "--out", "run", cwd=tmp_path
    )
    assert result.returncode == 0, result.stderr
    result = run("compress", "--resume", "--phi", "0.87", "--out", "run", cwd=tmp_path)
    assert "is complete" in result.stdout
    result = run("compress", "--resume", "--phi", "0.9", "--out", "run", cwd=tmp_path)
    assert "begun with --phi 0.87, not 0.9" in result.stderr
    given = ("--append", "--pressure", "0.005", "--steps", "1", "--out", "run")
    result = run("compress", *given, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    with (tmp_path / "run" / "series.csv").open() as file:
        *_, reached, last = csv.DictReader(file)
    assert float(reached["phi"]) == pytest.approx(0.87, rel=1e-9)
    assert float(last["pressure"]) == pytest.approx(0.005, rel=1e-6)
    assert ld.Run(tmp_path / "run").parameters["pressure"] == 0.005


def test_steps_that_are_appended_are_counted_on(tmp_path: Path) -> None:
    words = ("compress", "--out", "run", "--steps")
    first = command(*words, 2, "--number", 6, "--strain", 0.02, cwd=tmp_path)
    second = command(*words, 1, "--strain", 0.01, "--append", cwd=tmp_path)
    for done, expected in ((first, [1, 2]), (second, [3])):
        assert done.returncode == 0, done.stderr
        rows = re.findall(r"^ *(\d+) ", done.stdout, re.MULTILINE)
        assert list(map(int, rows)) == expected

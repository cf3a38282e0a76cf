"""The command line, as a user sees it."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest

COMMAND = str(Path(sys.executable).parent / "deformable")


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    result = subprocess.run(
        [COMMAND, *arguments], cwd=cwd, capture_output=True, text=True, timeout=120, check=False
    )
    assert "Traceback" not in result.stdout + result.stderr
    return result


def test_compress_writes_everything_and_resumes(tmp_path: Path) -> None:
    options = ("--number", "24", "--strain", "0.01", "--steps", "2", "--seed", "3", "--out", "run")
    result = run("compress", *options, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    assert "jammed at phi = 0.8" in result.stdout
    out = tmp_path / "run"
    assert {"packing.data", "summary.json", "series.csv", "trajectory.lammpstrj"} <= {
        file.name for file in out.iterdir()
    }
    pytest.importorskip("matplotlib")
    assert (out / "packing.png").stat().st_size > 10_000

    result = run("compress", "--resume", "--out", "run", "--steps", "1", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    with (out / "series.csv").open() as file:
        phi = [float(row["phi"]) for row in csv.DictReader(file)]
    assert len(phi) == 3
    assert phi == sorted(phi)
    parameters = json.loads((out / "summary.json").read_text())["parameters"]
    assert parameters["before"]["seed"] == 3


def test_sector_warns_on_one_line(tmp_path: Path) -> None:
    options = ("--number", "16", "--law", "sector", "--strain", "0.02", "--steps", "1")
    result = run("compress", *options, cwd=tmp_path)
    assert result.returncode == 0
    assert result.stderr.startswith("warning: relaxation stalled at phi = 0.")
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--number", "0"], "error: number must be at least 1, not 0"),
        (["--strain", "2"], "error: strain must lie between -1 and 1, not 2.0"),
        (["--kP", "1"], "error: the ring law keeps the perimeter: kP must be inf, not 1.0"),
        (["--law", "sector", "--kP", "1"], "error: Sector needs one positive stiffness"),
        (["--resume", "--out", "nowhere"], "error: no saved run in 'nowhere'"),
        (["--resume", "--seed", "2"], "law in 'compress': leave out --seed"),
        (["--steps", "0"], "error: steps must be at least 1, not 0"),
        (["--out", "/dev/null/run"], "error: [Errno 20] Not a directory: '/dev/null/run'"),
        (["--number", "many"], "Invalid value for '--number'"),
        (["--bubbles", "3"], "No such option"),
    ],
)
def test_errors_are_one_line(arguments: list[str], message: str, tmp_path: Path) -> None:
    number = () if "--resume" in arguments else ("--number", "8")
    result = run("compress", *number, *arguments, cwd=tmp_path)
    assert result.returncode == 2
    assert message in result.stderr
    if message.startswith("error"):
        assert result.stderr.count("\n") == 1


def test_error_on_one_rank_ends_all(tmp_path: Path) -> None:
    """Only rank 0 makes the folder: the other one must not wait for it for ever."""
    mpiexec = str(Path(sys.executable).parent / "mpiexec")
    options = ("--number", "8", "--out", "/dev/null/run")
    result = subprocess.run(
        [mpiexec, "-n", "2", COMMAND, "compress", *options],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert result.returncode != 0
    assert "error: [Errno 20] Not a directory: '/dev/null/run'" in result.stderr
    assert "Traceback" not in result.stderr


def test_info_says_that_all_is_well(tmp_path: Path) -> None:
    result = run("info", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    for style in ("ring", "sector", "wall", "polygon", "stick"):
        assert f"deformable/{style}: registered" in result.stdout
    assert "the same" in result.stdout

"""`deformable compress` to a packing fraction or a pressure."""

import csv
import subprocess
from pathlib import Path

import lammps_deformable as ld
import pytest
from programs import command

SMALL = ("--number", "16", "--steps", "2")


def compress(*options: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    result = command("compress", *options, cwd=cwd)
    assert "Traceback" not in result.stdout + result.stderr
    return result


def test_a_run_reaches_its_targets(tmp_path: Path) -> None:
    result = compress(*SMALL, "--phi", "0.87", "--out", "run", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    result = compress("--resume", "--phi", "0.87", "--out", "run", cwd=tmp_path)
    assert "is complete" in result.stdout
    result = compress("--resume", "--phi", "0.9", "--out", "run", cwd=tmp_path)
    assert "begun with --phi 0.87, not 0.9" in result.stderr
    given = ("--append", "--pressure", "0.005", "--steps", "1", "--out", "run")
    result = compress(*given, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    with (tmp_path / "run" / "series.csv").open() as file:
        *_, reached, last = csv.DictReader(file)
    assert float(reached["phi"]) == pytest.approx(0.87, rel=1e-9)
    assert float(last["pressure"]) == pytest.approx(0.005, rel=1e-6)
    assert ld.Run(tmp_path / "run").parameters["pressure"] == 0.005

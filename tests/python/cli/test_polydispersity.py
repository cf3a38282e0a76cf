"""The option --polydispersity."""

import json
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from test_main import run


def test_command_line(tmp_path: Path) -> None:
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

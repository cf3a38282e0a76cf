"""The command `deformable jam`: one packing at its onset."""

from pathlib import Path

import lammps_deformable as ld
import pytest
from programs import command


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

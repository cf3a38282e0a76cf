"""Recorded compressions to a packing fraction or a pressure."""

from pathlib import Path

import lammps_deformable as ld
import pytest


def test_a_run_goes_on_to_another_target(jammed: ld.Packing, tmp_path: Path) -> None:
    sim = ld.Simulation(jammed, ld.Ring())
    run = sim.compress(record=tmp_path, phi=0.86)
    before = len(run)
    sim = run.simulation()
    further = sim.compress(pressure=1e-3, steps=2, record=tmp_path, mode="a")
    assert further[-1].pressure == pytest.approx(1e-3, rel=1e-6)
    run = ld.Run(tmp_path)
    assert len(run) == before + 2
    assert run.parameters["pressure"] == 1e-3
    assert run.parameters["before"]["phi"] == 0.86
    with pytest.raises(ld.ParameterError, match="give one of strain, phi, pressure"):
        sim.compress(strain=0.01, phi=0.9, record=tmp_path, mode="a")
    same = sim.compress(pressure=1e-3, record=tmp_path, mode="a")
    assert (len(run), len(same)) == (before + 2, 1)
    assert len(run.resume()) == before + 2

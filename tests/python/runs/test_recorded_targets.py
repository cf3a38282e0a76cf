"""Recorded compressions to a packing fraction or a pressure."""

from pathlib import Path

import lammps_deformable as ld
import pytest

FILES = ("packing.data", "summary.json", "series.csv", "trajectory.lammpstrj")


@pytest.mark.parametrize(("name", "target"), [("phi", 0.87), ("pressure", 1e-3)])
def test_a_resumed_run_has_the_files_of_a_whole_one(
    jammed: ld.Packing, name: str, target: float, tmp_path: Path
) -> None:
    for folder in ("whole", "parts"):
        sim = ld.Simulation(jammed, ld.Ring())
        states = sim.compress(record=tmp_path / folder, steps=3, **{name: target})[1:]
        if folder == "whole":
            *_, last = states
        else:
            next(states)
            states.close()
            assert len(list(ld.Run(tmp_path / folder).resume())) == 2
    assert getattr(last, name) == pytest.approx(target, rel={"phi": 1e-9, "pressure": 1e-6}[name])
    for file in FILES:
        whole, parts = ((tmp_path / folder / file).read_bytes() for folder in ("whole", "parts"))
        assert whole == parts


def test_a_run_goes_on_to_another_target(jammed: ld.Packing, tmp_path: Path) -> None:
    sim = ld.Simulation(jammed, ld.Ring())
    sim.compress(record=tmp_path, phi=0.86)
    run = ld.Run(tmp_path)
    before = len(run)
    states = list(run.compress(pressure=1e-3, steps=2))
    assert states[-1].pressure == pytest.approx(1e-3, rel=1e-6)
    assert len(run) == before + 2
    assert run.parameters["pressure"] == 1e-3
    assert run.parameters["before"]["phi"] == 0.86
    with pytest.raises(ld.ParameterError, match="give one of strain, phi, pressure"):
        run.compress(0.01, phi=0.9)
    (same,) = run.compress(pressure=1e-3, steps=1)
    assert same.packing.box == pytest.approx(states[-1].packing.box, rel=1e-6)
    assert run[-1].pressure == pytest.approx(1e-3, rel=1e-6)
    assert len(run) == before + 3

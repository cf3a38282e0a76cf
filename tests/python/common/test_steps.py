"""A protocol that is called and not iterated says so."""

import warnings
from pathlib import Path

import lammps_deformable as ld
import pytest


@pytest.mark.parametrize("protocol", ["compress", "shear", "move", "record", "compress_in"])
def test_a_call_that_does_nothing_warns(protocol: str, state: ld.State, tmp_path: Path) -> None:
    with ld.Simulation(state.packing, state.law) as sim:
        calls = {
            "compress": lambda: sim.compress(strain=0.001, steps=2)[1:],
            "shear": lambda: sim.shear(0.001, steps=2)[1:],
            "move": lambda: sim.run(10)[1:],
            "record": lambda: ld.record([state], tmp_path),
            "compress_in": lambda: sim.compress(record=tmp_path / "run", strain=0.001, steps=2)[1:],
        }
        said = rf"^{protocol} has done nothing: .*list\({protocol}"
        with pytest.warns(RuntimeWarning, match=said):
            calls[protocol]()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            if protocol != "compress_in":
                assert next(calls[protocol]())


def test_nothing_is_written_before_the_first_step(state: ld.State, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    with ld.Simulation(state.packing, state.law) as sim:
        with pytest.warns(RuntimeWarning, match="^compress_in has done nothing"):
            sim.compress(record=folder, strain=0.001, steps=2)
        assert not folder.exists()
        sim.compress(record=folder, strain=0.001, steps=2)
    run = ld.Run(folder)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    with pytest.warns(RuntimeWarning, match=r"^Run\.compress has done nothing"):
        run.compress(0.001, 2)
    with pytest.warns(RuntimeWarning, match=r"^Run\.shear has done nothing"):
        run.shear(0.001, 2)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    assert len(list(run.compress(0.001, 1))) == 1
    assert len(run) == 4

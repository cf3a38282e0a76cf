"""A protocol that is called and not iterated says so."""

import warnings
from pathlib import Path

import deformable
import pytest


@pytest.mark.parametrize("protocol", ["compress", "shear", "move", "record", "compress_in"])
def test_a_call_that_does_nothing_warns(
    protocol: str, state: deformable.State, tmp_path: Path
) -> None:
    with deformable.Simulation(state.packing, state.law) as sim:
        calls = {
            "compress": lambda: deformable.compress(sim, 0.001, 2),
            "shear": lambda: deformable.shear(sim, 0.001, 2),
            "move": lambda: deformable.move(sim, 10),
            "record": lambda: deformable.record([state], tmp_path),
            "compress_in": lambda: deformable.compress_in(sim, tmp_path / "run", 0.001, 2),
        }
        said = rf"^{protocol} has done nothing: .*list\({protocol}"
        with pytest.warns(RuntimeWarning, match=said):
            calls[protocol]()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            if protocol != "compress_in":
                assert next(calls[protocol]())

"""Frame 0 of a run is the state before the first step."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest

PROTOCOLS: dict[str, Callable[..., ld.Run]] = {
    "strain": lambda sim, **how: sim.compress(strain=0.004, steps=2, **how),
    "phi": lambda sim, **how: sim.compress(phi=0.9, steps=2, **how),
    "shear": lambda sim, **how: sim.shear(0.004, steps=2, **how),
    "run": lambda sim, **how: sim.run(20, temperature=1e-6, every=10, seed=1, **how),
}


@pytest.fixture
def sim(jammed: ld.Packing) -> Iterator[ld.Simulation]:
    with ld.Simulation(jammed.at(0.88), ld.Ring()) as sim:
        yield sim


@pytest.mark.parametrize(
    ("name", "recorded"), [("strain", True), ("phi", False), ("shear", True), ("run", False)]
)
def test_of_a_protocol(
    name: str, recorded: bool, sim: ld.Simulation, jammed: ld.Packing, tmp_path: Path
) -> None:
    """It is the start itself, relaxed or with velocities as the first step finds it."""
    before = sim.relax() if name == "phi" else sim.state()
    seen: list[Any] = []
    record = tmp_path / "run" if recorded else None
    run = PROTOCOLS[name](sim, record=record, callback=seen.append)
    assert (len(seen), len(run)) == (2, 3)
    assert np.array_equal(run[0].packing.box, before.packing.box)
    # a state at rest stays: LAMMPS only takes particles back into the box, which rounds
    moved = np.abs(run[0].packing.positions - before.packing.positions).max()
    assert moved <= (1e-14 if name == "phi" else 0.0)
    assert run[0].shear_strain == (0.0 if name == "shear" else None)
    assert (run[0].time, run[0].temperature > 0.0) == (0.0, name == "run")
    assert [state.energy for state in run[1:]] == [state.energy for state in seen]
    assert run.parameters["protocol"] == ("compress" if name in ("strain", "phi") else name)
    with ld.Simulation(jammed.at(0.88), ld.Ring()) as sim:
        last = PROTOCOLS[name](sim, keep=False, record=tmp_path / "last" if recorded else None)
    assert len(last) == 1
    assert last[0].packing.phi == pytest.approx(run[-1].packing.phi, rel=1e-12)


def test_is_not_written_twice(sim: ld.Simulation, tmp_path: Path) -> None:
    """Nor by a run that goes on; but in a folder that has no frames."""
    folder = tmp_path / "saved"
    sim.state().save(folder)
    run = ld.Run(folder)
    assert len(sim.compress(strain=0.002, record=folder, mode="a")) == 2
    assert len(sim.shear(0.002, record=folder, mode="a")) == 2
    further = run.simulation().compress(strain=0.002, record=folder, mode="a")
    assert (len(run), len(further)) == (4, 2)
    assert further[0].phi == run[2].phi
    phi = [state.phi for state in run]
    assert phi == sorted(phi)

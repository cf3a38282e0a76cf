"""Frame 0 of a record is the state before the first step."""

from collections.abc import Callable, Iterator
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest

Protocol = Callable[[ld.Simulation], Iterator[ld.State]]

PROTOCOLS: dict[str, Protocol] = {
    "strain": lambda sim: sim.compress(strain=0.004, steps=2)[1:],
    "phi": lambda sim: sim.compress(phi=0.9, steps=2)[1:],
    "shear": lambda sim: sim.shear(0.004, steps=2)[1:],
    "move": lambda sim: sim.run(20, temperature=1e-6, every=10, seed=1)[1:],
}


@pytest.fixture
def sim(jammed: ld.Packing) -> Iterator[ld.Simulation]:
    with ld.Simulation(jammed.at(0.88), ld.Ring()) as sim:
        yield sim


@pytest.mark.parametrize("name", PROTOCOLS)
def test_of_a_protocol(name: str, sim: ld.Simulation, tmp_path: Path) -> None:
    """It is the start itself, relaxed or with velocities as the first step finds it."""
    before = sim.relax() if name == "phi" else sim.state()
    states = list(ld.record(PROTOCOLS[name](sim), tmp_path))
    run = ld.Run(tmp_path)
    assert (len(states), len(run)) == (2, 3)
    assert np.array_equal(run[0].packing.box, before.packing.box)
    assert np.array_equal(run[0].packing.positions, before.packing.positions)
    assert run[0].strain == (0.0 if name == "shear" else None)
    assert (run[0].time, run[0].temperature > 0.0) == (0.0, name == "move")
    assert run[1].energy == pytest.approx(states[0].energy, rel=1e-6)


def test_steps_are_those_without_a_record(jammed: ld.Packing, tmp_path: Path) -> None:
    """A heat bath has the same velocities and noise."""
    ends = []
    for recorded in (False, True):
        with ld.Simulation(jammed, ld.Ring()) as sim:
            steps = sim.run(20, temperature=1e-6, drag=0.1, seed=1)[1:]
            *_, last = ld.record(steps, tmp_path) if recorded else steps
        ends.append(last)
    assert np.array_equal(*(end.packing.positions for end in ends))
    assert np.array_equal(*(end.velocities for end in ends))


def test_is_not_written_twice(sim: ld.Simulation, tmp_path: Path) -> None:
    """Not by append, nor by a run that goes on; but in a folder that has no frames."""
    folder = tmp_path / "saved"
    sim.state().save(folder)
    run = ld.Run(folder)
    list(run.append(sim.compress(strain=0.002)[1:]))
    assert len(run) == 2
    list(run.append(sim.shear(0.002)[1:]))
    list(run.compress(0.002, 1))
    assert len(run) == 4
    sim.state().save(tmp_path / "other")
    other = ld.Run(tmp_path / "other")
    next(other.compress(0.002, 2))
    assert (len(other), other.steps_done) == (2, 1)
    assert len(list(other.resume())) == 1
    phi = [state.phi for state in other]
    assert len(phi) == 3
    assert phi == sorted(phi)


def test_of_states_that_know_no_start(sim: ld.Simulation, tmp_path: Path) -> None:
    """It is the first of a list, or the next one of a protocol that has begun."""
    steps = sim.compress(strain=0.004, steps=2)[1:]
    first = next(steps)
    list(ld.record(steps, tmp_path / "rest"))
    list(ld.record([first], tmp_path / "list"))
    assert len(ld.Run(tmp_path / "rest")) == len(ld.Run(tmp_path / "list")) == 1
    assert ld.Run(tmp_path / "rest")[0].phi > first.phi + 0.001
    assert ld.Run(tmp_path / "list")[0].phi == pytest.approx(first.phi, rel=1e-6)

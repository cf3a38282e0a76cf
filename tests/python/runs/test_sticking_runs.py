"""Recorded runs of droplets that stick: which ones are attached comes back."""

import math
from dataclasses import replace
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from mpi4py import MPI
from protocol_helpers import Stop, stop_after

LAW = ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact="curved", adhesion=[[0.3, 0.1], [0.1, 0.2]])


@pytest.fixture(scope="module")
def start() -> ld.State:
    jammed = ld.jam(ld.bidisperse(12, seed=2)).packing
    with ld.Simulation(jammed.at(0.85), LAW, comm=MPI.COMM_SELF) as sim:
        return sim.relax()


def assert_same(states: list[ld.State], others: list[ld.State]) -> None:
    assert len(states) == len(others)
    for state, other in zip(states, others, strict=True):
        assert state.films is not None
        assert other.films is not None
        assert len(state.films) > 0
        assert state.films.tolist() == other.films.tolist()
        assert state.energy == pytest.approx(other.energy, rel=1e-9)


def test_replay(start: ld.State, tmp_path: Path) -> None:
    """Of a hot motion, in which droplets attach, stretch and let go."""
    with ld.Simulation(start, LAW, comm=MPI.COMM_SELF) as sim:
        states: list[ld.State] = []
        how = {"record": tmp_path, "callback": states.append}
        run = sim.run(400, temperature=0.05, every=100, seed=1, **how)
    lost = [state.lost_energy for state in states]
    assert (np.diff(lost) > 0.0).all()
    assert [state.lost_energy for state in run] == [0.0, *lost]
    assert run.simulation(MPI.COMM_SELF).state().lost_energy == pytest.approx(lost[-1], rel=1e-12)
    assert_same(states, run[1:])
    with run.simulation(MPI.COMM_SELF) as sim:
        assert_same(states[-1:], [sim.state()])
    assert any(stretched(state) for state in states)  # or positions would be enough


def stretched(state: ld.State) -> bool:
    """Whether any pair is attached beyond the touch of circles."""
    table = state.contacts[state.contacts["attached"]]
    return bool(
        (
            table["distance"] > state.packing.radii[table["i"]] + state.packing.radii[table["j"]]
        ).any()
    )


def test_resume(start: ld.State, tmp_path: Path) -> None:
    """An interrupted shear goes on with the numbers of a whole one."""
    whole, part = tmp_path / "whole", tmp_path / "part"
    with ld.Simulation(start, LAW, comm=MPI.COMM_SELF) as sim:
        states: list[ld.State] = []
        how = {"record": whole, "callback": states.append}
        sim.shear(0.1, steps=3, tolerance=1e-3, **how)
    with ld.Simulation(start, LAW, comm=MPI.COMM_SELF) as sim, pytest.raises(Stop):
        sim.shear(0.1, record=part, steps=3, tolerance=1e-3, callback=stop_after(1))
    resumed = ld.Run(part).resume(comm=MPI.COMM_SELF)
    assert [state.energy for state in resumed[1:]] == [state.energy for state in states]
    assert_same(states, ld.Run(whole)[1:])


def test_a_saved_state_keeps_what_films_have_lost(start: ld.State, tmp_path: Path) -> None:
    replace(start, lost_energy=0.25).save(tmp_path)
    with ld.Run(tmp_path).simulation(MPI.COMM_SELF) as sim:
        assert sim.state().lost_energy == 0.25

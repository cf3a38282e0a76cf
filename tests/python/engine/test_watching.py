"""Callbacks see relaxations, and their exceptions end them."""

import ast
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.engine.relax import Iteration
from ranks import python


@pytest.fixture(scope="module")
def dense(jammed: ld.Packing) -> ld.Packing:
    return jammed.at(0.9)


def test_a_relaxation_is_seen(dense: ld.Packing) -> None:
    """From its start to the state that it returns, which is the same without a callback."""
    seen: list[Iteration] = []
    with ld.Simulation(dense, ld.Ring(kP=2.0, skin=0.02)) as sim:
        unseen = sim.relax(1e-8)
        sim.reset(dense)
        sim.callback = seen.append
        state = sim.relax(1e-8)
        sim.callback = None
        sim.relax(1e-9)
    assert np.array_equal(state.packing.positions, unseen.packing.positions)
    iterations = [each.iterations for each in seen]
    assert iterations[0] == 0
    assert iterations == sorted(set(iterations))
    assert len(iterations) >= 2
    assert {each.protocol for each in seen} == {"relax"}
    assert all(each.root for each in seen)
    assert seen[0].residual > 1e-8 >= seen[-1].residual == state.residual
    assert seen[-1].phi == pytest.approx(state.phi, rel=1e-14)
    assert seen[-1].pressure == pytest.approx(state.pressure, rel=1e-14)


def test_walls_leave_the_free_area() -> None:
    room = ld.bidisperse(12, phi=0.86, seed=1).between(ld.BoxWall((4, 4)))
    seen: list[Iteration] = []
    with ld.Simulation(room.push_off(), ld.Ring()) as sim:
        sim.callback = seen.append
        state = sim.relax(1e-3)
    assert seen[-1].phi == pytest.approx(state.phi, rel=1e-14)
    assert seen[-1].pressure == pytest.approx(state.pressure, rel=1e-14)


def test_an_exception_ends_a_relaxation_at_rest(dense: ld.Packing) -> None:
    def stop(seen: Iteration) -> None:
        if seen.iterations:
            raise StopIteration("enough")

    with ld.Simulation(dense, ld.Ring()) as sim:
        sim.callback = stop
        with pytest.raises(StopIteration, match="enough"):
            sim.relax(1e-10)
        assert not sim.state().velocities.any()
        with pytest.raises(StopIteration, match="enough"):
            sim.relax(pressure=1e-3)
        sim.callback = None
        assert sim.relax().residual <= 1e-6


@pytest.mark.parametrize(("law", "free"), [(ld.Ring(), "iso"), (None, "aniso")], ids=str)
def test_jamming_is_seen(law: ld.Ring | None, free: str) -> None:
    loose = ld.bidisperse(8, seed=2)
    seen: list[Iteration] = []
    given = {"law": law, "pressure": 1e-4, "free": free}
    jammed = ld.jam(loose, **given, callback=seen.append).packing
    assert np.array_equal(jammed.positions, ld.jam(loose, **given).packing.positions)
    assert {each.protocol for each in seen} == {"jam"}
    iterations = [each.iterations for each in seen]
    assert len({each.phi for each in seen}) > 3
    assert iterations == sorted(iterations)
    assert np.isfinite([each[1:] for each in seen if np.isfinite(each.residual)]).all()
    assert seen[-1].phi == pytest.approx(jammed.phi, rel=0.01)
    assert 1e-4 * (1.0 - 1e-6) <= seen[-1].pressure <= 2e-4

    def stop(seen: Iteration) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ld.jam(loose, **given, callback=stop)


def test_steps_of_newton_are_seen(state: ld.State) -> None:
    seen: list[Iteration] = []
    with ld.Simulation(state, state.law) as sim:
        sim.callback = seen.append
        fine = sim.relax(1e-10)
    assert min(each.residual for each in seen) == fine.residual <= 1e-10
    assert {each.protocol for each in seen} == {"relax"}


def test_what_cannot_be_called(state: ld.State) -> None:
    told = "callback must be a function of an Iteration, such as .*, or None, not "
    with ld.Simulation(state.packing, state.law) as sim:
        with pytest.raises(ld.ParameterError, match=told):
            sim.callback = "print"
        assert sim.callback is None
    with pytest.raises(ld.ParameterError, match=told):
        ld.jam(ld.bidisperse(8, seed=1), callback="print")


FAILS = """
from mpi4py import MPI
import lammps_deformable as ld

rank = MPI.COMM_WORLD.rank

def fail(seen):
    if rank == 1 and seen.iterations:
        raise ValueError("on one rank")

def outcome(call):
    try:
        call()
    except Exception as error:
        return str(error)

start = ld.jam(ld.bidisperse(16, seed=1)).packing.at(0.9)
sim = ld.Simulation(start, ld.Ring())
sim.callback = fail
relaxed = outcome(sim.relax)
loose = ld.bidisperse(24, seed=1)
shared = outcome(lambda: ld.jam(loose, comm=MPI.COMM_WORLD, callback=fail).packing)
sim.callback = None
told = MPI.COMM_WORLD.gather([relaxed, shared, sim.relax().residual <= 1e-6])
if rank == 0:
    print(told)
"""


def test_an_exception_of_one_rank_ends_all(tmp_path: Path) -> None:
    printed = python(FAILS, cwd=tmp_path, ranks=2)
    first = ["the callback of relax failed on rank 1", "the callback of jam failed on rank 1", True]
    assert ast.literal_eval(printed) == [first, ["on one rank", "on one rank", True]]

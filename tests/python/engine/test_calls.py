"""A simulation is in one call at a time, of one thread and of all of its ranks."""

import copy
import pickle
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import pytest
from each_simulation import MAKERS, PLANE
from lammps_deformable import Ring, Simulation
from programs import program


@pytest.mark.parametrize(
    ("name", "way"),
    [("rings", pickle.dumps), ("rings", copy.copy), ("polygons", copy.deepcopy)],
)
def test_no_copies(name: str, way: Callable[[Any], Any]) -> None:
    with MAKERS[name]() as sim:
        told = rf"\Aa {type(sim).__name__} cannot be pickled or copied, [^\n]*state\(\)\Z"
        with pytest.raises(ld.ParameterError, match=told):
            way(sim)
        state = sim.state()
        assert copy.deepcopy(pickle.loads(pickle.dumps(state))).energy == state.energy


def stopped(sim: Any) -> tuple[threading.Thread, threading.Event]:
    """A thread in a call of LAMMPS, until the event."""
    inside, leave = threading.Event(), threading.Event()

    def wait(*_: object) -> None:
        inside.set()
        leave.wait(60)

    def call() -> None:
        sim.lmp.command("fix pause all external pf/callback 1 1")
        sim.lmp.set_fix_external_callback("pause", wait, None)
        sim.lmp.command("run 0")

    thread = threading.Thread(target=call)
    thread.start()
    assert inside.wait(60)
    return thread, leave


@pytest.mark.parametrize("name", ["rings", "polygons"])
def test_another_thread_is_refused(name: str) -> None:
    with MAKERS[name]() as sim:
        energy = sim.state().energy
        thread, leave = stopped(sim)
        lmp = sim._lmp  # as a user who keeps it
        calls: list[Callable[[], Any]] = [
            sim.relax,
            sim.state,
            sim.close,
            lambda: sim.box,
            lambda: sim.lmp,
            lambda: sim.deform(PLANE.box),
            lambda: lmp.command("run 0"),
            lambda: lmp.commands_string("run 0"),
            lambda: lmp.commands_list(["run 0"]),
        ]
        try:
            for call in calls:
                told = r"\A[^\n]* is asked for while another thread is in a call [^\n]*\Z"
                with pytest.raises(ld.CallError, match=told):
                    call()
        finally:
            leave.set()
            thread.join()
        sim.lmp.command("unfix pause")
        assert sim.state().energy == pytest.approx(energy, abs=1e-9)  # one after the other


def test_threads_relax_one_simulation(jammed: ld.Packing) -> None:
    with Simulation(jammed.at(0.87), Ring()) as sim, Simulation(jammed.at(0.87), Ring()) as alone:
        found: list[float] = []
        errors: list[Exception] = []

        def relax() -> None:
            try:
                found.append(sim.relax().energy)
            except ld.CallError as error:
                errors.append(error)

        threads = [threading.Thread(target=relax) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(found) + len(errors) == 4
        assert found[0] == pytest.approx(alone.relax().energy, rel=1e-9)


def test_threads_with_simulations_of_their_own(jammed: ld.Packing) -> None:
    """And one that a restart gave to another LAMMPS is still one."""
    found: list[float] = []

    def relax() -> None:
        with Simulation(jammed, Ring()) as sim:
            sim.reset(jammed.at(0.87))
            found.append(sim.relax().energy)

    threads = [threading.Thread(target=relax) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(set(found)) == 1


# each rank has a file for its errors, as mpiexec may mix their lines
ALONE = """
import sys
import lammps_deformable as ld
from mpi4py import MPI
rank = MPI.COMM_WORLD.rank
sys.stderr = open(f"errors{{rank}}", "w", buffering=1)
packing = ld.crystal("hex", (4, 2), phi=0.92)
if {made}:
    sim = ld.Simulation(packing, ld.Ring())
{calls}
"""
MISTAKES = {
    "another call": (
        "True",
        "if rank == 0: sim.relax()\nsim.state()",
        "rank 0 calls Simulation.relax and rank 1 Simulation.state",
    ),
    "a command": (
        "True",
        "if rank == 1: sim.lmp.command('run 0')\nsim.state()",
        "rank 0 calls Simulation.state and rank 1 the command run",
    ),
    "another law": (
        "False",
        "ld.Simulation(packing, ld.Ring(kA=1.0 + rank))",
        "ranks 0 and 1 give other arguments to a simulation",
    ),
    "another argument": (
        "True",
        "sim.compress(strain=0.01 + 0.01 * rank)",
        "ranks 0 and 1 give other arguments to Simulation.compress",
    ),
    "another value of a command": (
        "True",
        "sim.lmp.command(f'timestep 0.{rank + 1}')",
        "ranks 0 and 1 give other arguments to the command timestep",
    ),
    "a rank that fails": (
        "True",
        "if rank == 1: raise ValueError('mine')\nsim.compress(strain=0.01, steps=2)",
        "rank 1 has ended without the call Simulation.compress",
    ),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_one_rank_alone(name: str, tmp_path: Path) -> None:
    """Without the care of mpi4py, which ends all ranks where one of them fails."""
    made, calls, told = MISTAKES[name]
    (tmp_path / "script.py").write_text(ALONE.format(made=made, calls=calls))
    result = program("python", "script.py", cwd=tmp_path, ranks=2, timeout=60)
    assert result.returncode != 0
    errors = "".join(file.read_text() for file in tmp_path.glob("errors*"))
    lines = [line for line in errors.splitlines() if "CallError: " in line]
    assert len(lines) in (1, 2), errors
    for line in lines:
        assert line.partition("CallError: ")[2].startswith(told), errors
        assert line.endswith("comm=MPI.COMM_SELF")


LATE = """
import time
import lammps_deformable as ld
from mpi4py import MPI
rank = MPI.COMM_WORLD.rank
sim = ld.Simulation(ld.crystal("hex", (4, 2), phi=0.92), ld.Ring())
if rank == 1:
    time.sleep(1.5)
first = sim.relax()
if rank == 0:
    time.sleep(1.5)
half = MPI.COMM_WORLD.Split(rank == 2, rank)
own = ld.Simulation(first, ld.Ring(), comm=half)
if rank < 2:
    print(abs(own.state().energy / first.energy - 1.0) < 1e-12, flush=True)
"""


def test_a_busy_rank_is_waited_for(tmp_path: Path) -> None:
    """Rank 2 has ended long since when the other two go on with a simulation of their own."""
    (tmp_path / "script.py").write_text(LATE)
    result = program("python", "script.py", cwd=tmp_path, ranks=3, timeout=60)
    assert (result.returncode, result.stdout.count("True")) == (0, 2), result.stderr

"""Ctrl-C ends long commands of LAMMPS at their next step; a simulation goes on after it."""

import os
import signal
import threading
import time
from collections.abc import Callable

import lammps_deformable as ld
import pytest
from mpi4py import MPI


@pytest.fixture(autouse=True)
def _default_handler() -> None:
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def interrupted(work: Callable[[], object]) -> float:
    """Seconds from Ctrl-C to its exception; the work takes far longer."""
    sent = 0.0

    def press() -> None:
        nonlocal sent
        sent = time.monotonic()
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.3, press)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        timer.cancel()
    return time.monotonic() - sent


def test_a_block_of_a_motion_ends_at_once() -> None:
    packing = ld.bidisperse(20, phi=0.7, seed=1).push_off()
    with ld.Simulation(packing, ld.Ring(), comm=MPI.COMM_SELF) as sim:
        # the block takes 20 minutes
        assert interrupted(lambda: sim.run(10**8, timestep=0.01, temperature=1e-6, seed=1)) < 2.0
        steps = sim.lmp.extract_global("ntimestep")
        assert 0 < steps < 10**8
        assert sim.time == pytest.approx(0.01 * steps, rel=1e-12)
        state = sim.run(100, timestep=0.01)[-1]
        assert state.time == pytest.approx(0.01 * (steps + 100), rel=1e-12)
        assert sim.relax().residual <= 1e-6


def test_a_minimization_ends_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lammps_deformable.engine.engines.Deformables.patience", 10**8)
    monkeypatch.setattr("lammps_deformable.engine.relax._ITERATIONS", 10**8)
    packing = ld.bidisperse(20, phi=0.7, seed=1).push_off()
    with ld.Simulation(packing, ld.Ring(), comm=MPI.COMM_SELF) as sim:
        sim.lmp.command("fix down all addforce 0 1e-6 0")  # a fall without end
        assert interrupted(sim.relax) < 2.0
        monkeypatch.undo()
        sim.lmp.command("unfix down")
        assert sim.relax().residual <= 1e-6


class Late(Exception):
    """Of a handler; without a message."""


def test_exceptions_of_other_signals_arrive() -> None:
    """As they are, and no minimizer takes them for a failure."""

    def late(*_: object) -> None:
        raise Late

    packing = ld.bidisperse(20, phi=0.7, seed=1).push_off()
    former = signal.signal(signal.SIGALRM, late)
    try:
        with ld.Simulation(packing, ld.Ring(), comm=MPI.COMM_SELF) as sim:
            for work in (
                lambda: sim.run(2_000_000, timestep=0.01, temperature=1e-6, seed=1),
                lambda: sim.lmp.command("run 2000000"),
            ):
                signal.setitimer(signal.ITIMER_REAL, 0.05)
                with pytest.raises(Late):
                    work()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, former)

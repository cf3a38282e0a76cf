"""Threads with a simulation each: all of them run, and warnings stay those of the process."""

import random
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import lammps_deformable as ld
import pytest
from mpi4py import MPI

PACKING = ld.crystal("hex", (4, 2), phi=0.92)
THREADS = 3


def in_threads(work: Callable[[int], object], times: int) -> None:
    with ThreadPoolExecutor(THREADS) as pool:
        list(pool.map(work, range(times)))


def open_and_close(seed: int) -> None:
    """For a while that differs from thread to thread, between jobs of the others."""
    with ld.Simulation(PACKING, ld.Ring(), comm=MPI.COMM_SELF) as sim:
        for _ in range(random.Random(seed).randrange(4)):
            sim.reset(sim.state())


def squeeze(seed: int) -> None:
    with ld.Simulation(PACKING, ld.Ring(), comm=MPI.COMM_SELF) as sim:
        for pressure in (1e-4, 1e-3):
            assert sim.relax(pressure=pressure).pressure == pytest.approx(pressure, rel=1e-5)


def test_warnings_are_those_of_the_process() -> None:
    squeeze(0)  # imports may add filters
    before = list(warnings.filters), warnings.showwarning
    in_threads(squeeze, 6)
    assert (list(warnings.filters), warnings.showwarning) == before
    with pytest.warns(UserWarning, match="of a user"):
        warnings.warn("of a user", stacklevel=1)


@pytest.mark.parametrize("times", [12, pytest.param(600, marks=pytest.mark.slow)])
def test_simulations_come_and_go(times: int) -> None:
    in_threads(open_and_close, times)


def test_a_collector_is_of_its_thread() -> None:
    """It keeps warnings of its categories, of the innermost that has them."""
    from lammps_deformable.common.errors import StalledWarning, UnjammedWarning, collected, warn

    def tell(_: int) -> None:
        with pytest.warns(StalledWarning, match="another"):
            warn("another", StalledWarning)

    with collected() as outer, collected(UnjammedWarning) as inner:
        warn("loose", UnjammedWarning)
        warn("stalled", StalledWarning)
        with ThreadPoolExecutor(1) as pool:
            pool.submit(tell, 0).result()
    assert [str(each) for each in inner] == ["loose"]
    assert [str(each) for each in outer] == ["stalled"]

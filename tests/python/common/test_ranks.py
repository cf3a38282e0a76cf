"""Independent calls on MPI ranks: results of one process, errors, deaths."""

import json
from functools import cache
from pathlib import Path

import lammps_deformable as ld
import pytest
from lammps_deformable.common.ranks import independently, world
from mpi4py import MPI
from ranks import launch

# Simulations without `comm`, and a further map in each call.
ENSEMBLE = """
import json, os
import lammps_deformable as ld
from mpi4py import MPI

def strained(seed):
    jammed = ld.jam(ld.bidisperse(8, seed=seed)).packing
    with ld.Simulation(jammed, ld.Ring()) as sim:
        state = sim.compress(strain=0.02, steps=2)[-1]
    here = ld.parallel_map(lambda _: os.getpid(), [1, 2]) == [os.getpid()] * 2
    return MPI.COMM_WORLD.rank, here, state.energy, state.packing.positions.tolist()

def write(results, name):
    with open(f"{name}-{MPI.COMM_WORLD.rank}", "w") as file:
        json.dump(results, file)

if __name__ == "__main__":
    write(ld.parallel_map(strained, range(1, 6)), "all")
    write(ld.parallel_map(strained, [3]), "one")
    write(ld.parallel_map(strained, []), "none")
"""


@cache
def strained(seed: int) -> list[object]:
    """As in the script, in this process."""
    jammed = ld.jam(ld.bidisperse(8, seed=seed)).packing
    with ld.Simulation(jammed, ld.Ring()) as sim:
        state = sim.compress(strain=0.02, steps=2)[-1]
    return [state.energy, state.packing.positions.tolist()]


def test_ranks_share_calls(tmp_path: Path) -> None:
    """All ranks that run the script get the numbers of one process, to the last digit."""
    ranks = 3
    result = launch(ENSEMBLE, tmp_path, ranks)
    assert result.returncode == 0, result.stderr
    expected = [strained(seed) for seed in range(1, 6)]
    for rank in range(ranks):
        found, one, none = (
            json.loads((tmp_path / f"{name}-{rank}").read_text()) for name in ("all", "one", "none")
        )
        assert [row[2:] for row in found] == expected
        assert len({row[0] for row in found}) > 1  # who is free takes the next
        assert all(row[1] for row in found)
        assert one[0][2:] == expected[2]
        assert none == []


FAILS = """
import os, time
import lammps_deformable as ld
from lammps_deformable.common.ranks import world

def inverse(value):
    open(f"called-{value}", "w").close()
    if value == "exit":
        os._exit(1)
    time.sleep(0.2)
    return 1 / value

if __name__ == "__main__":
    (what,) = [what for what in (0, "exit", "unfit") if os.path.exists(f"try-{what}")]
    if what == "unfit":
        ld.parallel_map(eval, ["lambda: 0"])
    try:
        ld.parallel_map(inverse, [1, 2, what, *range(3, 99)])
    except ZeroDivisionError as error:
        print(f"{world().rank}: {error}", flush=True)
    print(ld.parallel_map(inverse, [4, 5]), flush=True)
"""


def test_all_ranks_get_the_error_of_a_call(tmp_path: Path) -> None:
    """Calls that have not begun are given up, and the ranks go on with other calls."""
    (tmp_path / "try-0").touch()
    result = launch(FAILS, tmp_path, 3)
    assert result.returncode == 0, result.stderr
    assert [result.stdout.count(f"{rank}: division by zero") for rank in range(3)] == [1, 1, 1]
    assert result.stdout.count("[0.25, 0.2]") == 3
    assert len(list(tmp_path.glob("called-*"))) < 50


@pytest.mark.parametrize(("what", "words"), [("exit", ""), ("unfit", "pickle")])
def test_nobody_waits_for_a_rank_that_fails(tmp_path: Path, what: str, words: str) -> None:
    (tmp_path / f"try-{what}").touch()
    result = launch(FAILS, tmp_path, 2)
    assert result.returncode != 0
    assert words in result.stderr


def test_a_call_is_alone() -> None:
    assert world() == MPI.COMM_WORLD
    assert independently(world) == MPI.COMM_SELF
    assert world() == MPI.COMM_WORLD

"""Independent calls on MPI ranks: results of one process, errors, deaths, interruptions."""

import csv
import json
import os
import subprocess
import time
from functools import cache
from pathlib import Path

import lammps_deformable as ld
import pytest
from lammps_deformable.ranks import independently, world
from mpi4py import MPI
from programs import BIN, PATIENT, command, output
from ranks import launch

# Simulations without `comm`, and a further map in each call.
ENSEMBLE = """
import json, os
import lammps_deformable as ld
from mpi4py import MPI

def strained(seed):
    jammed = ld.jam(ld.bidisperse(8, seed=seed)).packing
    with ld.Simulation(jammed, ld.Ring()) as sim:
        *_, state = ld.compress(sim, 0.02, 2)
    here = ld.parallel_map(os.getpid, [(), ()]) == [os.getpid()] * 2
    return MPI.COMM_WORLD.rank, here, state.energy, state.packing.positions.tolist()

def write(results, name):
    with open(f"{name}-{MPI.COMM_WORLD.rank}", "w") as file:
        json.dump(results, file)

if __name__ == "__main__":
    kept = []
    write(ld.parallel_map(strained, [(n,) for n in range(1, 6)], each=kept.append), "all")
    write(kept, "kept")
    write(ld.parallel_map(strained, [(3,)]), "one")
    write(ld.parallel_map(strained, []), "none")
"""


@cache
def strained(seed: int) -> list[object]:
    """As in the script, in this process."""
    jammed = ld.jam(ld.bidisperse(8, seed=seed)).packing
    with ld.Simulation(jammed, ld.Ring()) as sim:
        *_, state = ld.compress(sim, 0.02, 2)
    return [state.energy, state.packing.positions.tolist()]


@pytest.mark.parametrize(
    ("ranks", "module"),
    [(1, "mpi4py"), (3, "mpi4py"), (2, "mpi4py.futures"), (3, "mpi4py.futures")],
)
def test_ranks_share_calls(tmp_path: Path, ranks: int, module: str) -> None:
    """All ranks that run the script get the numbers of one process, to the last digit."""
    result = launch(ENSEMBLE, tmp_path, ranks, module)
    assert result.returncode == 0, result.stderr
    expected = [strained(seed) for seed in range(1, 6)]
    scripts = ranks if module == "mpi4py" else 1
    assert len(list(tmp_path.glob("all-*"))) == scripts
    for rank in range(scripts):
        found, kept, one, none = (
            json.loads((tmp_path / f"{name}-{rank}").read_text())
            for name in ("all", "kept", "one", "none")
        )
        assert [row[2:] for row in found] == expected
        assert {row[0] for row in found} == set(range(ranks))
        assert all(row[1] for row in found)
        assert one[0][2:] == expected[2]
        assert none == []
        assert sorted(kept) == (sorted(found) if rank == 0 else [])


FAILS = """
import os, time
import lammps_deformable as ld
from lammps_deformable.ranks import world

def inverse(value):
    open(f"called-{value}", "w").close()
    if value == "exit":
        os._exit(1)
    time.sleep(0.2)
    return 1 / value

if __name__ == "__main__":
    (what,) = [what for what in (0, "exit", "unfit") if os.path.exists(f"try-{what}")]
    if what == "unfit":
        ld.parallel_map(eval, [("lambda: 0",)])
    try:
        ld.parallel_map(inverse, [(1,), (2,), (what,), *[(n,) for n in range(3, 99)]])
    except ZeroDivisionError as error:
        print(f"{world().rank}: {error}", flush=True)
    print(ld.parallel_map(inverse, [(4,), (5,)]), flush=True)
"""


@pytest.mark.parametrize("module", ["mpi4py", "mpi4py.futures"])
def test_all_ranks_get_the_error_of_a_call(tmp_path: Path, module: str) -> None:
    """Calls that have not begun are given up, and the ranks go on with other calls."""
    (tmp_path / "try-0").touch()
    result = launch(FAILS, tmp_path, 3, module)
    assert result.returncode == 0, result.stderr
    scripts = 3 if module == "mpi4py" else 1  # the lines of several may run into each other
    assert [result.stdout.count(f"{rank}: division by zero") for rank in range(3)] == [
        int(rank < scripts) for rank in range(3)
    ]
    assert result.stdout.count("[0.25, 0.2]") == scripts
    assert len(list(tmp_path.glob("called-*"))) < 50


@pytest.mark.parametrize(("what", "words"), [("exit", ""), ("unfit", "pickle")])
def test_nobody_waits_for_a_rank_that_fails(tmp_path: Path, what: str, words: str) -> None:
    (tmp_path / f"try-{what}").touch()
    result = launch(FAILS, tmp_path, 2)
    assert result.returncode != 0
    assert words in result.stderr


def table(folder: Path) -> list[dict[str, str]]:
    with (folder / "table.csv").open() as file:
        return list(csv.DictReader(file))


def without_seconds(folder: Path) -> list[tuple[str, ...]]:
    return sorted(
        tuple(value for name, value in row.items() if name != "seconds") for row in table(folder)
    )


def test_jam_on_ranks_is_killed_and_goes_on(tmp_path: Path) -> None:
    """What is in the table stays, and the rest is what one process computes."""
    ask = ["jam", "8", "10", "--law", "disk", "--seeds", "4", "--out"]
    assert command(*ask, "whole", "--workers", 1, cwd=tmp_path).returncode == 0
    ranks = [BIN / "mpiexec", "-n", "3", BIN / "deformable", *ask, "run"]
    with subprocess.Popen(
        ranks, cwd=tmp_path, env=os.environ | PATIENT, stdout=subprocess.DEVNULL
    ) as run:
        while not (tmp_path / "run" / "table.csv").exists():
            assert run.poll() is None
            time.sleep(0.02)
        run.kill()
    before = table(tmp_path / "run")
    assert 0 < len(before) < 8
    said = output("deformable", *ask, "run", cwd=tmp_path, ranks=2)
    kinds = {line.split(":")[0] for line in said.splitlines()[:-1]}
    assert kinds == {"disk, N = 8", "disk, N = 10"}
    after = table(tmp_path / "run")
    assert [row for row in before if row not in after] == []  # with their seconds
    assert without_seconds(tmp_path / "run") == without_seconds(tmp_path / "whole")


UNLUCKY = """
import lammps_deformable as ld
from lammps_deformable.cli import jam, main

def unlucky(law, pressure, number, seed, *others):
    raise ld.LammpsError("out of luck")

jam.measure = unlucky
main.sys.argv = ["deformable", "jam", "8", "--out", "run"]
main.main()
"""


def test_an_error_of_a_command_is_one_line(tmp_path: Path) -> None:
    result = launch(UNLUCKY, tmp_path, 3)
    assert result.returncode != 0
    assert [line for line in result.stderr.splitlines() if line.startswith("error")] == [
        "error: out of luck"
    ]
    assert "Traceback" not in result.stderr


def test_a_call_is_alone() -> None:
    assert world() == MPI.COMM_WORLD
    assert independently(world) == MPI.COMM_SELF
    assert world() == MPI.COMM_WORLD

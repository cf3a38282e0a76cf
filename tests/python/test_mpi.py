"""The same script on one process and on two ranks."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import json
from mpi4py import MPI
import deformable

jammed = deformable.jam(deformable.bidisperse(32, seed=3))
sim = deformable.Simulation(jammed, deformable.Ring())
steps = deformable.compress(sim, strain=0.02, steps=2, tolerance=1e-9)
for state in deformable.record(steps, "run"):
    pass
contacts = state.contact_table[["i", "j"]].tolist()
seen = [state.phi, state.pressure, state.energy, state.coordination, contacts]
assert MPI.COMM_WORLD.allgather(seen) == [seen] * MPI.COMM_WORLD.size
assert state.root == (MPI.COMM_WORLD.rank == 0)
with deformable.load("run") as again:
    assert abs(again.state().energy / state.energy - 1) < 1e-12
if MPI.COMM_WORLD.rank == 0:
    print(json.dumps(seen))
"""

FARM = """
from mpi4py import MPI
import deformable

rank = MPI.COMM_WORLD.rank
jammed = deformable.jam(deformable.bidisperse(16, seed=rank + 1))
sim = deformable.Simulation(jammed, deformable.Ring(), comm=MPI.COMM_SELF)
for state in deformable.record(deformable.compress(sim, 0.01, rank + 1), f"run{rank}"):
    pass
assert state.root
"""


def python(script: str, cwd: Path, ranks: int) -> str:
    """Output of a python script, under MPI if there are several ranks."""
    (cwd / "script.py").write_text(script)
    command = [sys.executable, "script.py"]
    if ranks > 1:
        mpiexec = str(Path(sys.executable).parent / "mpiexec")
        command = [mpiexec, "-n", str(ranks), sys.executable, "-m", "mpi4py", "script.py"]
    result = subprocess.run(
        command, cwd=cwd, capture_output=True, text=True, timeout=120, check=False
    )
    assert result.returncode == 0, result.stderr
    return result.stdout


STARTS = ["bidisperse(32, seed=3)", "polydisperse(32, lambda rng: rng.uniform(0.4, 0.6, 32))"]


@pytest.mark.parametrize("start", STARTS)
def test_two_ranks_give_the_serial_answer(start: str, tmp_path: Path) -> None:
    script, answers = SCRIPT.replace(STARTS[0], start), []
    for ranks in (1, 2):
        folder = tmp_path / str(ranks)
        folder.mkdir()
        answers.append(json.loads(python(script, cwd=folder, ranks=ranks)))
        assert (folder / "run" / "trajectory.lammpstrj").read_text().count("ITEM: TIMESTEP") == 2
    (*serial, serial_contacts), (*shared, shared_contacts) = answers
    assert shared == pytest.approx(serial, rel=1e-6)
    assert shared_contacts == serial_contacts


def test_every_rank_may_run_its_own(tmp_path: Path) -> None:
    python(FARM, cwd=tmp_path, ranks=2)
    rows = [len((tmp_path / f"run{n}" / "series.csv").read_text().splitlines()) for n in (0, 1)]
    assert rows == [2, 3]


MOTION = """
from mpi4py import MPI
import deformable

packing = deformable.push_off(deformable.bidisperse(32, phi=0.9, seed=3))
with deformable.Simulation(packing, deformable.Ring()) as sim:
    (free,) = deformable.move(sim, 100, 0.2, temperature=1e-6)
    *_, bath = deformable.move(sim, 100, 0.2, temperature=1e-6, friction=0.1, every=50)
seen = [free.energy, free.kinetic_energy, bath.temperature]
assert MPI.COMM_WORLD.allgather(seen) == [seen] * MPI.COMM_WORLD.size
if free.root:
    print(free.energy, free.kinetic_energy)
"""


def test_two_ranks_move_alike(tmp_path: Path) -> None:
    """At constant energy; a heat bath has its own noise on each rank."""
    one, two = (
        [float(word) for word in python(MOTION, tmp_path, ranks).split()] for ranks in (1, 2)
    )
    assert two == pytest.approx(one, rel=1e-6)

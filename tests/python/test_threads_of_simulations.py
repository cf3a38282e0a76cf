"""`Simulation(threads=)`: the same results to the last bit."""

import os

import lammps_deformable as ld
import numpy as np
import pytest
from programs import output


def relaxed(law, threads):
    packing = ld.bidisperse(40, seed=3, dimension=3 if isinstance(law, ld.Droplet) else 2)
    with ld.Simulation(ld.jam(packing), law, threads=threads) as sim:
        assert sim.threads == threads
        sim.compress(strain=0.002)
        return sim.state()


@pytest.mark.parametrize(
    "law", [ld.Ring(kA=1.0), ld.Ring(kA=1.0, contact="radical"), ld.Droplet(tension=1.0)]
)
def test_bits(law):
    first, second = relaxed(law, 1), relaxed(law, "auto")
    np.testing.assert_array_equal(first.positions, second.positions)
    assert first.energy == second.energy


COUNT = """
import os
import lammps_deformable as ld
jammed = ld.jam(ld.bidisperse(16, seed=1))
counts = []
for threads in (1, 1, 2):
    with ld.Simulation(jammed, ld.Ring(kA=1.0), threads=threads) as sim:
        sim.state()
        counts.append(len(os.listdir("/proc/self/task")))
print(counts[1] - counts[0], counts[2] - counts[0])
"""


def test_those_of_other_libraries_do_not_count(tmp_path):
    """LAMMPS takes OMP_NUM_THREADS, which many set for NumPy."""
    for number in ("1", "2"):
        told = output("python", "-c", COUNT, cwd=tmp_path, OMP_NUM_THREADS=number)
        assert told.split() == ["0", str(min(2, len(os.sched_getaffinity(0))) - 1)]


@pytest.mark.parametrize("threads", [0, -1, 1.5, "all", None, True])
def test_wrong_numbers(threads):
    with pytest.raises(ld.ParameterError, match="threads"):
        ld.Simulation(ld.bidisperse(8, seed=1), ld.Ring(kA=1.0), threads=threads)

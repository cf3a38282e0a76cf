"""Many packings side by side, on cores or ranks: python ensemble.py, or with ranks
mpiexec -n 2 python -m mpi4py ensemble.py
"""

import lammps_deformable as ld
import numpy as np
from mpi4py import MPI


def pressure(seed):
    jammed = ld.jam(ld.bidisperse(32, seed=seed)).packing
    with ld.Simulation(jammed, ld.Ring()) as sim:
        state = sim.compress(strain=0.01)[-1]
    return state.pressure


if __name__ == "__main__":
    found = ld.parallel_map(pressure, range(1, 9))
    if MPI.COMM_WORLD.rank == 0:
        print(f"pressure {np.mean(found):.15e} +- {np.std(found) / np.sqrt(7):.1e}")

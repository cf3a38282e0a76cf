"""Compress one packing on all ranks: mpiexec -n 2 python -m mpi4py compress_mpi.py

All ranks run the script and get the same states; rank 0 writes the files.
"""

import lammps_deformable as ld
from mpi4py import MPI

jammed = ld.jam(ld.bidisperse(128, seed=1)).packing
sim = ld.Simulation(jammed, ld.Ring(kA=1.0))
for state in sim.compress(strain=0.005, steps=2, record="run", mode="w")[1:]:
    if MPI.COMM_WORLD.rank == 0:
        print(f"phi {state.phi:.5f}  pressure {state.pressure:.4e}  energy {state.energy:.6e}")

"""Compress a packing, keep the run, and draw force chains, shapes and a movie."""

import lammps_deformable as ld
import matplotlib.pyplot as plt

jammed = ld.jam(ld.bidisperse(48, sizes=(0.5, 0.7), seed=1)).packing
sim = ld.Simulation(jammed, ld.Ring(kA=1.0))
for state in sim.compress(strain=0.06, steps=15, record="run", mode="w")[1:]:
    print(f"phi {state.phi:.4f}  mean shape parameter {state.shape_parameter.mean():.5f}")

figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.6), layout="constrained")
state.plot(left, forces=True)
state.plot(right, color="shape_parameter", contacts=True)
figure.savefig("pictures.png", dpi=70)

ld.Run("run").movie("compression.gif", mode="w", color="shape_parameter", forces=True)

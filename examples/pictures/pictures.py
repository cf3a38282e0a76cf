"""Compress a packing, keep the run, and draw force chains, shapes and a movie."""

import deformable
import matplotlib.pyplot as plt

jammed = deformable.jam(deformable.bidisperse(48, radii=(0.5, 0.7), seed=1))
sim = deformable.Simulation(jammed, deformable.Ring(kA=1.0))
for state in deformable.record(
    deformable.compress(sim, strain=0.06, steps=15), "run", overwrite=True
):
    print(f"phi {state.phi:.4f}  mean shape parameter {state.shape_parameter.mean():.5f}")

figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.6), layout="constrained")
state.plot(left, forces=True)
state.plot(right, color_by="shape_parameter", contacts=True)
figure.savefig("pictures.png", dpi=70)

deformable.Run("run").movie("compression.gif", color_by="shape_parameter", forces=True)

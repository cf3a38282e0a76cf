"""The picture of README: a foam, the forces in a packing under shear, and an emulsion in space."""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

figure, axes = plt.subplots(1, 3, figsize=(13.5, 4.4), layout="constrained")
plain = {"colorbar": False}

bubbles = ld.Ring(kA=np.inf, kP=0, tension=1.0, contact="curved")
jammed = ld.jam(ld.bidisperse(64, sizes=(0.5, 0.8), seed=2)).packing
with ld.Simulation(jammed, bubbles) as sim:
    foam = sim.compress(phi=0.98, steps=12)[-1]
foam.plot(axes[0], color="pressures", cmap="YlGnBu", **plain)

jammed = ld.jam(ld.bidisperse(80, sizes=(0.5, 0.7), seed=3)).packing
with ld.Simulation(jammed, ld.Ring()) as sim:
    sim.compress(phi=0.9, steps=4)
    sheared = sim.shear(0.1, steps=10)[-1]
pale = {"color": np.zeros(80), "cmap": "Blues", "vmin": -1.0, "vmax": 5.0}
sheared.plot(axes[1], forces=True, **pale, **plain)
axes[1].get_legend().remove()

jammed = ld.jam(ld.bidisperse(192, sizes=(1.0, 1.3), dimension=3, seed=1)).packing
with ld.Simulation(jammed, ld.Droplet()) as sim:
    emulsion = sim.compress(phi=0.8, steps=4)[-1]
emulsion.plot(axes[2], color="loads", cmap="YlOrBr", view=(20, 35), **plain)

figure.savefig("front.png", dpi=110, pil_kwargs={"optimize": True})

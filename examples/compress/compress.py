"""Compress a jammed bidisperse packing to 1 % strain, keep the run and draw it."""

import deformable

packing = deformable.bidisperse(128, radii=(0.5, 0.7), seed=5)
jammed = deformable.jam(packing)
print(f"jammed at phi = {jammed.phi:.5f}")

sim = deformable.Simulation(jammed, deformable.Ring(kA=1.0))
for state in deformable.record(
    deformable.compress(sim, strain=0.01, steps=10), "run", overwrite=True
):
    print(f"phi {state.phi:.5f}  pressure {state.pressure:.4e}  z {state.coordination:.3f}")

state.plot().figure.savefig("packing.png", dpi=110)

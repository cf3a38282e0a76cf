"""Compress a jammed bidisperse packing to 1 % strain, keep the run and draw it."""

import lammps_deformable as ld

packing = ld.bidisperse(128, sizes=(0.5, 0.7), seed=5)
jammed = ld.jam(packing).packing
print(f"jammed at phi = {jammed.phi:.5f}")

sim = ld.Simulation(jammed, ld.Ring(kA=1.0))
for state in sim.compress(strain=0.01, steps=10, record="run", mode="w")[1:]:
    print(f"phi {state.phi:.5f}  pressure {state.pressure:.4e}  z {state.coordination:.3f}")

state.plot().figure.savefig("packing.png", dpi=110)

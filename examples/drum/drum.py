"""Compress a packing in a round container with pillars: the pressure, and the force on a pillar."""

import lammps_deformable as ld
import numpy as np

walls = [
    ld.Sphere(10, (0, 0)),  # walls[0]: the container
    ld.Sphere(1.5, (4, 0), inside=False),
    ld.PolygonWall([(-5, -5), (-2, -5), (-2, -2), (-5, -2)]),
    ld.Segment((-4, 2), (-4, 6)),
]
loose = ld.bidisperse(150, sizes=(0.5, 0.7), seed=1).between(walls)
print(f"the container has phi = {loose.phi:.4f}")
jammed = ld.jam(loose).packing
print(f"jammed at phi = {jammed.phi:.5f}")

sim = ld.Simulation(jammed, ld.Ring(kA=1.0))
run = sim.compress(strain=0.03, steps=6, tolerance=1e-4, record="run", mode="w")
for state in run[1:]:
    on_disk = np.linalg.norm(state.wall_forces[1])
    print(f"phi {state.phi:.4f}  pressure {state.pressure:.3e}  on the disk {on_disk:.2e}")

left = np.linalg.norm(state.wall_forces.sum(axis=0)) / np.abs(state.wall_forces).max()
print(f"sum of the forces on all walls, over the largest: {left:.0e}")
state.plot(forces=True).figure.savefig("drum.png", dpi=80)

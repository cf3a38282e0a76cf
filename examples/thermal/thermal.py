"""Simulate a fluid and a glass at one temperature, and keep both runs."""

import lammps_deformable as ld
import numpy as np

TEMPERATURE, FRICTION, TIMESTEP, EVERY = 1e-6, 0.005, 0.25, 100

for name, phi in (("fluid", 0.6), ("glass", 0.9)):
    packing = ld.bidisperse(64, phi=phi, seed=1).push_off()
    sim = ld.Simulation(packing, ld.Ring(kA=1.0))
    bath = {"temperature": TEMPERATURE, "friction": FRICTION, "timestep": TIMESTEP, "every": EVERY}
    for _ in ld.move(sim, 8_000, **bath, seed=1):
        pass  # until it is in equilibrium
    run = ld.record(ld.move(sim, 20_000, **bath, seed=2), name, bath, overwrite=True)
    measured = np.mean([state.temperature for state in run]) / TEMPERATURE
    print(f"phi {phi}  mean temperature over that of the bath {measured:.3f}")
    sim.state().plot(color_by="shape_parameter").figure.savefig(f"{name}.png", dpi=60)

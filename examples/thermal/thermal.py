"""Simulate a fluid and a glass at one temperature, and keep both runs."""

import lammps_deformable as ld
import numpy as np

TEMPERATURE, FRICTION, TIMESTEP, EVERY = 1e-6, 0.005, 0.25, 100

for name, phi in (("fluid", 0.6), ("glass", 0.9)):
    packing = ld.bidisperse(64, phi=phi, seed=1).push_off()
    sim = ld.Simulation(packing, ld.Ring(kA=1.0))
    bath = {"temperature": TEMPERATURE, "drag": FRICTION, "timestep": TIMESTEP, "every": EVERY}
    sim.run(8_000, seed=1, **bath)  # until it is in equilibrium
    run = sim.run(20_000, seed=2, **bath, record=name, mode="w")
    measured = np.mean(run.table()["temperature"][1:]) / TEMPERATURE
    print(f"phi {phi}  mean temperature over that of the bath {measured:.3f}")
    sim.state().plot(color="shape_parameter").figure.savefig(f"{name}.png", dpi=60)

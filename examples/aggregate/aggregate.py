"""Cells that hold together: a strip of them rounds up, and two droplets are pulled apart."""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

ADHESION = 0.1  # over the tension
ROWS, COLUMNS = 3, 10  # of the strip
SEEDS = (1, 2, 3, 4, 5)
ROUNDS, STEPS = 60, 1000
TIMESTEP = 0.02
TEMPERATURE, FRICTION = 0.014, 0.3
PULLED = (0.05, 0.1, 0.2, 0.3)  # adhesions of two droplets
PULL = 0.002  # steps of their distance


def cell(adhesion):
    """Resists changes of its area, and has a tension of 1."""
    return ld.Ring(kA=20.0, kP=0.0, tension=1.0, contact="curved", adhesion=adhesion)


def droplet(adhesion):
    """Conserves its area, and has a tension of 1."""
    return ld.Ring(kA=np.inf, kP=0.0, tension=1.0, contact="curved", adhesion=adhesion)


def strip():
    """Cells of radius 0.5 that touch, in rows, in the middle of an empty box."""
    row, column = (each.ravel() for each in np.mgrid[:ROWS, :COLUMNS])
    place = 0.99 * np.column_stack([column + 0.5 * (row % 2), row * np.sqrt(0.75)])
    place += 1.5 * COLUMNS - place.mean(axis=0)
    return ld.Packing(place, 0.5, 3.0 * COLUMNS * np.eye(2))


def aggregate(state):
    """The cells of the largest piece that films hold together."""
    films = state.contacts[state.contacts["attached"]]
    number = len(state.packing)
    joined = coo_array((np.ones(len(films)), (films["i"], films["j"])), shape=(number, number))
    piece = connected_components(joined, directed=False)[1]
    return np.flatnonzero(piece == np.bincount(piece).argmax())


def axes_ratio(state):
    """Of the long to the short axis of gyration; 1 for round shapes."""
    short, long = np.linalg.eigvalsh(np.cov(state.packing.positions[aggregate(state)].T))
    return np.sqrt(long / short)


def round_up(seed):
    """The strip at rest, and the states of its motion in a heat bath."""
    with ld.Simulation(strip(), cell(ADHESION)) as sim:
        first = sim.relax()
        bath = {"temperature": TEMPERATURE, "drag": FRICTION, "seed": seed}
        yield first
        yield from sim.run(ROUNDS * STEPS, timestep=TIMESTEP, every=STEPS, **bath)[1:]


def pull(adhesion):
    """Distance and force of two droplets of radius 1, in steps from rest until they let go."""
    two = ld.Packing([[9, 10], [10.99, 10]], 1.0, 20 * np.eye(2))
    rows = []
    with ld.Simulation(two, droplet(adhesion)) as sim:
        state = sim.relax()
        while state.contacts["attached"].any():
            one = state.contacts[0]
            rows.append((one["distance"], -one["force"]))
            apart = rows[0][0] + PULL * len(rows)
            for atom, x in ((1, 10 - apart / 2), (2, 10 + apart / 2)):
                sim.lmp.command(f"set atom {atom} x {x}")
            state = sim.state()
    return np.array(rows)


def exact(adhesion):
    """2 T sin theta at cos theta = 1 - w/(2 T) and T = 1."""
    return 2 * np.sqrt(adhesion - adhesion**2 / 4)


def main():
    figure, axes = plt.subplots(2, 3, figsize=(9, 6), layout="constrained")
    ratios = []
    for seed in SEEDS:
        states = list(round_up(seed))
        ratios.append([axes_ratio(state) for state in states])
        print(
            f"seed {seed}  axes {ratios[-1][0]:.2f} to {np.mean(ratios[-1][ROUNDS // 2 :]):.2f}  "
            f"cells {len(aggregate(states[-1]))} of {len(states[-1].packing)}"
        )
        if seed == SEEDS[0]:
            for ax, n in zip(axes.flat, (0, ROUNDS // 4, ROUNDS), strict=False):
                states[n].plot(ax, title=f"t = {states[n].time:.0f}", colorbar=False)
                middle = states[n].packing.positions.mean(axis=0)
                ax.set(xlim=middle[0] + [-7, 7], ylim=middle[1] + [-7, 7])
    times = TIMESTEP * STEPS * np.arange(ROUNDS + 1)
    rounding, curves, largest = axes[1]
    rounding.plot(times, np.transpose(ratios), color="C0", lw=0.6)
    rounding.plot(times, np.mean(ratios, axis=0), color="k")
    rounding.set(xlabel="time", ylabel="long over short axis", ylim=(1, None))

    forces = []
    for adhesion in PULLED:
        distance, force = pull(adhesion).T
        forces.append(force[-1])
        print(
            f"adhesion {adhesion:.2f}  at rest {distance[0]:.4f}  let go at {distance[-1]:.4f}  "
            f"force {force[-1]:.4f}  2 T sin theta {exact(adhesion):.4f}"
        )
        curves.plot(distance, force, label=f"w = {adhesion}")
    curves.set(xlabel="distance [R]", ylabel="force of the film [T]")
    curves.legend(frameon=False)
    w = np.linspace(0, 1.1 * PULLED[-1], 100)
    largest.plot(w, exact(w), "k-", lw=1, label=r"$2\,T\sin\theta$")
    largest.plot(PULLED, forces, "o", label="two droplets")
    largest.set(xlabel="w [T]", ylabel="pull-off force [T]")
    largest.legend(frameon=False)
    figure.savefig("aggregate.png", dpi=72, pil_kwargs={"optimize": True})


if __name__ == "__main__":
    main()

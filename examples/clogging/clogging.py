"""Droplets fall through a hopper: how often it clogs, for slits and droplets of different kinds.

Under mpiexec the ranks share the trials: mpiexec -n 4 python -m mpi4py clogging.py
"""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from mpi4py import MPI
from scipy import optimize, stats

WEIGHTS = (0.01, 0.03, 0.1)  # of a droplet, over its line tension: heavy droplets are soft ones
WIDTHS = (0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0)  # of the slit, over the mean diameter
SEEDS = 12  # trials of each width and weight
NUMBER = 80  # droplets, with diameters of 1 +- 0.1
DROPLET = ld.Ring(kA=np.inf, kP=0.0, tension=1.0, reach=1.0)  # conserves its area
DRAG = 0.3
SPACE, SLIT = 10.0, 4.0  # inner width of the hopper, height of the slit above the floor


def filled(width, seed):
    """Droplets that hang above the funnel, near the places of a square lattice."""
    rng = np.random.default_rng(seed)
    arm = (SPACE - width) / 2  # the funnel goes down at 45 degrees
    columns, distance = 8, 1.15
    column, row = np.arange(NUMBER) % columns, np.arange(NUMBER) // columns
    place = np.column_stack([1.0 + distance * column, SLIT + arm + 1.0 + distance * row])
    left = np.array([[0.0, SLIT - 1.0], [arm, SLIT], [0.0, SLIT + arm]])
    walls = [
        ld.BoxWall((SPACE, place[:, 1].max() + 2.0)),
        ld.PolygonWall(left),
        ld.PolygonWall([SPACE, 0.0] + [-1.0, 1.0] * left),
    ]
    radius = rng.uniform(0.45, 0.55, NUMBER)
    return ld.Packing(place + rng.uniform(-0.02, 0.02, (NUMBER, 2)), radius, np.eye(2), walls=walls)


def discharge(sim, weight):
    """Let the droplets fall; returns how many have passed, and whether the slit is clogged.

    It is if no droplet passes in 1000 steps, and all those above the slit are at rest: slower than
    1e-4 of the speed of one that falls by itself.
    """
    sim.lmp.command(f"region below block INF INF INF {SLIT - 1.0} INF INF")
    left = NUMBER
    while left > 0:
        state = sim.run(1000, every=1000, timestep=0.03, drag=DRAG)[-1]
        above = state.packing.positions[:, 1] > SLIT - 1.0
        if above.all() and np.abs(state.velocities).max() < 1e-4 * weight / DRAG:
            return int(NUMBER - left), True
        sim.lmp.command("delete_atoms region below compress yes")
        left = int(above.sum())
    return NUMBER, False


def trial(width, weight, seed):
    """Number of droplets that have passed, and whether the slit is clogged."""
    with ld.Simulation(filled(width, seed), DROPLET, gravity=(0, -weight)) as sim:
        return discharge(sim, weight)


def chance(width, at):
    """Probability to clog, 1/(1 + exp((w - w0)/s)) at the parameters (w0, s)."""
    return 1.0 / (1.0 + np.exp(np.clip((width - at[0]) / at[1], -30.0, 30.0)))


def fitted(clogged):
    """Parameters of `chance` of largest likelihood for numbers of clogged trials."""
    widths = np.array(WIDTHS)

    def unlikely(at):
        p = chance(widths, at)
        return -np.sum(clogged * np.log(p) + (SEEDS - clogged) * np.log1p(-p))

    return optimize.minimize(unlikely, [1.4, 0.1], bounds=[(0.5, 3.0), (0.02, 1.0)]).x


def fitted_with_error(clogged):
    """The same, and the error of w0: the spread of fits to trials drawn from the first fit."""
    at = fitted(clogged)
    drawn = np.random.default_rng(1).binomial(
        SEEDS, chance(np.array(WIDTHS), at), (100, len(WIDTHS))
    )
    return at, np.std([fitted(each)[0] for each in drawn])


def clogged_state(width, weight, seed):
    """The end of a trial, on this rank alone."""
    start, down = filled(width, seed), (0, -weight)
    with ld.Simulation(start, DROPLET, gravity=down, comm=MPI.COMM_SELF) as sim:
        discharge(sim, weight)
        return sim.state()


def picture(passed, clogged, fits):
    """A clogged hopper of light and one of heavy droplets, and both numbers against the width."""
    figure = plt.figure(figsize=(8.4, 4.2), layout="constrained")
    grid = figure.add_gridspec(2, 3, width_ratios=(1.0, 1.2, 1.2))
    for row, n in enumerate((0, len(WEIGHTS) - 1)):
        m = np.flatnonzero(2 * clogged[n].sum(axis=1) > SEEDS)[-1]  # the widest that clogs mostly
        seed = int(np.where(clogged[n, m], passed[n, m], NUMBER).argmin())
        ax = figure.add_subplot(grid[row, 0])
        title = f"weight {WEIGHTS[n]}, width {WIDTHS[m]}"
        state = clogged_state(WIDTHS[m], WEIGHTS[n], seed)
        state.plot(ax, forces=True, colorbar=False, title=title, vmin=1.8, vmax=3.0)
        ax.set_ylim(SLIT - 1.2, SLIT + 7.0)
    fraction, number = (figure.add_subplot(grid[:, column]) for column in (1, 2))
    fine = np.linspace(WIDTHS[0], WIDTHS[-1], 200)
    for n, weight in enumerate(WEIGHTS):
        counts = clogged[n].sum(axis=1)
        part = counts / SEEDS
        ends = [stats.binomtest(int(k), SEEDS).proportion_ci(0.68, "wilson") for k in counts]
        below, above = part - [end.low for end in ends], [end.high for end in ends] - part
        color = f"C{n}"
        fraction.errorbar(WIDTHS, part, (below, above), fmt="o", color=color, markersize=4)
        fraction.plot(fine, chance(fine, fits[n]), color=color, label=f"weight {weight}")
        error = passed[n].std(axis=1, ddof=1) / np.sqrt(SEEDS)
        number.errorbar(WIDTHS, passed[n].mean(axis=1), error, fmt="o-", color=color, markersize=4)
    fraction.set(xlabel="width of the slit / diameter", ylabel="fraction that clogs")
    fraction.legend(fontsize=8)
    number.set(xlabel="width of the slit / diameter", ylabel=f"droplets passed, of {NUMBER}")
    figure.savefig("clogging.png", dpi=72, pil_kwargs={"optimize": True})


if __name__ == "__main__":
    cases = [(w, weight, seed) for weight in WEIGHTS for w in WIDTHS for seed in range(SEEDS)]
    found = np.array(ld.parallel_map(lambda case: trial(*case), cases))
    passed, clogged = found.T.reshape(2, len(WEIGHTS), len(WIDTHS), SEEDS)
    if MPI.COMM_WORLD.rank == 0:
        fits = []
        for n, weight in enumerate(WEIGHTS):
            for m, width in enumerate(WIDTHS):
                print(
                    f"weight {weight}  width {width}  clogged {clogged[n, m].sum()} of {SEEDS}  "
                    f"passed {passed[n, m].mean():.1f}"
                )
            at, error = fitted_with_error(clogged[n].sum(axis=1))
            print(f"weight {weight}  half of the trials clog at {at[0]:.2f} +- {error:.2f}")
            fits.append(at)
        picture(passed, clogged, fits)

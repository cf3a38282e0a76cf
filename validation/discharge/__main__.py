"""Droplets leave a silo again and again: their flow over the opening, and what slows it.

python -m validation.discharge            what the README shows
python -m validation.discharge --quick    a part of it, in 20 seconds

Under mpiexec the ranks share the runs: mpiexec -n 4 python -m mpi4py -m validation.discharge
"""

import argparse
import json
from dataclasses import asdict, dataclass

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from mpi4py import MPI
from scipy.optimize import curve_fit

from validation import options_of
from validation.ensembles import over_cores

OPENINGS = (3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0)  # over the mean diameter, which is 1
SEEDS = 3  # runs of each opening
GRAINS = 120  # that leave in a run, after half of so many
ROWS = 18  # of grains: the height of the filling
HEIGHTS = (27,)  # of other fillings, for the opening of 6
DROPLET = ld.Ring(kA=np.inf, kP=0.0, tension=1.0, reach=1.0)  # conserves its area
CONTACT = {"kt": 2.0, "gt": 0.3, "damping": 0.5}
WIDTH, COLUMNS = 20.0, 18
RATES = (3, 5, 10, 20)  # on the axis of the picture
POWERS = (0.5, 1.0, 1.5)  # that are tried beside one that is fitted
CLOGGED = 50  # natural times without a grain that leaves; otherwise hundreds do


@dataclass(frozen=True)
class Case:
    """What acts on the grains.

    Attributes:
        weight: of a grain, over its line tension: heavy droplets are soft ones.
        mu: coefficient of friction.
        drag: force of the bath over velocity.
    """

    weight: float
    mu: float
    drag: float = 0.0

    @property
    def time(self) -> float:
        """In which a grain falls by about a diameter: sqrt(d/g), or d over its last speed."""
        return self.drag / self.weight if self.drag else self.weight**-0.5

    @property
    def step(self) -> float:
        """Of time; contacts of heavily damped grains do not oscillate."""
        return 0.1 if self.drag else 0.05

    @property
    def name(self) -> str:
        return f"weight {self.weight}  mu {self.mu}  drag {self.drag}"


LIGHT = [Case(0.004, 0.0), Case(0.004, 0.5)]
HEAVY = [Case(0.02, 0.0), Case(0.02, 0.5)]
DRAGGED = Case(0.02, 0.0, 1.4)
CASES = [*LIGHT, *HEAVY, DRAGGED]


def filled(opening, rows, seed):
    """Grains above a floor with an opening; box and floor repeat in both directions.

    What falls out of the opening comes back through the top of the box. As this is tilted by half
    its width, it falls on the part of the filling that lies on the floor.
    """
    rng = np.random.default_rng(seed)
    number, half = COLUMNS * rows, (WIDTH - opening) / 2
    column, row = np.arange(number) % COLUMNS, np.arange(number) // COLUMNS
    place = np.column_stack([WIDTH / COLUMNS * (column + row % 2 / 2), 1.65 + 0.98 * row])
    floor = [[-half, 1.0], [0.6 - half, 0.4], [half - 0.6, 0.4], [half, 1.0]]
    return ld.Packing(
        place + rng.uniform(-0.02, 0.02, place.shape),
        rng.uniform(0.45, 0.55, number),
        [[WIDTH, 0.0], [0.5 * WIDTH, 1.65 + 0.98 * rows]],
        walls=[ld.PolygonWall(floor)],
    )


def scene(case, rows, steps):
    """LAMMPS' commands: motion, the bath, and what is measured. `held` has the weight's energy too.

    The bath ends at the floor and above the filling, so that all grains fall freely between them. A
    disk that spins has 5/4 of the energy that LAMMPS knows for spheres.
    """
    return f"""
timestep {case.step}
region bath block INF INF 0.4 {0.4 + 0.87 * rows} INF INF
group bath dynamic all region bath every 10
fix drag bath viscous {case.drag}
fix move all nve/sphere disc
fix plane all enforce2d
compute spins all erotate/sphere
compute height all property/atom yu
compute turns all property/atom iy
compute sums all reduce sum c_height c_turns
variable left equal -c_sums[2]
variable fallen equal -c_sums[1]
variable held equal pe+ke+1.25*c_spins+f_deformable_friction[1]
variable lost equal f_deformable_friction-f_deformable_friction[1]
variable push equal -f_deformable_wall_1[2]
fix push all ave/time 1 {steps} {steps} v_push
thermo_style custom pe ke v_left v_fallen v_held v_lost f_push
thermo_modify norm no
"""


@dataclass(frozen=True)
class Flow:
    """Of a run in its steady part.

    Attributes:
        rate: grains in a natural time, 0 if the silo has clogged.
        balance: what contacts lose and grains gain in energy, over what the weight does.
        push: mean force on the floor, over the weight of all grains.
    """

    rate: float
    balance: float
    push: float


def silo(case, opening, rows, seed):
    """A simulation of the filled silo."""
    forces = {"friction": ld.Friction(case.mu, **CONTACT), "gravity": (0.0, -case.weight)}
    return ld.Simulation(filled(opening, rows, seed), DROPLET, comm=MPI.COMM_SELF, **forces)


def flow(case, opening, rows, seed, grains=GRAINS):
    with silo(case, opening, rows, seed) as sim:
        return discharge(sim, case, rows, grains)


def discharge(sim, case, rows, grains):
    """A run in which so many grains leave, after half of them."""
    lmp, steps = sim.lmp, round(case.time / case.step)
    lmp.commands_string(scene(case, rows, steps))
    seen = []
    while not seen or seen[-1]["v_left"] < 1.5 * grains:
        lmp.command(f"run {steps} post no")
        seen.append(lmp.last_thermo())
        if len(seen) > CLOGGED and seen[-1]["v_left"] == seen[-CLOGGED - 1]["v_left"]:
            return Flow(0.0, 0.0, 0.0)
    names = ("v_left", "v_fallen", "v_held", "v_lost", "f_push")
    left, fallen, held, lost, push = (np.array([row[name] for row in seen]) for name in names)
    steady = left >= 0.5 * grains
    gain = [values[-1] - values[steady][0] for values in (left, fallen, held, lost)]
    return Flow(
        gain[0] / (np.count_nonzero(steady) - 1),
        1.0 + (gain[2] + gain[3]) / (case.weight * gain[1]),
        push[steady][1:].mean() / (case.weight * lmp.get_natoms()),
    )


def beverloo(opening, factor, offset, power):
    return factor * np.maximum(opening - offset, 1e-3) ** power


def fit(opening, rate, error, power=None):
    """Factor, offset and power (it may be held), their errors, chi^2 per degree of freedom."""
    free = 3 if power is None else 2

    def law(width, *given):
        return beverloo(width, *given, *([] if power is None else [power]))

    start = [rate[-1] / opening[-1], 1.0, 1.0][:free]
    bounds = [0.0, -10.0, 0.1][:free], [100.0, opening[0] - 0.1, 5.0][:free]
    found, covariance = curve_fit(
        law, opening, rate, start, error, absolute_sigma=True, bounds=bounds
    )
    chi2 = np.sum(((law(opening, *found) - rate) / error) ** 2) / (len(opening) - free)
    errors = np.sqrt(np.diag(covariance))
    return (found, errors, chi2) if power is None else ([*found, power], [*errors, 0.0], chi2)


def rates(data, case):
    """Openings of a case, mean rates and their standard errors, of the runs that did not clog.

    Of so few seeds the relative error of a run is taken to be that of all openings.
    """
    flows = {
        run["opening"]: [rate for rate in run["rate"] if rate]
        for run in data
        if run["case"] == asdict(case) and run["rows"] == ROWS
    }
    flows = {opening: of for opening, of in flows.items() if len(of) > 1}
    mean = np.array([np.mean(of) for of in flows.values()])
    number = np.array([len(of) for of in flows.values()])
    spread = np.array([np.std(of, ddof=1) for of in flows.values()]) / mean
    relative = np.sqrt(np.average(spread**2, weights=number - 1) / number)
    return np.array(list(flows)), mean, relative * mean


def measured(data):
    return [case for case in CASES if any(run["case"] == asdict(case) for run in data)]


def show(data):
    for run in data:
        flowing = np.array(run["rate"]) > 0
        rate, balance, push = (np.array(run[name])[flowing] for name in ("rate", "balance", "push"))
        print(
            f"{Case(**run['case']).name}  rows {run['rows']}  opening {run['opening']:.1f}  "
            f"clogged {np.sum(~flowing)} of {len(flowing)}  rates "
            + " ".join(f"{each:5.2f}" for each in rate)
            + (
                f"  lost/work {balance.mean():.3f}  push/weight {push.mean():.2f}"
                if len(rate)
                else ""
            )
        )
    for case in measured(data):
        points = rates(data, case)
        for power in (None, *POWERS) if len(points[0]) > 3 else ():
            found, errors, chi2 = fit(*points, power)
            values = "  ".join(
                f"{name} {value:.2f} +- {error:.2f}"
                for name, value, error in zip("Ckb", found, errors, strict=True)
            )
            print(f"{case.name}  {values}  chi^2 {chi2:.1f}")


def draw(data, grains):
    """Two silos in their steady flow, and the rates over the opening with their fits."""
    figure = plt.figure(figsize=(11, 5.6), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.3))
    for row, (case, title) in enumerate(
        [(HEAVY[1], "contacts with friction"), (DRAGGED, "drag of a bath")]
    ):
        with silo(case, 5.0, ROWS, 1) as sim:
            discharge(sim, case, ROWS, grains)
            ax = figure.add_subplot(grid[row, 0])
            sim.state().plot(ax, forces=True, colorbar=False, title=title)
    ax = figure.add_subplot(grid[:, 1])
    for n, case in enumerate(measured(data)):
        opening, rate, error = rates(data, case)
        label = f"weight {case.weight}, $\\mu$ = {case.mu}" + (", drag" if case.drag else "")
        ax.errorbar(opening, rate, error, fmt="o", markersize=5, label=label, color=f"C{n}")
        if len(opening) > 3:
            fine = np.linspace(opening[0], opening[-1], 100)
            ax.plot(fine, beverloo(fine, *fit(opening, rate, error)[0]), color=f"C{n}", lw=1)
    ax.set(
        xscale="log", yscale="log", xlabel="opening / diameter", ylabel="grains in a natural time"
    )
    ax.set_xticks(OPENINGS, [f"{opening:g}" for opening in OPENINGS])
    ax.set_yticks(RATES, [f"{rate:g}" for rate in RATES])
    ax.minorticks_off()
    ax.legend(fontsize=8)
    figure.savefig("discharge.png", dpi=80, pil_kwargs={"optimize": True})


def planned(quick):
    """Case, opening and rows of all that is measured."""
    if quick:
        return [(case, opening, ROWS) for case in HEAVY for opening in (5.0, 7.0)]
    every = [(case, opening, ROWS) for case in CASES for opening in OPENINGS]
    return every + [(case, 6.0, rows) for case in HEAVY for rows in HEIGHTS]


def main(quick):
    scenes, seeds, grains = planned(quick), 2 if quick else SEEDS, 20 if quick else GRAINS
    calls = [(*each, seed, grains) for each in scenes for seed in range(1, seeds + 1)]
    found = over_cores(flow, calls, keep=None if quick else "discharge")
    if MPI.COMM_WORLD.rank == 0:
        data = []
        for n, (case, opening, rows) in enumerate(scenes):
            own = [asdict(each) for each in found[n * seeds : (n + 1) * seeds]]
            results = {name: [round(each[name], 5) for each in own] for name in own[0]}
            data.append({"case": asdict(case), "opening": opening, "rows": rows} | results)
        with open("discharge.json", "w") as file:
            json.dump(data, file, separators=(",", ":"))
        show(data)
        draw(data, grains)


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("--quick", action="store_true", help="a part, in 20 seconds")
    main(options_of(options, __file__).quick)

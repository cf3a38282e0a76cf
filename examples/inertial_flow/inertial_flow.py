"""Soft grains that rub flow under a pressure: their friction over the inertial number.

python inertial_flow.py             what the README shows
python inertial_flow.py --quick     a part of it, with fewer grains, in 20 seconds

Under mpiexec the ranks share the flows: mpiexec -n 4 python -m mpi4py inertial_flow.py
"""

import argparse
import json
import math

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from mpi4py import MPI
from scipy.optimize import curve_fit

NUMBER = 200
RADII = (0.4, 0.6)  # the mean diameter is 1, as all masses are
GRAIN = ld.Ring(kA=math.inf, kP=0.0, tension=1.0, reach=1.0)  # keeps its area
STIFFNESS = 4 * math.pi / 3  # of a contact, 2 pi tension/(3 R)
CONTACT = {"kt": 2.0, "gt": 0.3, "damping": 0.5}
STEP = 0.05  # of time

# Pressure over stiffness of a contact, and coefficient of friction.
CASES = ((1e-3, 0.4), (1e-2, 0.4), (1e-1, 0.4), (1e-2, 0.0))
INERTIA = (0.005, 0.015, 0.05, 0.15, 0.3)  # rate * sqrt(mass/pressure)
LINEAR = 0.15  # of the inertial number, to which straight lines are fitted
BLOCK, BEGIN = 1.0, 3  # strain of a block; the first ones are left out
BLOCKS = (6, 8, 12, 20, 25)  # fast flows cost less

# Rate at which the height follows the pressure, where that is off by the stiffness: slower than
# contacts, faster than flows.
GAIN = 0.2

NAMES = ("pressure", "shear", "sideways", "area", "work", "contacts", "sliding")


def scene(softness, inertia, height):
    """LAMMPS' commands: a box that shears and keeps its pressure, and what is measured.

    The stress has the part of the velocities relative to the mean flow.
    """
    pressure, gain = softness * STIFFNESS, GAIN / STIFFNESS
    rate = inertia * math.sqrt(pressure)
    steps = math.ceil(BLOCK / rate / STEP)
    return (
        f"""
timestep {STEP}
compute flow all temp/deform
compute stress all pressure flow
fix move all nve/sphere disc
fix plane all enforce2d
fix shear all deform/pressure 1 xy erate {rate} y pressure {pressure} {gain} remap v
fix_modify shear press stress
velocity all ramp vx 0 {rate * height} y 0 {height}
variable pressure equal c_stress[2]
variable shear equal -c_stress[4]
variable sideways equal c_stress[1]
variable area equal lx*ly
variable height equal v_pressure*{gain}*(v_pressure-{pressure})
variable work equal v_area*(v_shear*{rate}-v_height)
variable contacts equal f_deformable_friction[5]
variable sliding equal f_deformable_friction[6]
fix means all ave/time 1 {steps} {steps} {" ".join(f"v_{name}" for name in NAMES)}
thermo_style custom pe ke
run 0
""",
        steps,
    )


def started(softness, mu, inertia, number):
    """A simulation that has begun, and the number of steps for a block of strain."""
    loose = ld.polydisperse(number, np.linspace(*RADII, number), seed=1)
    packing = ld.jam(loose).packing.at(0.8)
    friction = ld.Friction(mu, **CONTACT)
    sim = ld.Simulation(packing, GRAIN, comm=MPI.COMM_SELF, friction=friction)
    commands, steps = scene(softness, inertia, packing.box[1, 1])
    sim.lmp.commands_string(commands)
    return sim, steps


def flow(softness, mu, inertia, number, blocks):
    """Means over each block of strain: a dictionary of numbers for each."""
    sim, steps = started(softness, mu, inertia, number)
    rows = []
    with sim:
        for _ in range(BEGIN + blocks):
            before = sim.lmp.extract_fix("deformable_friction", 0, 0)
            sim.lmp.command(f"run {steps} post no")
            row = {name: sim.lmp.extract_fix("means", 0, 1, n) for n, name in enumerate(NAMES)}
            row["lost"] = (sim.lmp.extract_fix("deformable_friction", 0, 0) - before) / (
                steps * STEP
            )
            rows.append(row | at_the_end(sim.lmp, mu))
    return rows[BEGIN:]


def at_the_end(lmp, mu):
    """The largest part of its friction that a contact uses, and the mean velocity upward."""
    force, friction = lmp.numpy.extract_fix("deformable_friction", 2, 2)[:, 5:7].T
    used = np.abs(friction) / np.maximum(mu * force, 1e-300) if mu else np.abs(friction)
    return {"used": used.max(), "drift": lmp.numpy.extract_atom("v")[: lmp.get_natoms(), 1].mean()}


def averaged(run):
    """Means of a flow and their standard errors, of blocks that are taken as independent."""
    number = run["number"]
    of = {name: np.array(values) for name, values in run["blocks"].items()}
    grains = np.full_like(of["area"], np.pi * np.sum(np.linspace(*RADII, number) ** 2))
    pairs = {
        "mu": (of["shear"], of["pressure"]),
        "phi": (grains, of["area"]),
        "z": (2 * of["contacts"], np.full_like(of["contacts"], number)),
        "sliding": (of["sliding"], of["contacts"]),
        "pressure": (of["pressure"], np.full_like(of["area"], run["softness"] * STIFFNESS)),
        "sideways": (of["sideways"], of["pressure"]),
        "lost": (of["lost"], of["work"]),
    }
    return {name: ld.jackknife(np.transpose(each), ratio) for name, each in pairs.items()}


def ratio(pairs):
    above, below = np.sum(pairs, axis=0)
    return above / below


def line(inertia, at_rest, slope):
    return at_rest + slope * inertia


def fitted(runs, name):
    """Value at rest and slope of a straight line up to LINEAR, their errors; chi^2 of a degree."""
    used = [run for run in runs if run["inertia"] <= LINEAR]
    inertia = np.array([run["inertia"] for run in used])
    value, error = np.transpose([averaged(run)[name] for run in used])
    found, covariance = curve_fit(line, inertia, value, sigma=error, absolute_sigma=True)
    chi2 = np.sum(((line(inertia, *found) - value) / error) ** 2)
    return found, np.sqrt(np.diag(covariance)), chi2 / (len(used) - 2)


def by_case(data):
    """Flows of each case that was measured."""
    flows = {case: [r for r in data if (r["softness"], r["mu"]) == case] for case in CASES}
    return {case: runs for case, runs in flows.items() if runs}


def show(data):
    for run in data:
        shown = averaged(run)
        print(
            f"softness {run['softness']:5.3f}  mu_p {run['mu']}  I {run['inertia']:5.3f}  "
            + "  ".join(f"{name} {v:.3f} +- {e:.3f}" for name, (v, e) in shown.items())
            + f"  used {max(run['blocks']['used']):.3f}"
        )
    for (softness, mu), runs in by_case(data).items():
        for name in ("mu", "phi") if len(runs) > 2 else ():
            (rest, slope), errors, chi2 = fitted(runs, name)
            print(
                f"softness {softness:5.3f}  mu_p {mu}  {name} = {rest:.3f} +- {errors[0]:.3f}"
                f" + I ({slope:.3f} +- {errors[1]:.3f})  chi^2 {chi2:.1f}"
            )


def draw(data, number):
    """Two flows with their contacts; friction and packing fraction over the inertial number."""
    figure = plt.figure(figsize=(11, 4.4), layout="constrained")
    grid = figure.add_gridspec(2, 3, width_ratios=(0.7, 1.2, 1.2))
    for row, case in enumerate((CASES[1], CASES[2])):
        sim, steps = started(*case, 0.05, number)
        with sim:
            sim.lmp.command(f"run {2 * steps} post no")
            ax = figure.add_subplot(grid[row, 0])
            sim.state().plot(ax, contacts=True, colorbar=False, title=f"p/k = {case[0]}")
    axes = [figure.add_subplot(grid[:, column]) for column in (1, 2)]
    for n, ((softness, mu), runs) in enumerate(by_case(data).items()):
        for ax, name in zip(axes, ("mu", "phi"), strict=True):
            value, error = np.transpose([averaged(run)[name] for run in runs])
            inertia = np.array([run["inertia"] for run in runs])
            label = f"p/k = {softness}, $\\mu_p$ = {mu}"
            ax.errorbar(inertia, value, error, fmt="o", color=f"C{n}", ms=5, label=label)
            if len(runs) > 2:
                fine = np.geomspace(inertia.min(), LINEAR, 100)
                ax.plot(fine, line(fine, *fitted(runs, name)[0]), color=f"C{n}", lw=1)
    for ax, label in zip(axes, ("shear stress / pressure", "packing fraction"), strict=True):
        ax.set(xscale="log", xlabel="inertial number $I$", ylabel=label)
    axes[0].set_ylim(0, None)
    axes[0].legend(fontsize=8)
    figure.savefig("inertial_flow.png", dpi=80, pil_kwargs={"optimize": True})


def planned(quick):
    """Softness, friction, inertial number, grains and blocks of all flows."""
    if quick:
        return [
            (softness, 0.4, inertia, 40, 3) for softness in (0.01, 0.1) for inertia in (0.1, 0.3)
        ]
    flows = list(zip(INERTIA, BLOCKS, strict=True))
    return [(*case, inertia, NUMBER, blocks) for case in CASES for inertia, blocks in flows]


def main(quick):
    calls = planned(quick)
    found = ld.parallel_map(lambda call: flow(*call), calls)
    if MPI.COMM_WORLD.rank == 0:
        data = []
        for (softness, mu, inertia, number, _), rows in zip(calls, found, strict=True):
            blocks = {name: [float(f"{row[name]:.5g}") for row in rows] for name in rows[0]}
            run = {"number": number, "softness": softness, "mu": mu, "inertia": inertia}
            data.append(run | {"blocks": blocks})
        with open("inertial_flow.json", "w") as file:
            json.dump(data, file, separators=(",", ":"))
        show(data)
        draw(data, calls[0][3])


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("--quick", action="store_true", help="a part, in 20 seconds")
    main(options.parse_args().quick)

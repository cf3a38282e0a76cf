"""Jamming with friction: packing fraction and contacts at the onset over the friction of contacts.

python -m validation.frictional_jamming          20 s: 32 droplets at three coefficients of friction
python -m validation.frictional_jamming large    five minutes: 64 droplets at seven
python -m validation.frictional_jamming beads    a quarter of an hour: friction of polygons of beads
"""

import argparse
import itertools
import json
import math
import time
from pathlib import Path

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from lammps_deformable.reference.comparison import matching, matching_laws
from lammps_deformable.state.contacts import without_rattlers

from validation import options_of
from validation.ensembles import over_cores

# Droplets of radii 1 : 1.4 and mass 1 that keep their area. A contact has the stiffness 2 to 4, so
# that these springs and dashpots are as stiff, and damp a bounce nearly.
LAW = ld.Ring(kA=math.inf, kP=0.0, tension=1.0)
SPRING, DASHPOT, DAMPING = 1.0, 0.5, 1.0
TIMESTEP = 0.08  # the longest stable one for any contacts of these droplets
LOOSE_DROPLETS = 0.7

# particles, packings, coefficients of friction, pressures one after another, inertial number
PLANS = {
    "small": (32, 4, (0.0, 0.1, 10.0), (5e-4, 2e-3), 5e-3),
    "large": (64, 20, (0.0, 0.01, 0.03, 0.1, 0.3, 1.0, 10.0), (1e-4, 4e-4, 1.6e-3), 2e-3),
}

# A contact is fully mobilized from this part of Coulomb's bound on.
MOBILIZED = 0.999


def measure(sim, state, mu):
    """Numbers of a state at rest."""
    contacts = state.contacts[state.contacts["i"] < state.contacts["j"]]
    normal, along = contacts["force"], np.abs(contacts["friction"])
    used = along / (mu * normal) if mu else np.zeros(len(contacts))
    free = state.rattlers[contacts["i"]] | state.rattlers[contacts["j"]]
    force = np.linalg.norm(np.reshape(sim.lmp.gather("f", 1, 3), (-1, 3)), axis=1)
    torque = np.reshape(sim.lmp.gather("torque", 1, 3), (-1, 3))[:, 2] / state.packing.radii
    numbers = {
        "phi": state.phi,
        "pressure": state.pressure,
        "rigid": int(np.sum(~state.rattlers)),
        "contacts": state.network_contacts,
        "z": state.coordination,
        "mobilized": int(np.sum(used[~free] > MOBILIZED)),
        "mobilization": used[~free].mean(),
        "coulomb": np.max(along - mu * normal) / normal.mean(),
        "force": force.max() / normal.mean(),
        "torque": np.abs(torque).max() / normal.mean(),
        "at_rest": state.converged,
    }
    return {name: n if isinstance(n, int) else float(f"{n:.6g}") for name, n in numbers.items()}


def jammed(number, mu, seed, pressures, inertial_number):
    """A loose packing that is compressed to a pressure, and to higher ones from there."""
    begun = time.process_time()
    friction = ld.Friction(mu, kt=SPRING, gt=DASHPOT, damping=DAMPING)
    start = ld.bidisperse(number, phi=LOOSE_DROPLETS, seed=seed).push_off()
    found = []
    with ld.Simulation(start, LAW, friction=friction) as sim:
        for pressure in pressures:
            state = sim.run(
                4_000_000, pressure=pressure, inertial_number=inertial_number, timestep=TIMESTEP
            )[-1]
            found.append(measure(sim, state, mu))
    seconds = time.process_time() - begun
    return {"mu": mu, "seed": seed, "seconds": round(seconds, 1), "states": found}


# numbers of a packing, with their digits; and powers of p in which some are extrapolated
MEANS = {"phi": 4, "z": 3, "rattlers": 1, "mobilized": 3, "mobilization": 3}
POWERS = {"phi": 1.0, "z": 0.5}


def table(found):
    """Means and errors of each coefficient of friction, rows by mu.

    phi and z are those at p -> 0, of a line through the means; others those of the lowest pressure.
    """
    rows = []
    for mu in sorted({each["mu"] for each in found["packings"]}):
        same = [each["states"] for each in found["packings"] if each["mu"] == mu]
        row = {"mu": mu, "packings": len(same)}
        for name in MEANS:
            values = [[value(name, state, found["number"]) for state in states] for states in same]
            over = np.array(found["pressures"]) ** POWERS.get(name, 1.0)

            def at_onset(some, over=over, extrapolated=name in POWERS):
                means = np.mean(some, axis=0)
                return np.polyfit(over, means, 1)[1] if extrapolated else means[0]

            row[name] = ld.jackknife(values, at_onset)
        rows.append(row)
    return rows


def value(name, state, number):
    """One number of a state; fully mobilized contacts per particle."""
    if name == "rattlers":
        return number - state["rigid"]
    if name == "mobilized":
        return state[name] / state["rigid"]
    return state[name]


def cells(row):
    """Values and errors of a row as text."""
    return [f"{row[name][0]:.{n}f} +- {row[name][1]:.{n}f}" for name, n in MEANS.items()]


def write(found, name):
    """Print and log the table, and draw it."""
    rows = table(found)
    lines = [
        f"{found['number']} droplets, pressures {', '.join(f'{p:g}' for p in found['pressures'])}",
        f"{'mu':8}{'phi_J':20}{'z':19}{'rattlers':16}{'mobilized':19}mobilization",
    ]
    lines += [f"{row['mu']:<6g}  " + "    ".join(cells(row)) for row in rows]
    states = [state for each in found["packings"] for state in each["states"]]
    lines += [
        f"largest force and torque {max(max(s['force'], s['torque']) for s in states):.1e} of the "
        f"mean contact force; beyond Coulomb's bound {max(s['coulomb'] for s in states):.1e}",
        f"{sum(not s['at_rest'] for s in states)} states not at rest; "
        f"{sum(each['seconds'] for each in found['packings']):.0f} s of processor time",
    ]
    text = "\n".join(lines)
    print(text)
    Path(f"{name}.log").write_text(text + "\n")
    draw(rows, f"{name}.png")


def draw(rows, file):
    """z and phi_J over mu; mu = 0 stands at the left end."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    mu = np.array([row["mu"] for row in rows])
    least = mu[mu > 0].min() / 3.0
    for ax, name, label in zip(axes, ("z", "phi"), ("contacts z", "$\\phi_J$"), strict=True):
        mean, error = np.array([row[name] for row in rows]).T
        ax.errorbar(np.where(mu > 0, mu, least), mean, error, fmt="o-")
        ax.set(xscale="log", xlabel="friction of the contacts $\\mu$", ylabel=label)
        ax.axvline(least, color="0.85", zorder=0)
        place = {"transform": ax.get_xaxis_transform(), "va": "bottom", "fontsize": 8}
        ax.text(least, 0.01, " $\\mu$ = 0", color="0.4", **place)
    for level in (3, 4):
        axes[0].axhline(level, color="0.7", linewidth=0.8, zorder=0)
    axes[0].set(ylim=(2.9, 4.1))
    figure.savefig(file, dpi=130)
    plt.close(figure)


# Which friction makes the ring law agree with polygons of beads, whose roughness is friction?
#
# Polygons of beads are compressed to a pressure by damped motion, as the droplets are, and so are
# particles of the ring law that have their stiffness, with contacts that rub. The friction at which
# these have as many contacts is that of the beads.

NUMBER, LOOSE = 32, 0.65
PACKINGS = 24  # of rings
PRESSURE, INERTIAL_NUMBER = 1e-4, 1e-2
BEADS = {18: 4, 24: 4, 40: 3}  # of a small polygon, large ones have more; and packings
FRICTION = (0.0, 0.03, 0.1, 0.3, 1.0, 10.0)
AT_REST, LOOK, MOST = 1e-2, 10_000, 2_000_000

MOTION = """
fix move all nve
fix drag all viscous {drag!r}
fix flat all enforce2d
fix box all deform/pressure 1 box pressure {pressure!r} {gain!r} remap x
fix_modify box press deformable_virial
timestep {timestep!r}
"""


def model(beads):
    return ld.DeformablePolygon(beads, radius=0.05, kL=300.0, kA=1.0, kr=30.0, smooth=False)


def bead_friction(polygons, radius):
    """Slope of the hollow between two beads of each species, over which one of a polygon climbs."""
    half = 0.5 * polygons.spacing
    return half / np.sqrt(4.0 * radius**2 - half**2)


def loose(seed):
    return ld.bidisperse(NUMBER, phi=LOOSE, seed=seed).push_off()


def of_beads(beads, seed):
    """Polygons at rest, with the packing fraction of their effective radii."""
    begun, start = time.process_time(), loose(seed)
    with ld.Simulation(matching(start, model(beads)), model(beads)) as sim:
        polygons = sim.polygons
        mass = float(polygons.number[start.species].mean())
        rate = math.sqrt(PRESSURE / mass)
        drag = rate * min(2.0, 0.4 / (INERTIAL_NUMBER * NUMBER))
        sim.lmp.commands_string(
            MOTION.format(
                drag=drag,
                pressure=PRESSURE,
                gain=INERTIAL_NUMBER * rate / PRESSURE,
                timestep=1.0 / polygons.fastest_frequency(model(beads).kr),
            )
        )
        for _ in range(0, MOST, LOOK):
            sim.lmp.command(f"run {LOOK} post no")
            state = sim.state()
            if max(state.residual, abs(state.pressure / PRESSURE - 1.0)) < AT_REST:
                break
    table = state.contacts
    sides = np.append(table.i, table.j), np.append(table.j, table.i)
    particle = sides[0][without_rattlers(*sides, NUMBER, at_most=1)]
    rigid = len(np.unique(particle))
    return {
        "beads": beads,
        "seed": seed,
        "hollow": bead_friction(polygons, 0.05).tolist(),
        "phi": float(np.sum(np.pi * start.radii**2) / state.packing.volume),
        "z": len(particle) / rigid if rigid else 0.0,
        "rigid": rigid,
        "seconds": round(time.process_time() - begun, 1),
    }


def of_rings(mu, beads, seed):
    """Particles of the ring law at rest, with the stiffness of those polygons."""
    begun, start = time.process_time(), loose(seed)
    polygons = model(beads).polygons(matching(start, model(beads)).species_radii)
    law = matching_laws(model(beads), polygons)["balanced"]
    # about the stiffness k of contacts, and damping of sqrt(k m), at this pressure
    friction = ld.Friction(mu, kt=0.01, gt=0.05, damping=0.1)
    with ld.Simulation(start, law, friction=friction) as sim:
        state = sim.run(
            4_000_000, pressure=PRESSURE, tolerance=AT_REST, inertial_number=INERTIAL_NUMBER
        )[-1]
    return {
        "mu": mu,
        "beads": beads,
        "seed": seed,
        "phi": state.packing.phi,
        "z": state.coordination,
        "rigid": int(np.sum(~state.rattlers)),
        "seconds": round(time.process_time() - begun, 1),
    }


def friction_of(polygons, rings, name):
    """mu at which rings have z or phi of polygons, between those of the list linear in log(mu)."""
    mu = np.array([each for each in FRICTION if each])
    of_mu = [np.mean([row[name] for row in rings if row["mu"] == each]) for each in mu]
    target = np.mean([row[name] for row in polygons])
    falling = np.minimum.accumulate(of_mu)
    return float(np.exp(np.interp(target, falling[::-1], np.log(mu[::-1]))))


def with_error(polygons, rings, name):
    """That mu and its error, from leaving out packings of both, one after another."""
    mu, first = ld.jackknife(polygons, lambda some: friction_of(some, rings, name))
    seeds = sorted({row["seed"] for row in rings})

    def without(some):
        return friction_of(polygons, [row for row in rings if row["seed"] in some], name)

    return mu, math.hypot(first, ld.jackknife(seeds, without)[1])


def write_beads(found):
    """Print, log and draw which friction of rings polygons of beads have."""
    lines = [f"{'beads':8}{'hollow':10}{'z':19}{'mu by z':17}{'phi':20}mu by phi"]
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for color, beads in enumerate(sorted({row["beads"] for row in found["polygons"]})):
        polygons, rings = (
            [row for row in found[kind] if row["beads"] == beads] for kind in ("polygons", "rings")
        )
        cells = [f"{beads:<8d}{np.mean([row['hollow'] for row in polygons]):<6.2f}"]
        for ax, name, digits in zip(axes, ("z", "phi"), (3, 4), strict=True):
            mean, error = jackknife_mean(polygons, name)
            mu, uncertain = with_error(polygons, rings, name)
            cells.append(f"{mean:.{digits}f} +- {error:.{digits}f}    {mu:.2f} +- {uncertain:.2f}")
            draw_beads(ax, rings, name, (mu, uncertain), (mean, error), f"C{color}", beads)
        lines.append("    ".join(cells))
    axes[0].legend()
    figure.savefig("beads.png", dpi=130)
    plt.close(figure)
    seconds = sum(row["seconds"] for kind in ("polygons", "rings") for row in found[kind])
    count = len({row["seed"] for row in found["polygons"]})
    lines.append(f"{count} packings of polygons; {seconds:.0f} s of processor time")
    print("\n".join(lines))
    Path("beads.log").write_text("\n".join(lines) + "\n")


def jackknife_mean(rows, name):
    """Mean and standard error of a number."""
    return ld.jackknife([row[name] for row in rows])


def draw_beads(ax, rings, name, mu, value, color, beads):
    """Rings over mu as a line, polygons as a point on it."""
    x = np.array(sorted({row["mu"] for row in rings} - {0.0}))
    same = [[row for row in rings if row["mu"] == each] for each in x]
    mean, error = np.array([jackknife_mean(rows, name) for rows in same]).T
    ax.errorbar(x, mean, error, color=color, linewidth=1)
    label = f"polygons, {beads} beads"
    ax.errorbar(mu[0], value[0], value[1], mu[1], "s", color=color, label=label)
    label = {"z": "contacts z", "phi": "$\\phi$"}[name]
    ax.set(xscale="log", xlabel="friction of the rings $\\mu$", ylabel=label)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("plan", nargs="?", default="small", choices=(*PLANS, "beads"))
    parser.add_argument("--workers", type=int, help="processes, all cores if not given")
    asked = options_of(parser, __file__)
    if asked.plan == "beads":
        calls = list(itertools.product(FRICTION, BEADS, range(1, PACKINGS + 1)))
        rings = over_cores(of_rings, calls, asked.workers, "rings_kept")
        calls = [(beads, seed) for beads, count in BEADS.items() for seed in range(1, count + 1)]
        rows = over_cores(of_beads, calls, asked.workers, "beads_kept")
        found = {"pressure": PRESSURE, "polygons": rows, "rings": rings}
        Path("beads.json").write_text(json.dumps(found, indent=1) + "\n")
        write_beads(found)
        return
    number, packings, frictions, pressures, slow = PLANS[asked.plan]
    calls = [
        (number, mu, seed, pressures, slow) for seed in range(1, packings + 1) for mu in frictions
    ]
    keep = f"{asked.plan}_kept"
    rows = over_cores(jammed, calls, asked.workers, keep)
    found = {"number": number, "pressures": pressures, "inertial_number": slow, "packings": rows}
    Path(f"{asked.plan}.json").write_text(json.dumps(found, indent=1) + "\n")
    write(found, asked.plan)


if __name__ == "__main__":
    main()

"""An emulsion of droplets that stick, in space: a loose gel that is compacted, and let go again.

python adhesive_emulsion.py                     100 droplets
python adhesive_emulsion.py --number 250        the figures of the README
"""

import argparse
import json

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

# Droplets have a mean radius of 1 and a tension of 1, which are the units of all that follows.
ADHESIONS = (0.0, 0.05, 0.1, 0.15, 0.2)
RADII, SEEDS = (0.9, 1.1), (1,)
DILUTE, TEMPERATURE, DRAG, STEPS = 0.25, 0.005, 0.3, 2000  # of a gel that gathers in a heat bath
PHI = (0.30, 0.40, 0.50, 0.56, 0.60, 0.64, 0.68, 0.72, 0.76, 0.80)
ABOVE_ONSET = 0.66  # of packings that are jammed without films
LOOSE = 1e-3  # pressure at rest without films, which would part at 0
STRAIN = 1e-4  # of shear, to either side
TOLERANCE = 1e-4  # of forces
SHOWN = 0.1  # adhesion of the gel that is drawn


def droplet(w):
    return ld.Droplet(1.0, adhesion=w)


def modulus(state):
    """Half the difference of the stresses at two opposite strains, over the strain."""
    if not state.coordination:  # nothing bears anything
        return 0.0
    stresses = []
    for strain in (STRAIN, -STRAIN):
        with ld.Simulation(state, state.law) as sim:
            stresses.append(sim.shear(strain, tolerance=TOLERANCE)[-1].shear_stress)
    return (stresses[0] - stresses[1]) / (2.0 * STRAIN)


def contacts_of(state):
    """Number of contacts of each droplet, with a force or a film."""
    return np.bincount(state.contacts["i"], minlength=len(state.packing))


def measure(state):
    number = len(state.packing)
    return {
        "phi": state.phi,
        "contacts": float(contacts_of(state).mean()),
        "pressure": state.pressure,
        "modulus": modulus(state),
        "beyond": state.beyond / number,
    }


def let_go(sim, w):
    """The state that remains without a pressure."""
    if w:
        return sim.relax(TOLERANCE, pressure=0.0, free="tri")
    return sim.relax(TOLERANCE, pressure=LOOSE)


def dilute(number, seed):
    return ld.bidisperse(number, sizes=RADII, phi=DILUTE, dimension=3, seed=seed)


def jam(number, seed):
    """A packing that is jammed without films."""
    return ld.jam(dilute(number, seed), ld.SoftContact(), tolerance=TOLERANCE).packing.at(
        ABOVE_ONSET
    )


def history(w, jammed, seed):
    """What is measured of an emulsion, and two states: the gel, and what was jammed at first."""
    with ld.Simulation(jammed, droplet(w)) as sim:
        dense = let_go(sim, w)
    rows = [("jammed", dense)]
    with ld.Simulation(dilute(len(jammed), seed).push_off() if w else jammed, droplet(w)) as sim:
        if w:
            sim.run(STEPS, temperature=TEMPERATURE, drag=DRAG, seed=seed)
            rows.append(("gel", sim.relax(TOLERANCE)))
        for phi in PHI:
            if w or phi > ABOVE_ONSET:
                rows.append(("compacted", sim.compress(phi=phi, tolerance=TOLERANCE)[-1]))
        rows.append(("let go", let_go(sim, w)))
    measured = [{"state": name} | measure(state) for name, state in rows]
    return {"w": w, "seed": seed, "rows": measured}, (rows[1][1], dense)


def mean(found, w, key):
    """Of the packings: of that which was jammed at first, and at each step of the history."""
    rows = [[row[key] for row in run["rows"]] for run in found if run["w"] == w]
    return np.mean(rows, axis=0)


def show(found):
    heads = ("phi", "contacts", "pressure", "modulus", "beyond")
    print("   w  state     " + "".join(f"{head:>10}" for head in heads))
    for w in ADHESIONS:
        names = [row["state"] for row in found[ADHESIONS.index(w) * len(SEEDS)]["rows"]]
        values = np.transpose([mean(found, w, head) for head in heads])
        for name, row in zip(names, values, strict=True):
            print(
                f"{w:.2f}  {name:<10}" + "".join(f"{round(value, 4) + 0.0:10.4f}" for value in row)
            )


def draw(found, states):
    figure = plt.figure(figsize=(11.0, 7.0), layout="constrained")
    for n, (state, name) in enumerate(zip(states, ("gel", "jammed, then let go"), strict=True)):
        axes = figure.add_subplot(2, 3, n + 1)
        state.plot(
            axes,
            color=contacts_of(state).astype(float),
            vmin=0.0,
            vmax=12.0,
            label="contacts",
            colorbar=n == 1,
            view=(15, 30),
        )
        axes.set_title(f"{name}, w = {SHOWN}, φ = {state.phi:.2f}")
    zero, contacts, pressure, modulus = (figure.add_subplot(2, 3, n) for n in (3, 4, 5, 6))
    colors = plt.get_cmap("viridis")(np.linspace(0.0, 0.85, len(ADHESIONS)))
    for w, color, mark in zip(ADHESIONS, colors, "os^Dv", strict=False):
        phi = mean(found, w, "phi")
        for axes, key in ((contacts, "contacts"), (pressure, "pressure"), (modulus, "modulus")):
            value = mean(found, w, key)
            axes.plot(phi[1:-1], value[1:-1], "-" + mark, color=color, ms=4, label=f"w = {w}")
            axes.plot(phi[-2:], value[-2:], ":" + mark, color=color, ms=4, mfc="none")
    for n, label, mark in ((0, "jammed", "o-k"), (-1, "gel, compacted to 0.8", "s:k")):
        phi = [mean(found, w, "phi")[n] for w in ADHESIONS]
        zero.plot(ADHESIONS, phi, mark, ms=5, label=label)
    zero.set(xlabel="w [γ]", ylabel="packing fraction φ, let go")
    contacts.set(ylabel="contacts of a droplet")
    pressure.set(ylabel="pressure [γ/R]")
    modulus.set(ylabel="shear modulus [γ/R]")
    for axes in (contacts, pressure, modulus):
        axes.set_xlabel("packing fraction φ")
    zero.legend(frameon=False)
    contacts.legend(frameon=False)
    figure.savefig("adhesive_emulsion.png", dpi=80, pil_kwargs={"optimize": True})


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("--number", type=int, default=100, help="droplets")
    number = options.parse_args().number
    jammed = ld.parallel_map(lambda seed: jam(number, seed), SEEDS)
    begins = list(zip(jammed, SEEDS, strict=True))
    calls = [(w, *begin) for w in ADHESIONS for begin in begins]
    found, states = zip(*ld.parallel_map(lambda call: history(*call), calls), strict=True)
    with open("adhesive_emulsion.json", "w") as file:
        json.dump(found, file, separators=(",", ":"))
    show(found)
    draw(found, states[ADHESIONS.index(SHOWN) * len(SEEDS)])

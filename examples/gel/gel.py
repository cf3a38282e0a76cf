"""A gel under shear: droplets that stick gather in a heat bath, come to rest, and are sheared.

Stress and films against strain for several adhesions, and the balance of work and energy.
"""

from itertools import pairwise

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

ADHESIONS = (0.02, 0.05, 0.1)  # over the tension
SHOWN = 0.05  # whose first gel is drawn
SEEDS = (1, 2, 3, 4)
NUMBER = 100  # droplets, with radii of 0.45 to 0.55
PHI = 0.7  # without adhesion they jam at 0.83 to 0.85
STEPS, TIMESTEP = 6000, 0.02
TEMPERATURE, FRICTION = 0.005, 0.3
SMALL = 1e-3  # strain by which moduli are measured
STRAIN, SHEARS = 1.0, 100


def droplet(adhesion):
    """Conserves its area, and has a tension of 1."""
    return ld.Ring(kA=np.inf, kP=0.0, tension=1.0, contact="curved", adhesion=adhesion)


def free_droplets(seed):
    """At random positions, where they do not touch."""
    radius = np.random.default_rng(seed).uniform(0.45, 0.55, NUMBER)
    start = ld.bidisperse(NUMBER, phi=PHI, seed=seed)
    box = start.box * np.sqrt(np.pi * np.sum(radius**2) / PHI / np.linalg.det(start.box))
    place = start.positions @ np.linalg.solve(start.box, box)
    species = np.zeros(NUMBER, int)
    return ld.Packing(place, radius, box, species=species).push_off()


def films_of(state):
    """The pairs of droplets that films join."""
    films = state.contacts[state.contacts["attached"]]
    pairs = zip(films["i"].tolist(), films["j"].tolist(), strict=True)
    return {(i, j) for i, j in pairs if i < j}


def gel(adhesion, seed):
    """The states of a gel: at rest, and after each step of shear."""
    with ld.Simulation(free_droplets(seed), droplet(adhesion)) as sim:
        bath = {"temperature": TEMPERATURE, "drag": FRICTION, "seed": seed}
        sim.run(STEPS, timestep=TIMESTEP, **bath)
        yield sim.relax()
        yield from sim.shear(STRAIN, steps=SHEARS)[1:]


def modulus(state, law):
    """Half the difference of the stresses at two opposite strains, over the strain."""
    stresses = []
    for strain in (SMALL, -SMALL):
        with ld.Simulation(state, law) as sim:
            stresses.append(sim.shear(strain)[-1].shear_stress)
    return (stresses[0] - stresses[1]) / (2.0 * SMALL)


def measure(adhesion, seed):
    """What is drawn and printed of a gel, with three of its states."""
    states = list(gel(adhesion, seed))
    stress = np.array([state.shear_stress for state in states])
    energy = np.array([state.energy for state in states])
    area = np.linalg.det(states[0].packing.box)
    films = [films_of(state) for state in states]
    return {
        "modulus": modulus(states[0], droplet(adhesion)),
        "stress": stress,
        "energy": energy[1:] - energy[0],
        # of each step, by the mean of the stresses before and after it
        "work": area * STRAIN / SHEARS * 0.5 * (stress[1:] + stress[:-1]),
        "films": 2 * len(films[0]) / NUMBER,
        "attach": np.array([len(after - before) for before, after in pairwise(films)]),
        "let go": np.array([len(before - after) for before, after in pairwise(films)]),
        "states": [states[n] for n in (0, stress.argmax(), SHEARS)],
    }


def strains():
    return np.linspace(0, STRAIN, SHEARS + 1)


def show(adhesion, seed, found):
    """The balance of work and energy of a gel, and that of the steps that no film comes or goes."""
    work = found["work"]
    lost = work - np.diff(found["energy"], prepend=0.0)
    elastic = found["attach"] + found["let go"] == 0
    off = np.abs(lost[elastic]).sum() / np.abs(work[elastic]).sum()
    print(
        f"adhesion {adhesion:.2f}  seed {seed}  work {work.sum():.4f}  "
        f"energy {found['energy'][-1]:.4f}  lost {lost.sum():.4f}  "
        f"elastic steps {elastic.sum()}  work {work[elastic].sum():.4f}  off by {off:.0e}"
    )


def mean(values):
    """The mean of independent values and its standard error."""
    error = np.std(values, ddof=1) / np.sqrt(len(values))
    return f"{round(np.mean(values), 3) + 0.0:.3f} ± {error:.3f}"  # without the sign of a zero


def summarize(adhesion, gels):
    """What the gels of an adhesion have in common."""
    largest = [found["stress"].argmax() for found in gels]
    print(
        f"adhesion {adhesion:.2f}  films {mean([found['films'] for found in gels])}  "
        f"modulus {mean([found['modulus'] for found in gels])}  "
        f"stress {mean([found['stress'].max() for found in gels])} at {mean(strains()[largest])}  "
        f"attach {np.mean([found['attach'].sum() for found in gels]):.0f}  "
        f"let go {np.mean([found['let go'].sum() for found in gels]):.0f}"
    )


def main():
    calls = [(adhesion, seed) for adhesion in (0.0, *ADHESIONS) for seed in SEEDS]
    found = ld.parallel_map(lambda call: measure(*call), calls)
    gels = dict(zip(calls, found, strict=True))
    for call in calls[len(SEEDS) :]:
        show(*call, gels[call])

    figure, axes = plt.subplots(2, 3, figsize=(10, 7), layout="constrained")
    stresses, films, energies = axes[1]
    for adhesion in (0.0, *ADHESIONS):
        each = [gels[adhesion, seed] for seed in SEEDS]
        if adhesion:
            summarize(adhesion, each)
        else:
            print(f"no adhesion  stress {max(np.abs(one['stress']).max() for one in each):.0e}")
        curve = np.mean([one["stress"] for one in each], axis=0)
        stresses.plot(strains(), curve, label=f"w = {adhesion}")
    stresses.set(xlabel="strain", ylabel="shear stress", ylim=(None, 0.15))
    stresses.legend(frameon=False, ncols=2, loc="upper center")

    shown = gels[SHOWN, SEEDS[0]]
    for ax, state in zip(axes[0], shown["states"], strict=True):
        title = f"w = {SHOWN}, strain {state.shear_strain or 0.0:.2f}"
        state.plot(ax, forces=True, title=title, vmin=0.0, vmax=4.0, colorbar=False)
    for name in ("attach", "let go"):
        films.plot(strains()[1:], np.cumsum(shown[name]), label=name)
    films.set(xlabel="strain", ylabel="number of films")
    work = np.cumsum(shown["work"])
    energies.plot(strains()[1:], work, label="work")
    energies.plot(strains()[1:], shown["energy"], label="energy")
    energies.plot(strains()[1:], work - shown["energy"], label="lost")
    energies.set(xlabel="strain", ylabel="energy")
    for ax in (films, energies):
        ax.legend(frameon=False)
    figure.savefig("gel.png", dpi=72, pil_kwargs={"optimize": True})


if __name__ == "__main__":
    main()

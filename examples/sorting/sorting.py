"""Cells of two kinds sort themselves: those that stick more gather, the others surround them."""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

COHESIVE, WEAK = 0, 1  # the two kinds, half of the cells each
CASES = {  # adhesions over the tension
    "unequal": [[0.2, 0.05], [0.05, 0.02]],
    "equal": [[0.1, 0.1], [0.1, 0.1]],
}
NUMBER = 60
PHI = 0.6  # of the round container
SEEDS = (1, 2, 3)
ROUNDS, STEPS = 30, 1000
TIMESTEP = 0.02
TEMPERATURE, FRICTION = 0.015, 0.3


def mixture(seed):
    """Cells of radius 0.5 at random positions, where they do not overlap, in a round container."""
    rng = np.random.default_rng(seed)
    container = ld.Sphere(np.sqrt(0.25 * NUMBER / PHI), (0, 0))
    distance = (container.radius - 0.5) * np.sqrt(rng.uniform(size=NUMBER))
    angle = rng.uniform(0, 2 * np.pi, NUMBER)
    place = np.column_stack([distance * np.cos(angle), distance * np.sin(angle)])
    kinds = np.arange(NUMBER) % 2
    cells = ld.Packing(place, 0.5, np.eye(2), species=kinds, walls=[container])
    return cells.push_off()


def unlike(state):
    """Part of the films that are between cells of different kinds."""
    films = state.contacts[state.contacts["attached"]]
    kinds = state.packing.species
    return np.mean(kinds[films["i"]] != kinds[films["j"]]) if len(films) else np.nan


def distance(state, kind):
    """Mean distance of the cells of a kind from the center of the container."""
    return np.hypot(*state.packing.positions[state.packing.species == kind].T).mean()


def sort(adhesion, seed):
    """The first state, and those of its motion in a heat bath."""
    law = ld.Ring(kA=20.0, kP=0.0, tension=1.0, contact="curved", adhesion=adhesion)
    with ld.Simulation(mixture(seed), law) as sim:
        yield sim.state()
        yield from sim.run(
            ROUNDS * STEPS,
            timestep=TIMESTEP,
            temperature=TEMPERATURE,
            drag=FRICTION,
            every=STEPS,
            seed=seed,
        )[1:]


def draw(state, axes, name):
    """A picture colored by kind: the cohesive cells are dark."""
    state.plot(axes, title=f"{name}, t = {state.time:.0f}", colorbar=False)
    axes.collections[0].set(array=state.packing.species, cmap="Blues_r", clim=(-0.6, 1.4))


def main():
    figure = plt.figure(figsize=(8.4, 5.8), layout="constrained")
    top, bottom = figure.subfigures(2, 1)
    pictures, (films, places) = top.subplots(1, 3), bottom.subplots(1, 2)
    for row, (name, adhesion) in enumerate(CASES.items()):
        runs = [list(sort(adhesion, seed)) for seed in SEEDS]
        times = [state.time for state in runs[0]]
        parts = np.array([[unlike(state) for state in run] for run in runs])
        inside, outside = (
            np.array([[distance(state, kind) for state in run] for run in runs])
            for kind in (COHESIVE, WEAK)
        )
        late = slice(ROUNDS // 2, None)
        for n, seed in enumerate(SEEDS):
            print(
                f"{name:7}  seed {seed}  "
                f"unlike films {parts[n, 1]:.2f} to {parts[n, late].mean():.2f}  "
                f"distances {inside[n, late].mean():.2f} and {outside[n, late].mean():.2f}"
            )
        films.plot(times, parts.mean(axis=0), label=name)
        for values, style in ((inside, "-"), (outside, "--")):
            kind = "cohesive" if values is inside else "weak"
            places.plot(times, values.mean(axis=0), f"C{row}{style}", label=f"{name}, {kind}")
        draw(runs[0][-1], pictures[row + 1], name)
        if row == 0:
            draw(runs[0][0], pictures[0], name)
    films.set(xlabel="time", ylabel="unlike films", ylim=(0, 0.7))
    places.set(xlabel="time", ylabel="distance from the center", ylim=(2.2, None))
    films.legend(frameon=False)
    places.legend(fontsize=7, loc="lower left", ncols=2, frameon=False)
    figure.savefig("sorting.png", dpi=72, pil_kwargs={"optimize": True})


if __name__ == "__main__":
    main()

"""Cells of two kinds sort themselves: those that stick more gather, the others surround them.

python sorting.py                  in the plane
python sorting.py --dimension 3    in space
"""

import argparse
from typing import NamedTuple

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

COHESIVE, WEAK = 0, 1  # the two kinds, half of the cells each


class Scene(NamedTuple):
    """Cells of radius 0.5 and tension 1 in a round container, in a heat bath."""

    unequal: float  # adhesion of two cohesive cells; of equal cells all have 0.1
    number: int
    phi: float  # of the container
    temperature: float
    timestep: float
    balance: float  # of contacts, over the largest force

    def law(self, name):
        strong = self.unequal
        adhesion = 0.1 if name == "equal" else [[strong, 0.05], [0.05, 0.02]]
        if self is SCENES[3]:
            return ld.Droplet(1.0, adhesion=adhesion)
        return ld.Ring(kA=20.0, kP=0.0, tension=1.0, contact="curved", adhesion=adhesion)


SCENES = {
    2: Scene(unequal=0.2, number=60, phi=0.6, temperature=0.015, timestep=0.02, balance=1e-8),
    3: Scene(unequal=0.15, number=100, phi=0.45, temperature=0.003, timestep=0.1, balance=1e-6),
}
SEEDS = (1, 2, 3)
ROUNDS, STEPS = 30, {2: 1000, 3: 300}
FRICTION = 0.3


def mixture(scene, dimension, seed):
    """Cells at random positions, where they do not overlap."""
    rng = np.random.default_rng(seed)
    container = ld.Sphere(0.5 * (scene.number / scene.phi) ** (1 / dimension), (0,) * dimension)
    distance = (container.radius - 0.5) * rng.uniform(size=scene.number) ** (1 / dimension)
    angle = rng.uniform(0, 2 * np.pi, scene.number)
    place = np.column_stack([np.cos(angle), np.sin(angle)])
    if dimension == 3:
        height = rng.uniform(-1, 1, scene.number)[:, None]
        place = np.hstack([np.sqrt(1 - height**2) * place, height])
    place *= distance[:, None]
    kinds = np.arange(scene.number) % 2
    cells = ld.Packing(place, 0.5, np.eye(dimension), species=kinds, walls=[container])
    return cells.push_off()


def unlike(state):
    """Part of the films that are between cells of different kinds."""
    films = state.contacts[state.contacts["attached"]]
    kinds = state.packing.species
    return np.mean(kinds[films["i"]] != kinds[films["j"]]) if len(films) else np.nan


def distance(state, kind):
    """Mean distance of the cells of a kind from the center of the container."""
    return np.linalg.norm(state.packing.positions[state.packing.species == kind], axis=1).mean()


def sort(name, dimension, seed):
    """The first state, and those of its motion in a heat bath."""
    scene = SCENES[dimension]
    with ld.Simulation(mixture(scene, dimension, seed), scene.law(name)) as sim:
        yield sim.state()
        yield from sim.run(
            ROUNDS * STEPS[dimension],
            timestep=scene.timestep,
            temperature=scene.temperature,
            drag=FRICTION,
            every=STEPS[dimension],
            seed=seed,
            balance=scene.balance,
        )[1:]


def draw(state, axes, name):
    """A picture colored by kind: cohesive cells are dark. In space it is a cut in the middle."""
    cut = 0.0 if state.packing.dimension == 3 else None
    title = f"{name}, t = {state.time:.0f}"
    kinds = state.packing.species + 0.01  # no whole numbers, which have other colors
    look = {"cmap": "Blues_r", "vmin": -0.6, "vmax": 1.4, "colorbar": False}
    state.plot(axes, color=kinds, title=title, slice=cut, **look)


def main(dimension, stem):
    figure = plt.figure(figsize=(8.4, 5.8), layout="constrained")
    top, bottom = figure.subfigures(2, 1)
    pictures, (films, places) = top.subplots(1, 3), bottom.subplots(1, 2)
    for row, name in enumerate(("unequal", "equal")):
        runs = [list(sort(name, dimension, seed)) for seed in SEEDS]
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
                f"distances {inside[n, late].mean():.2f} and {outside[n, late].mean():.2f}",
                flush=True,
            )
        films.plot(times, parts.mean(axis=0), label=name)
        for values, style in ((inside, "-"), (outside, "--")):
            kind = "cohesive" if values is inside else "weak"
            places.plot(times, values.mean(axis=0), f"C{row}{style}", label=f"{name}, {kind}")
        draw(runs[0][-1], pictures[row + 1], name)
        if row == 0:
            draw(runs[0][0], pictures[0], name)
    films.set(xlabel="time", ylabel="unlike films", ylim=(0, 0.7))
    low, high = places.get_ylim()
    places.set(
        xlabel="time", ylabel="distance from the center", ylim=(low - 0.4 * (high - low), high)
    )
    films.legend(frameon=False)
    places.legend(fontsize=7, loc="lower left", ncols=2, frameon=False)
    figure.savefig(f"{stem}.png", dpi=72, pil_kwargs={"optimize": True})


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("--dimension", type=int, default=2, choices=SCENES)
    dimension = options.parse_args().dimension
    main(dimension, {2: "sorting", 3: "sorting_3d"}[dimension])

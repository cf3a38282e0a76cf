"""An emulsion that creams: droplets lighter than the liquid rest below a ceiling.

python -m validation.emulsion_3d.own_weight --number 128 --columns 2

Each column is written to own_weight_NUMBER.json when it is there, and not measured again. The
pressures to compare with are those of emulsion_3d_512.json.
"""

import argparse
import json
from pathlib import Path

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

from validation import options_of
from validation.emulsion_3d.__main__ import KINDS, RADII, height, means, onset, with_error
from validation.ensembles import over_cores

WIDTH = 10.0  # of a column of 512, which is periodic across; others have its shape
HIGHEST = 0.25  # pressure of all droplets together on the ceiling [tension/R32]
SLABS = 6  # of equal height, from one diameter above the lower end to one below the ceiling
DIAMETER = 2.0 * np.mean(RADII)
HEADS = ("height", "weight below", "phi", "phi by the measured pressure", "stress along", "across")


def column(number, seed):
    """Droplets at rest below the ceiling; a row for each slab, see `slabs`."""
    width = WIDTH * (number / 512) ** (1 / 3)
    loose = ld.bidisperse(number, sizes=RADII, phi=0.5, dimension=3, seed=seed)
    tall = loose.volume / width**2
    start = ld.bidisperse(number, sizes=RADII, phi=0.5, dimension=3, aspect=tall / width, seed=seed)
    floor = ld.Plane((0, 0, 0), (0, 0, 1))
    ceiling = ld.Plane((0, 0, tall), (0, 0, -1))
    start = start.between([floor, ceiling]).push_off()
    r32 = np.sum(start.radii**3) / np.sum(start.radii**2)
    weight = HIGHEST / r32 * width**2 / (0.5 * start.volume)  # of a unit of volume
    lift = weight * 4.0 / 3.0 * np.pi * np.array(RADII) ** 3  # of each species
    with ld.Simulation(start, ld.Droplet(tension=1.0), gravity=np.outer(lift, (0, 0, 1))) as sim:
        state = sim.relax(1e-5)
    return {"seed": seed, "load": float(state.loads.max()), "rows": slabs(state, r32, weight)}


def slabs(state, r32, weight):
    """Height, pressure by the weight below, phi, vertical and other stress of slabs, from below.

    Lengths are in units of tension/(R32 weight), pressures in units of tension/R32.
    """
    box, place = state.packing.box, state.packing.positions[:, 2]
    floor = float((place - state.packing.radii).min())
    edges = np.linspace(floor + DIAMETER, box[2, 2] - DIAMETER, SLABS + 1)
    area = box[0, 0] * box[1, 1]
    below = np.array([volume_below(edge, place, state.packing.radii) for edge in edges])
    inside = np.digitize(place, edges) - 1
    stress = np.einsum("naa,n->na", state.particle_stress, state.volumes)
    middle, room = 0.5 * (edges[1:] + edges[:-1]) - floor, area * np.diff(edges)
    along, across = (
        np.array([each[inside == n].sum() for n in range(SLABS)]) / room * r32
        for each in (stress[:, 2], 0.5 * (stress[:, 0] + stress[:, 1]))
    )
    lifted = 0.5 * (below[1:] + below[:-1]) / area * weight * r32
    rows = middle * r32 * weight, lifted, np.diff(below) / room, along, across
    return np.transpose(rows).tolist()


def volume_below(edge, place, radius):
    """Volume of spheres below a height."""
    depth = np.clip(edge - place + radius, 0.0, 2.0 * radius)
    return float(np.sum(np.pi * depth**2 * (radius - depth / 3.0)))


def expected(pressure, packings):
    """phi at a pressure, between those that were measured in a periodic box."""
    measured = means(packings, KINDS[0])[0]
    return np.interp(
        pressure, [0.0, *measured["pressure"]], [onset(packings, KINDS[0])[0], *measured["phi"]]
    )


def profile(columns):
    """Means over the columns and their errors, each of shape (quantities, slabs)."""
    rows = [np.transpose(one["rows"]) for one in columns]
    return ld.jackknife(rows, lambda some: np.mean(some, axis=0))


def table(columns, packings):
    """The lines of the table."""
    yield "| " + " | ".join(HEADS) + " |"
    yield "|" + "---|" * len(HEADS)
    values, errors = profile(columns)
    for row, error in zip(values.T, errors.T, strict=True):
        _, weight, phi, along, across = map(with_error, row, error)
        cells = f"{row[0]:.3f}", weight, phi, f"{expected(row[1], packings):.4f}", along, across
        yield "| " + " | ".join(cells) + " |"


def draw(columns, packings, file):
    """phi over the height, beside the integral of the measured pressure."""
    figure, axes = plt.subplots(figsize=(4.6, 4.2), layout="constrained")
    (place, _, phi, _, _), errors = profile(columns)
    axes.errorbar(phi, place, xerr=errors[2], fmt="o", ms=4, label="below a ceiling")
    measured = means(packings, KINDS[0])[0]
    above, dense = height(measured["phi"], measured["pressure"], onset(packings, KINDS[0])[0])
    axes.plot(dense, above[0] - above, "k-", lw=1, label="by the pressure in periodic boxes")
    axes.set(xlabel=r"$\phi$", ylabel=r"height [$\gamma/(R_{32}\,\Delta\rho\,g)$]")
    axes.legend(frameon=False)
    figure.savefig(file, dpi=80)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=512, help="droplets of a column")
    parser.add_argument("--columns", type=int, default=4)
    parser.add_argument("--workers", type=int, help="columns at a time")
    asked = options_of(parser, __file__)
    packings = json.loads((Path(__file__).parent / "emulsion_3d_512.json").read_text())
    file = Path(f"own_weight_{asked.number}.json")
    columns = json.loads(file.read_text()) if file.exists() else []
    known = {one["seed"] for one in columns}
    calls = [(asked.number, seed) for seed in range(1, asked.columns + 1) if seed not in known]
    columns += over_cores(column, calls, asked.workers, file.with_suffix(".kept"))
    file.write_text(json.dumps(columns))
    columns.sort(key=lambda one: one["seed"])
    print(*table(columns, packings), sep="\n")
    draw(columns, packings, file.with_suffix(".png"))


if __name__ == "__main__":
    main()

"""Clusters of droplets that stick: the law beside exact shapes, in which films turn and bend.

    python -m validation.droplet_shapes.clusters [--out FOLDER] [--cases ...]

Clusters are at rest; or all centers are moved apart in proportion, until a film of the law bears
half of the largest pull, pi sin(theta)^2/4. The forces that hold them there are those on the exact
droplets. They act as in the law on the centers of the spheres that go on behind the films, or on
the volumes, as a weight does.
"""

from __future__ import annotations

import argparse
import json
import math
import time
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import lammps_deformable as ld
import numpy as np
from lammps_deformable.reference.exact_droplets import LEFT
from lammps_deformable.reference.exact_films import (
    VOLUME,
    Cluster,
    cluster_of,
    extrapolated,
    solve,
)
from scipy.spatial.transform import Rotation

HERE = Path(__file__).parent
ANGLES = (0.2, 0.35, 0.5)
REST, CENTERS, VOLUMES = "at rest", "centers pulled", "volumes pulled"

# Of the first one in unlike clusters.
UNLIKE = 1.4

# Nodes of the first mesh of a droplet, and of a rim: the fewer the more droplets, and more for a
# single film with a small angle, which has little energy.
_NODES = {2: (300, 24), 4: (300, 24), 6: (200, 24), 13: (120, 16)}
_SINGLE, _SMALL_ANGLE = (600, 24), 0.3

# Distances of neighbors at the start, over the sum of radii, and steps in which centers are moved.
_START, _STEP = 0.985, 0.002


class Case(NamedTuple):
    """Droplets, the contact angle of like ones, and how they are held."""

    droplets: str
    angle: float
    way: str

    def __str__(self) -> str:
        return f"{self.droplets}, angle {self.angle:g}, {self.way}"


SORTS = ("2", "4", "4 of radii 1 : 1.4", "4 of tensions 1 : 1.4", "6", "13")

# Films of 13 droplets cover more than half of the middle one at 0.5.
CASES = [
    Case(droplets, angle, way)
    for droplets in SORTS
    for angle in (ANGLES[:2] if droplets == "13" else ANGLES)
    for way in (REST, CENTERS, VOLUMES)
    if way != VOLUMES or angle == ANGLES[-1]
]


def start(droplets: str) -> tuple[np.ndarray, np.ndarray]:
    """Centers, and radii: a pair, a tetrahedron, an octahedron, one of fcc and its neighbors."""
    number = int(droplets.split()[0])
    radii = np.ones(number)
    if "radii" in droplets:
        radii[0] = UNLIKE
    if number == 4:
        side = 2.0 * _START
        turn = 2.0 * math.pi * np.arange(3) / 3.0
        base = np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn]) * side / math.sqrt(3.0)
        height = math.sqrt((_START * (1.0 + radii[0])) ** 2 - side**2 / 3.0)
        return np.concatenate([[(0.0, 0.0, height)], base]), radii
    steps = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
    size = np.abs(steps).sum(axis=1)
    chosen = {
        2: steps[[0, -1]] / math.sqrt(3.0),
        6: math.sqrt(2.0) * steps[size == 1],
        13: math.sqrt(2.0) * np.concatenate([steps[size == 0], steps[size == 2]]),
    }
    return _START * chosen[number], radii


def held(case: Case) -> tuple[ld.State, float]:
    """The cluster by the law, and the seconds of processor time that it takes."""
    centers, radii = start(case.droplets)
    kinds, tension = np.zeros(len(radii), dtype=int), [1.0]
    if "tensions" in case.droplets:
        kinds[0], tension = 1, [1.0, UNLIKE]
    law = ld.Droplet(tension, adhesion=2.0 * (1.0 - math.cos(case.angle)))
    packing = ld.Packing(centers + 10.0, radii, (20.0,) * 3, species=kinds)
    began = time.process_time()
    with ld.Simulation(packing, law) as sim:
        with warnings.catch_warnings():  # the mean force, by which rest is judged, goes to zero
            warnings.simplefilter("ignore", ld.StalledWarning)
            state = sim.relax(1e-10)
        least = -math.pi * math.sin(case.angle) ** 2 / 4.0
        rest = state.packing.positions
        middle, size = rest.mean(axis=0), 1.0

        def at(size: float) -> ld.State:
            x = np.ascontiguousarray(middle + size * (rest - middle))
            sim.lmp.scatter("x", 1, 3, np.ctypeslib.as_ctypes(x.ravel()))
            return sim.state()

        while case.way != REST and (force := float(state.contacts["force"].min())) > least:
            after = at(size + _STEP)
            pull = float(after.contacts["force"].min())
            if pull < least:
                state = at(size + _STEP * (least - force) / (pull - force))
                break
            size, state = size + _STEP, after
    return state, time.process_time() - began


def measure(case: Case) -> dict[str, Any]:
    """By the law and exact, with what the exact ones are uncertain by."""
    state, seconds = held(case)
    table, outer = state.contacts, np.zeros_like(state.packing.positions)
    if case.way != REST:
        np.add.at(outer, table["i"], -table["force_vector"])
    cluster = cluster_of(state, outer)._replace(spheres=case.way == CENTERS)
    single = len(cluster.films) == 1 and case.angle < _SMALL_ANGLE
    levels = solve(cluster, *(_SINGLE if single else _NODES[len(cluster.radii)]))

    def limit(name: str) -> tuple[np.ndarray, np.ndarray]:
        return extrapolated(*(np.array(getattr(level, name)) for level in levels))

    (areas, _), (forces, of_force), (centers, of_center) = map(
        limit, ("areas", "forces", "centroids")
    )
    exact, uncertain = _energy([float(level.energies.sum()) for level in levels])
    off = _apart(state.packing.positions, centers + _behind(cluster, areas))
    one = table[table["i"] < table["j"]]
    normal = np.einsum("mj,mj->m", forces, cluster.axes())
    scale = np.abs(normal).mean() + 0.5 * math.pi * math.sin(case.angle) ** 2
    return {
        "case": str(case),
        "films": len(one),
        "cover": float(np.max(state.contact_areas / (4.0 * math.pi * cluster.radii**2))),
        "energy": state.energy,
        "energies on meshes": [float(level.energies.sum()) for level in levels],
        "exact energy": exact,
        "error of the exact energy": uncertain,
        "largest error of a position": off,
        "error of the exact positions": float(np.abs(of_center).max()),
        "pull over the largest": float(-normal.min() / (0.5 * math.pi * math.sin(case.angle) ** 2)),
        "largest error of a force": float(np.abs(one["force"] - normal).max() / scale),
        "error of the exact forces": float(np.abs(of_force).max() / scale),
        "nodes": levels[-1].nodes,
        "seconds of the law": seconds,
        "seconds": levels[-1].seconds,
    }


def _energy(levels: list[float]) -> tuple[float, float]:
    """The limit if the last two differences are of one geometric series, and how far it is from
    that of powers of the edges, the square and then between the third and the fourth."""
    coarse, middle, fine = levels
    part = min(max((fine - middle) / (middle - coarse), 1.0 / 16.0), 1.0 / 4.0)
    found = fine + (fine - middle) * part / (1.0 - part)
    last, change = extrapolated(*map(np.array, levels))
    return found, abs(found - float(last + LEFT * change))


def _behind(cluster: Cluster, areas: np.ndarray) -> np.ndarray:
    """From centroids to the centers of the spheres that go on behind the films."""
    found = np.zeros_like(cluster.centers)
    for film, axis, area in zip(cluster.films, cluster.axes(), areas, strict=True):
        moment = area**2 / (4.0 * math.pi) * axis
        found[film.i] += moment / (VOLUME * cluster.radii[film.i] ** 3)
        found[film.j] -= moment / (VOLUME * cluster.radii[film.j] ** 3)
    return found


def _apart(one: np.ndarray, other: np.ndarray) -> float:
    """Largest distance of points of two clusters, one of which is shifted and turned."""
    one, other = (each - each.mean(axis=0) for each in (one, other))
    with warnings.catch_warnings():  # of two droplets a turn about their line is free
        warnings.simplefilter("ignore", UserWarning)
        turn, _ = Rotation.align_vectors(other, one)
    return float(np.linalg.norm(turn.apply(one) - other, axis=1).max())


def line(row: dict[str, Any]) -> list[str]:
    """Errors of energy, positions and forces, and what exact ones are uncertain by, per cent."""
    exact = abs(row["exact energy"])
    off = (row["energy"] - row["exact energy"]) / exact
    found = [f"{100.0 * off:+.2f}±{100.0 * row['error of the exact energy'] / exact:.2f}"]
    for name in ("position", "force"):
        largest, error = row[f"largest error of a {name}"], row[f"error of the exact {name}s"]
        found.append(f"{100.0 * largest:.2f}±{100.0 * error:.2f}")
    return found


def markdown(rows: list[dict[str, Any]]) -> str:
    """The table of the page: the largest errors of each way to hold clusters."""
    lines = ["| | clusters | energy | position | force |", "|---|---|---|---|---|"]
    for way in (REST, CENTERS, VOLUMES):
        these = [row for row in rows if row["case"].endswith(way)]
        cells = [str(len(these))]
        for n, key in enumerate(("energy", "position", "force")):
            cells.append(line(max(these, key=lambda row, key=key: error(row, key)))[n])
        lines.append(f"| {way} | {' | '.join(cells)} |")
    return "\n".join(lines)


def error(row: dict[str, Any], key: str) -> float:
    """Of the law: of the energy over the exact one, or of a position or a force."""
    if key == "energy":
        return abs(float(row["energy"] / row["exact energy"]) - 1.0)
    return float(row[f"largest error of a {key}"])


def main() -> None:
    names = [str(case) for case in CASES]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE)
    parser.add_argument("--cases", nargs="+", choices=names, default=names)
    options = parser.parse_args()
    file = options.out / "clusters.json"
    found = (
        {row["case"]: row for row in json.loads(file.read_text())["rows"]} if file.exists() else {}
    )
    for case in CASES:
        if str(case) in options.cases and str(case) not in found:
            found[str(case)] = row = measure(case)
            print(case, *line(row), f"{row['seconds']:.0f} s", sep=" | ", flush=True)
            rows = [found[name] for name in names if name in found]
            file.write_text(json.dumps({"rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()

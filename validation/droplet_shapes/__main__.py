"""Crystals of droplets: exact osmotic pressures and elastic energies, and those of the law.

    python -m validation.droplet_shapes [--out FOLDER]

In a crystal all droplets are alike, so that one between the planes to its neighbors is exact. Where
it is strained films turn: there it is one droplet and its images, with films as unknowns.
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
from lammps_deformable.reference.exact_droplets import VOLUME, exact_packing, shape

HERE = Path(__file__).parent
PHI = {
    "fcc": (0.79, 0.81, 0.83, 0.85, 0.87, 0.89),
    "bcc": (0.70, 0.73, 0.76, 0.79, 0.82, 0.85),
    "sc": (0.56, 0.60, 0.65, 0.70),
}

# Strains of the fcc crystal at this packing fraction. A stretch by e keeps the volume: z grows by
# exp(e), x and y by exp(-e/2). A shear by g moves x by g y. Both are along the axes of the cube.
STRAINED = 0.8
STRAINS = (
    *(("stretch", -0.05), ("stretch", 0.05), ("stretch", 0.1)),
    *(("shear", 0.05), ("shear", 0.1), ("shear", 0.15)),
)

# Cubic cells have so many droplets.
_CELL = {"fcc": 4, "bcc": 2, "sc": 1}


def neighbors(kind: str) -> np.ndarray:
    """Vectors to the nearest neighbors, in lattice constants."""
    steps = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
    if kind == "bcc":
        return steps[np.abs(steps).sum(axis=1) == 3] / 2.0
    if kind == "fcc":
        return steps[np.abs(steps).sum(axis=1) == 2] / 2.0
    return steps[np.abs(steps).sum(axis=1) == 1]


def exact(kind: str, phi: float) -> dict[str, float]:
    """Osmotic pressure and load of droplets of radius 1, tension 1, by P V = p v - (2/3) A."""
    cell = _CELL[kind] * VOLUME / phi
    away = neighbors(kind) * cell ** (1.0 / 3.0)
    distance = np.linalg.norm(away, axis=1)
    found = shape(away / distance[:, None], 1.0 - 0.5 * distance)
    volume, part = VOLUME / phi, 2.0 / 3.0
    pressure = (found.pressure * VOLUME - part * (4.0 * math.pi + found.energy)) / volume
    error = (found.pressure_error * VOLUME + part * found.energy_error) / volume
    return {"exact": pressure, "error": error, "load": found.forces.sum() / (8.0 * math.pi)}


def law(kind: str, phi: float) -> float:
    """Osmotic pressure of the law."""
    packing = ld.crystal(kind, 3, phi=phi)
    with ld.Simulation(packing, ld.Droplet()) as sim:
        return float(sim.state().pressure * packing.radii[0])


def strained(kind: str, strain: float) -> dict[str, float]:
    """Energy of a droplet of the strained fcc crystal: exact, its error, and by the law."""
    change = np.diag(np.exp([-0.5 * strain, -0.5 * strain, strain]))
    if kind == "shear":
        change = np.eye(3) + strain * np.outer([1, 0, 0], [0, 1, 0])
    half = 0.5 * (_CELL["fcc"] * VOLUME / STRAINED) ** (1.0 / 3.0)
    # one lattice vector along x, the next one in the xy plane
    _, turned = np.linalg.qr(change @ (half * np.array([[1, 0, 1], [1, 1, 0], [0, 1, 1]])))
    box = (np.diag(np.sign(turned.diagonal())) @ turned).T
    with ld.Simulation(ld.Packing(np.zeros((1, 3)), 1.0, box), ld.Droplet()) as sim:
        state = sim.state()
    found = exact_packing(state).found
    return {"exact": float(found.energies[0]), "error": found.energy_error, "law": state.energy}


def strained_markdown(rest: dict[str, float], rows: list[dict[str, Any]]) -> str:
    """The table of strains of the page: what energies grow by."""
    lines = ["| | strain | exact | law: % |", "|---|---|---|---|"]
    for row in rows:
        exact, law = (row[name] - rest[name] for name in ("exact", "law"))
        part, error = 100.0 * (law / exact - 1.0), 100.0 * (row["error"] + rest["error"]) / exact
        numbers = f"{exact:.6f} | {part:+.2f}±{error:.2f}"
        lines.append(f"| {row['kind']} | {row['strain']:g} | {numbers} |")
    return "\n".join(lines)


def markdown(rows: list[dict[str, Any]]) -> str:
    """The table of the page."""
    lines = ["| | phi | load | exact | law: % |", "|---|---|---|---|---|"]
    for row in rows:
        digits = max(2, 1 - math.floor(math.log10(row["error"])))
        numbers = f"{row['load']:.3f} | {row['exact']:.{min(digits, 6)}f}"
        part = 100.0 * (row["law"] / row["exact"] - 1.0)
        lines.append(f"| {row['crystal']} | {row['phi']:.2f} | {numbers} | {part:+.2f} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE)
    options = parser.parse_args()
    rows = []
    for kind, phis in PHI.items():
        for phi in phis:
            rows.append({"crystal": kind, "phi": phi, **exact(kind, phi), "law": law(kind, phi)})
            print(markdown(rows[-1:]).splitlines()[-1], flush=True)
    rest, strains = strained("stretch", 0.0), []
    for kind, strain in STRAINS:
        strains.append({"kind": kind, "strain": strain, **strained(kind, strain)})
        print(strained_markdown(rest, strains[-1:]).splitlines()[-1], flush=True)
    found = {"rows": rows, "unstrained": rest, "strained": strains}
    (options.out / "crystals.json").write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()

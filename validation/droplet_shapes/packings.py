"""Whole packings of droplets: the law beside exact shapes, in which films turn and bend.

    python -m validation.droplet_shapes.packings [--out FOLDER] [--cases ...]

Each packing is relaxed with the law. Then finite elements find the shapes of all droplets, and of
their films, in the same box (`lammps_deformable.reference.exact_droplets`).
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import lammps_deformable as ld
import numpy as np
from lammps_deformable.reference.exact_droplets import ExactPacking, exact_packing, osmotic

HERE = Path(__file__).parent

# A packing is at rest when its forces are this part of the mean one.
TOLERANCE = 1e-10

# Forces change at will along a mode without stiffness. So the softest mode has this part of the
# median stiffness at least, but in one packing.
SOFTEST = 1e-3


class Case(NamedTuple):
    """Droplets of two sizes, some number of them, packed and then sheared."""

    ratio: float
    phi: float
    number: int = 12
    strain: float = 0.0
    softest: float = SOFTEST

    def __str__(self) -> str:
        sheared = f" sheared by {self.strain}" if self.strain else ""
        soft = "" if self.softest else ", with a soft mode"
        return f"1 : {self.ratio:g} at {self.phi}{sheared}{soft}"


CASES = [
    *(Case(ratio, phi) for phi in (0.70, 0.74, 0.78) for ratio in (1.0, 1.4, 2.0)),
    Case(1.0, 0.74, softest=0.0),
    Case(1.4, 0.74, strain=0.1),
    *(Case(ratio, 0.85) for ratio in (1.0, 1.4, 2.0)),
]


def softest(state: ld.State) -> float:
    """Stiffness of the softest mode over that of the median one."""
    stiffness = state.modes(vectors=False).stiffness
    return float(stiffness.min() / np.median(stiffness))


def relaxed(case: Case) -> ld.State:
    """The packing, at rest with the law: of the first seed for which all droplets are held, and the
    softest mode has a stiffness."""
    for seed in range(1, 100):
        loose = ld.bidisperse(case.number, sizes=(1.0, case.ratio), dimension=3, seed=seed)
        with ld.Simulation(ld.jam(loose).packing.at(case.phi), ld.Droplet()) as sim:
            state = sim.relax(TOLERANCE)
            if case.strain:
                sheared = sim.box.copy()
                sheared[1, 0] += case.strain * sheared[1, 1]
                sim.deform(sheared)
                state = sim.relax(TOLERANCE)
        held = state.residual < 10.0 * TOLERANCE and not state.rattlers.any()
        if held and softest(state) >= case.softest:
            return state
    raise SystemExit(f"{case}: there is always a droplet that nothing holds, or a soft mode")


def forces_of(state: ld.State, exact: ExactPacking) -> np.ndarray:
    """Forces of the law, of the near pairs of an exact packing."""
    table = state.contacts
    keys = np.column_stack([table["i"], table["j"], table["image"]]).tolist()
    of_pair = dict(zip(map(tuple, keys), table["force"], strict=True))
    pairs = np.column_stack([exact.i, exact.j, exact.image]).tolist()
    return np.array([of_pair.get(tuple(pair), 0.0) for pair in pairs])


def measure(state: ld.State) -> dict[str, Any]:
    """Energy, pressure and forces by the law and exact, with the errors of both."""
    exact = exact_packing(state)
    found, law = exact.found, forces_of(state, exact)
    mean = found.forces[found.forces > 0.0].mean()
    off = np.abs(law - found.forces)[(law > 0.0) | (found.forces > 0.0)] / mean
    levels = [osmotic(state, level) for level in exact.levels]
    before, last = ((4.0 * levels[k] - levels[k - 1]) / 3.0 for k in (-2, -1))
    return {
        "contacts": len(off),
        "load": float(np.mean(state.loads)),
        "softest mode": softest(state),
        "energy": state.energy,
        "exact energy": float(found.energies.sum()),
        "error of the exact energy": found.energy_error,
        "pressure": state.pressure,
        "exact pressure": osmotic(state, found),
        "error of the exact pressure": abs(last - before),
        "largest error of a force over the mean": float(off.max()),
        "rms error of a force over the mean": math.sqrt(float(np.mean(off**2))),
        "error of the exact forces over the mean": found.force_error / float(mean),
        "nodes": found.nodes,
        "seconds": found.seconds,
    }


def markdown(rows: list[dict[str, Any]]) -> str:
    """The table of the page, per cent."""
    lines = [
        "| | load | energy | pressure | rms force | largest error of a force |",
        "|---|---|---|---|---|---|",
    ]
    for row in sorted(rows, key=lambda row: row["load"]):
        cells = [row["case"], f"{row['load']:.3f}"]
        for name in ("energy", "pressure"):
            exact = row[f"exact {name}"]
            error = row[f"error of the exact {name}"] / exact
            cells.append(f"{100.0 * (row[name] / exact - 1.0):+.2f}±{100.0 * error:.2f}")
        rms, largest, error = (
            100.0 * row[f"{name} over the mean"]
            for name in (
                "rms error of a force",
                "largest error of a force",
                "error of the exact forces",
            )
        )
        cells += [f"{rms:.2f}", f"{largest:.2f}±{error:.2f}"]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    names = [str(case) for case in CASES]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE)
    parser.add_argument("--cases", nargs="+", choices=names, default=names)
    options = parser.parse_args()
    file = options.out / "packings.json"
    rows = json.loads(file.read_text())["rows"] if file.exists() else []
    for case in CASES:
        if str(case) not in options.cases or str(case) in [row["case"] for row in rows]:
            continue
        try:
            found = measure(relaxed(case))
        except ArithmeticError as error:
            print(f"{case}: {error}", flush=True)
            continue
        rows.append({"case": str(case), "number": case.number, **found})
        print(markdown(rows[-1:]).splitlines()[-1], f"{rows[-1]['seconds']:.0f} s", flush=True)
        file.write_text(json.dumps({"rows": rows}, indent=1) + "\n")
    print(markdown(rows))


if __name__ == "__main__":
    main()

"""Surface Evolver judges foam in the plane and droplets in space.

    python -m validation.surface_evolver [--out FOLDER] [--cases ...]

Each packing is relaxed with the law, then Surface Evolver finds the exact shapes for the same
contacts, on two meshes, the second one with edges half as long. Their difference is about the error
of the second one. Surface Evolver 2.70 is `evolver-nox` of Debian.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np

HERE = Path(__file__).parent
PROGRAMS = "evolver-nox-d", "evolver"
PACKINGS = HERE.parents[1] / "tests" / "data" / "droplet_packings.json"
FOAM = ld.Ring(contact="curved", kA=math.inf, kP=0.0, tension=1.0)
STICKY = ld.Ring(contact="curved", kA=math.inf, kP=0.0, tension=1.0, adhesion=0.2)


def program() -> str | None:
    """Surface Evolver, if it is there."""
    return next((found for name in PROGRAMS if (found := shutil.which(name))), None)


def evolved(state: ld.State, folder: Path, finer: bool = True) -> list[ld.Evolved]:
    """What Surface Evolver finds on one mesh, and on a finer one."""
    file, commands, found = folder / "packing.fe", "", []
    state.export(file, mode="w")
    names = ["relax", "finer"][: 1 + finer]
    for name in names:
        commands += f'{name}; results >>> "{folder / name}";\n'
    evolver = program()
    if evolver is None:
        raise SystemExit("Surface Evolver is missing: apt install evolver-nox")
    ended = subprocess.run(
        [evolver, file], input=f"{commands}q\nq\n", text=True, capture_output=True
    )
    if error := re.search(r"^ERROR .*", ended.stdout + ended.stderr, re.MULTILINE):
        raise SystemExit(f"Surface Evolver: {error[0]}")
    for name in names:
        found.append(ld.Evolved.from_file(folder / name))
    return found


def foam(phi: float) -> Callable[[], ld.State]:
    """Droplets of two sizes in the plane."""

    def relaxed() -> ld.State:
        jammed = ld.jam(ld.bidisperse(16, seed=2)).packing
        with ld.Simulation(jammed.at(0.88), FOAM) as sim:
            return sim.compress(phi=phi, steps=5, tolerance=1e-10, keep=False)[-1]

    return relaxed


def doublet() -> ld.State:
    """Two droplets that stick, in a wide box."""
    packing = ld.Packing([(1.0, 2.0), (2.05, 2.1)], [0.5, 0.7], (4.0, 4.0))
    with ld.Simulation(packing, STICKY) as sim:
        return sim.relax(1e-10)


def plates(law: ld.Ring | ld.Droplet) -> Callable[[], ld.State]:
    """A droplet of radius 1 that two walls indent by a tenth, side by side with its images."""

    def relaxed() -> ld.State:
        lengths = (4.0, 1.8) if isinstance(law, ld.Ring) else (4.0, 4.0, 1.8)
        middle = [0.5 * length for length in lengths]
        up = np.eye(len(lengths))[-1]
        walls = [ld.Plane((0,) * len(lengths), up), ld.Plane(1.8 * up, -up)]
        packing = ld.Packing([middle], [1.0], lengths).between(walls)
        with ld.Simulation(packing, law) as sim:
            return sim.relax(1e-10)

    return relaxed


def crystal(kind: str, cells: int, phi: float) -> Callable[[], ld.State]:
    def relaxed() -> ld.State:
        with ld.Simulation(ld.crystal(kind, cells, phi=phi), ld.Droplet()) as sim:
            return sim.relax(1e-10)

    return relaxed


def disordered(name: str) -> Callable[[], ld.State]:
    """A stored packing of droplets, of which exact shapes are known too."""

    def relaxed() -> ld.State:
        stored = json.loads(PACKINGS.read_text())["packings"]
        packing = next(each for each in stored if each["name"] == name)
        box = np.eye(3) * packing["box"]
        start = ld.Packing(packing["law"]["x"], packing["radius"], box)
        with ld.Simulation(start, ld.Droplet()) as sim:
            return sim.relax(1e-10)

    return relaxed


# names of stored packings: number of droplets, ratio of sizes, seed, phi
STORED = "8_1.4_1_0.78", "10_1_5_0.7", "12_1.4_4_0.74", "16_1_2_0.7", "16_1_2_0.78"


def told(name: str) -> str:
    """What the page calls a stored packing."""
    number, ratio, _, phi = name.split("_")
    return f"{number} droplets, 1 : {ratio} at {phi}"


CASES: dict[str, Callable[[], ld.State]] = {
    "plates in the plane": plates(FOAM),
    "two that stick": doublet,
    **{f"foam {phi}": foam(phi) for phi in (0.88, 0.92, 0.95, 0.98)},
    "plates": plates(ld.Droplet()),
    "sc 0.6": crystal("sc", 2, 0.6),
    "bcc 0.76": crystal("bcc", 1, 0.76),
    "fcc 0.79": crystal("fcc", 1, 0.79),
    "fcc 0.83": crystal("fcc", 1, 0.83),
    **{told(name): disordered(name) for name in STORED},
}


def free_energy(state: ld.State) -> float:
    """Of all outlines, when the particles are free."""
    radii = state.packing.radii
    plane = state.packing.dimension == 2
    return float(np.sum(2.0 * math.pi * radii if plane else 4.0 * math.pi * radii**2))


def measure(name: str, folder: Path) -> dict[str, Any]:
    """Energy, pressures of the packing and in the particles by the law and by Surface Evolver."""
    state = CASES[name]()
    found = evolved(state, folder)
    inside = [float(np.abs(each.pressures / state.pressures - 1.0).max()) for each in found]
    return {
        "case": name,
        "particles": len(state.packing),
        "phi": state.phi,
        "energy": state.energy,
        "energy of Surface Evolver": [each.energy - free_energy(state) for each in found],
        "pressure": state.pressure,
        "pressure of Surface Evolver": [each.pressure(state.packing.box) for each in found],
        "largest difference of a pressure inside": inside,
    }


def markdown(rows: list[dict[str, Any]]) -> str:
    """The table of the page."""
    lines = ["| | energy | two meshes | off | pressure | two meshes | off |", "|---" * 7 + "|"]
    for row in rows:
        cells = [row["case"]]
        for name in ("energy", "pressure"):
            law, (coarse, fine) = row[name], row[f"{name} of Surface Evolver"]
            if abs(fine) < 1e-6:  # no pressure
                cells += ["0", "0", ""]
                continue
            off = f"{100.0 * (law / fine - 1.0):+.2f} %"
            cells += [f"{law:.5f}", f"{coarse:.5f}, {fine:.5f}", off]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE)
    parser.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    options = parser.parse_args()
    file = options.out / "surface_evolver.json"
    known = json.loads(file.read_text())["rows"] if file.exists() else []
    rows = {row["case"]: row for row in known}
    for name in options.cases:
        with tempfile.TemporaryDirectory() as folder:
            rows[name] = measure(name, Path(folder))
        print(markdown([rows[name]]).splitlines()[-1], flush=True)
        ordered = [rows[case] for case in CASES if case in rows]
        file.write_text(json.dumps({"rows": ordered}, indent=1) + "\n")
    print(markdown([rows[case] for case in CASES if case in rows]))


if __name__ == "__main__":
    main()

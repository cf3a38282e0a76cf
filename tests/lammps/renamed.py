"""Droplets that stick, rub and hang on walls, and commands that give new names between runs.

Names are IDs of particles and numbers of walls. What contacts remember must not change: energy,
springs, what was lost, attached pairs.
"""

import numpy as np

SPECIES = """# UNITS: lj
drop 1.0 inf 0 tension 1
adhesion drop drop 0.15
"""
# a heap on a floor, particles far from all others, and two between them that meet in flight
FLOOR, SECOND, THIRD = (2, 3.97, 5.93, 7.9), (3, 4.95, 6.9), (3.97, 5.95)
HEAP = np.array([(x, y) for y, row in ((0.98, FLOOR), (2.69, SECOND), (4.4, THIRD)) for x in row])
ALONE = np.array([(3, 9.5), (11, 7), (5, 12.5), (7.02, 12.5), (11, 12)])
WALLS = {
    "floor": "plane 0 0 0 1 adhesion 0.1",
    "side": "plane 1.02 0 1 0 adhesion 0.1",
    "lid": "plane 0 19 0 -1",
}
LAW = """
pair_style deformable/ring contact curved balance 1e-11 1000
pair_coeff * * {folder}/species drop
neighbor 0.3 bin
comm_modify cutoff 4.5
"""
MOTION = """
fix move all nve/sphere disc
fix rub all deformable/friction 0.3 0.5 0.1 damp 0.1
timestep 0.02
compute pair all pair deformable/ring
compute contacts all deformable/contact
compute rows all reduce sum c_contacts[15] c_contacts[5] inputs local
compute pull all reduce min c_contacts[5] inputs local
thermo_style custom step pe econserve c_pair[6] f_rub[*] c_rows[*] c_pull
thermo_modify norm no
"""
START = """units lj
dimension 2
boundary p m p
atom_style sphere
atom_modify map yes
processors {grid}
region box block 0 13 -0.5 19.5 -0.5 0.5
create_box 1 box
{particles}
set group all diameter 2.0
set group all mass 1.0
"""
# of one contact each: a droplet is pulled from its neighbors, another one from the floor
STRETCH = """
run 60 post no
{pulls}
reset_timestep 0
run 0 post no
"""
INVARIANTS = "pe", "econserve", "c_pair[6]", *(f"f_rub[{k}]" for k in range(1, 7)), "c_pull"


def walls(order):
    return "\n".join(f"fix {name} all deformable/wall {WALLS[name]}" for name in order)


def start(folder, grid="* * *", law=LAW, motion=MOTION):
    """Commands up to springs that are stretched, and films beyond the distance of touch."""
    (folder / "species").write_text(SPECIES)
    x = np.concatenate([ALONE[:2], HEAP, ALONE[2:]])
    particles = "\n".join(f"create_atoms 1 single {a} {b} 0" for a, b in x)
    pulls = "displace_atoms pulled move 0.05 0.12 0\ndisplace_atoms left move 0 0.07 0"
    return (
        START.format(grid=grid, particles=particles)
        + law.format(folder=folder)
        + walls(WALLS)
        + motion
        + "group pulled id 11\ngroup left id 3\ngroup heap id 3:11\n"
        + "velocity heap create 0.002 4711 loop all\n"
        + "velocity all set NULL NULL 0\nset atom 13 vx -0.05\nset group all omega 0 0 0.02\n"
        + STRETCH.format(pulls=pulls)
    )


def again(folder, order=("side", "lid", "floor")):
    """A restart file, and a new LAMMPS that goes on from it, with the walls in another order."""
    return (
        f"write_restart {folder}/restart\nclear\nread_restart {folder}/restart\n"
        + LAW.format(folder=folder)
        + walls(order)
        + MOTION
    )


def free(place):
    """A particle where nothing else is, by its region."""
    a, b = place
    return f"region spot block {a - 0.5} {a + 0.5} {b - 0.5} {b + 0.5} INF INF\n"


def renaming(folder):
    """Commands that change names, or move all particles, but no contact; by what they do."""
    delete = (
        "group gone region spot\ndelete_atoms group gone{}\ngroup gone delete\nregion spot delete"
    )
    return {
        "nothing is deleted": free((3, 16)) + delete.format(""),
        "the first one is deleted": free(ALONE[0]) + delete.format(""),
        "the last one is deleted": free(ALONE[4]) + delete.format(" compress no"),
        "gaps are closed": "reset_atoms id",
        "sorted in space": "reset_atoms id sort yes",
        "another one": "create_atoms 1 single 3 16 0\nset group all mass 1.0\n"
        "set group all diameter 2.0",
        "that one is deleted": free((3, 16)) + delete.format(""),
        "a wall more": "fix post all deformable/wall disk 11.5 15.5 0.5 adhesion 0.1",
        "that wall is gone": "unfix post",
        "a wall far away is gone": "unfix lid",
        "and is there again": walls(["lid"]),
        "the order of walls": "unfix floor\n" + walls(["floor"]),
        "another file": again(folder),
        "balance": "balance 1.0 shift x 5 1.0",
        "sorted in memory": "atom_modify sort 1 1.0\nrun 0 post no",
        "a minimization without steps": "minimize 0 0 0 0",
    }

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
        "a wall in other words": "unfix floor\nfix floor all deformable/wall ylo 0 adhesion 0.1",
        "another file": again(folder),
        "moved by a period": "displace_atoms all move 13 0 0",
        "a tilted box and back": "change_box all triclinic\nrun 0 post no\nchange_box all ortho",
        "balance": "balance 1.0 shift x 5 1.0",
        "sorted in memory": "atom_modify sort 1 1.0\nrun 0 post no",
        "a minimization without steps": "minimize 0 0 0 0",
    }


# in a run: particles far from the heap vanish, others appear
COME_AND_GO = """
region void block 9 13 6 17 INF INF
region rain block 2 11 17 17.5 0 0
group lone region void
fix gone lone evaporate 10 1 void 4711
fix come all deposit 3 1 10 4711 region rain near 2.1 id {ids}
"""


# the same for droplets in space, which remember forces only
IN_SPACE = """units lj
dimension 3
boundary p p m
atom_modify map yes
processors {grid}
region box block 0 9 0 7 -0.5 11.5
create_box 1 box
{particles}
mass * 1.0
"""
LAW_IN_SPACE = """
pair_style deformable/droplet balance 1e-11 1000
pair_coeff * * {folder}/species drop
neighbor 0.3 bin
"""
FLOOR_IN_SPACE = "fix floor all deformable/wall plane 0 0 0 0 0 1\n"
LID_IN_SPACE = "fix lid all deformable/wall plane 0 0 11 0 0 -1\n"
MOTION_IN_SPACE = """
fix move all nve
timestep 0.02
thermo_style custom step pe econserve f_floor[3]
thermo_modify norm no
"""
INVARIANTS_IN_SPACE = "pe", "econserve", "f_floor[3]"
ALONE_IN_SPACE = np.array([(2.0, 2.0, 7.0), (6.0, 5.0, 7.0), (2.0, 5.0, 9.5)])
PILE = np.array(
    [(x, y, 0.98) for x in (1.0, 2.97, 4.94) for y in (1.0, 2.96)]
    + [(x, 1.98, 2.35) for x in (1.98, 3.95)]
)


def start_in_space(folder, grid="* * *"):
    """Droplets that move on a floor, without those alone."""
    (folder / "species").write_text("drop 1.0 inf 0 tension 1\n")
    x = np.concatenate([ALONE_IN_SPACE[:2], PILE, ALONE_IN_SPACE[2:]])
    particles = "\n".join(f"create_atoms 1 single {a} {b} {c}" for a, b, c in x)
    return (
        IN_SPACE.format(grid=grid, particles=particles)
        + LAW_IN_SPACE.format(folder=folder)
        + FLOOR_IN_SPACE
        + LID_IN_SPACE
        + MOTION_IN_SPACE
        + "group pile id 3:10\nvelocity pile create 0.002 4711 loop all\nrun 40 post no\n"
    )


def again_in_space(folder):
    return (
        f"write_restart {folder}/restart\nclear\nread_restart {folder}/restart\n"
        + LAW_IN_SPACE.format(folder=folder)
        + LID_IN_SPACE
        + FLOOR_IN_SPACE
        + MOTION_IN_SPACE
    )


def renaming_in_space(folder):
    """The commands of `renaming`."""

    def delete(x, y, z, words=""):
        low_high = " ".join(f"{a - 0.5} {a + 0.5}" for a in (x, y, z))
        return (
            f"region spot block {low_high}\ngroup gone region spot\n"
            f"delete_atoms group gone{words}\ngroup gone delete\nregion spot delete"
        )

    return {
        "nothing is deleted": delete(6, 2, 9.5),
        "the first one is deleted": delete(*ALONE_IN_SPACE[0]),
        "the last one is deleted": delete(*ALONE_IN_SPACE[2], " compress no"),
        "gaps are closed": "reset_atoms id",
        "sorted in space": "reset_atoms id sort yes",
        "another one": "create_atoms 1 single 6 2 9.5",
        "that one is deleted": delete(6, 2, 9.5),
        "a wall more": "fix post all deformable/wall ball 6 2 9.5 0.5",
        "that wall is gone": "unfix post",
        "a wall far away is gone": "unfix lid",
        "and is there again": LID_IN_SPACE,
        "the order of walls": "unfix floor\n" + FLOOR_IN_SPACE,
        "another file": again_in_space(folder),
        "moved by a period": "displace_atoms all move 9 7 0",
        "a tilted box and back": "change_box all triclinic\nrun 0 post no\nchange_box all ortho",
        "balance": "balance 1.0 shift x 5 1.0",
        "sorted in memory": "atom_modify sort 1 1.0\nrun 0 post no",
        "a minimization without steps": "minimize 0 0 0 0",
    }

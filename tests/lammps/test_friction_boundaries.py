"""Contacts across the boundary of a box that changes: those within it have the same."""

import numpy as np
import pytest
from parallel import on_grids

DROP = "# UNITS: lj\ndrop 0.5 inf 0 tension 1\n"
GAP, COUNT = 0.95, 5  # between centers of a column along y, also across the boundary
HEIGHT = GAP * COUNT
DAMP = 0.2
HEAD = """units lj
dimension 2
atom_style sphere
processors {grid}
{balance}
"""
GRAINS = """set group all diameter 1.0
set group all mass 1.0
pair_style deformable/ring
pair_coeff * * ../species drop
fix move all nve/sphere disc
"""

# a column that flows with the rate e; {tilt} of the box or of its motion
COLUMN = (
    HEAD
    + f"region box prism 0 4 0 {HEIGHT} -0.5 0.5 {{tilt}} 0 0\ncreate_box 1 box\n"
    + "".join(f"create_atoms 1 single 2 {GAP * (k + 0.5)} 0\n" for k in range(COUNT))
    + GRAINS
    + f"variable vy atom v_e*(y-{HEIGHT / 2})\n"
    + f"fix rub all deformable/friction 0 0 0 damp {DAMP}\ntimestep 0.001\n"
    + "variable e equal {rate}\nvelocity all set NULL v_vy NULL\n"
)
# Pressures of the column are small beside the one that is asked for, so that the rate is about
# gain (p - target).
WALKS = {
    "erate": (0.01, "fix box all deform 1 y erate {rate} remap v"),
    "every second step": (0.01, "fix box all deform 2 y erate {rate} remap v"),
    "volume": (-0.01, "fix box all deform 1 x erate 0.01 y volume remap v"),
    "pressure and shear": (
        0.0104247,
        "fix box all deform/pressure 1 xy erate 0.01 y pressure -1 0.01 remap v",
    ),
}
ROWS = "dump rows all local 1 rows f_rub[1] f_rub[2] f_rub[8]\ndump_modify rows sort 1\n"
GRIDS = "1 1 1", "1 2 1"


def rows(folder):
    """The forces f_d of all contacts, for each step."""
    text = (folder / "rows").read_text().split("ITEM: TIMESTEP")[1:]
    return [
        {
            tuple(sorted(map(int, line.split()[:2]))): float(line.split()[2])
            for line in part.split("f_rub[8]\n")[1].splitlines()
        }
        for part in text
    ]


@pytest.mark.parametrize("walk", WALKS.values(), ids=WALKS)
def test_damping_across_a_boundary(walk, tmp_path):
    """It is gn e d at each contact of a flow v = e y, e the rate of the box."""
    rate, motion = walk
    (tmp_path / "species").write_text(DROP)
    script = COLUMN + motion + "\n" + ROWS + "run 4\n"
    for folder in on_grids(script, tmp_path, GRIDS, tilt=0, rate=rate).values():
        for found in rows(folder)[3:]:  # from the first change of the box on
            assert len(found) == COUNT
            np.testing.assert_allclose(list(found.values()), DAMP * rate * GAP, rtol=4e-3)


def test_a_second_run(tmp_path):
    """It knows how the box has changed after the last step of the first one."""
    rate, motion = WALKS["pressure and shear"]
    (tmp_path / "species").write_text(DROP)
    script = COLUMN + motion + "\nrun 4\n" + ROWS + "run 2\n"
    for folder in on_grids(script, tmp_path, GRIDS, tilt=0, rate=rate).values():
        for found in rows(folder):
            np.testing.assert_allclose(list(found.values()), DAMP * rate * GAP, rtol=4e-3)


def test_grains_that_cross(tmp_path):
    """A grain that leaves through the top comes back with its flow: v - dL/dt."""
    (tmp_path / "species").write_text(DROP)
    script = (
        HEAD
        + "region box block 0 4 0 8 -0.5 0.5\ncreate_box 1 box\n"
        + "create_atoms 1 single 2 7.9 0\ncreate_atoms 1 single 2 3.5 0\n"
        + GRAINS
        + "velocity all set 0 0.2 0\nfix rub all deformable/friction 0 0 0 damp 0.2\n"
        + "fix box all deform/pressure 1 y pressure -1 0.02 remap v\n"
        + "variable rate equal vy[2]-vy[1]\nvariable ly equal ly\n"
        + "timestep 0.01\nrun 200\nprint '$(v_rate:%.17g) $(vy[1]:%.17g)' file velocity\n"
    )
    for folder in on_grids(script, tmp_path, GRIDS).values():
        change, velocity = np.loadtxt(folder / "velocity")
        assert velocity < 0.2
        assert change == pytest.approx(0.02 * 8, rel=0.03)  # of the box of that time


# Two grains separate in a shear flow, with the same velocities relative to it, in the middle of
# the box or across its boundary.
PART = (
    HEAD
    + """region box prism 0 8 0 8 -0.5 0.5 0 0 0
create_box 1 box
create_atoms 1 single 4 {low} 0
create_atoms 1 single 4.05 {high} 0
"""
    + GRAINS
    + """set atom 1 vx {below} vy -0.01
set atom 2 vx 0.0235 vy 0.01
fix rub all deformable/friction 0.5 1.0 0.1 damp 0.1
fix shear all deform 1 xy erate 0.05 remap v
timestep {dt}
thermo_modify norm no
run {steps}
print "$(f_rub[2]:%.17g) $(f_rub[3]:%.17g) $(f_rub[4]:%.17g) $(f_rub[5])" file lost
"""
)


def lost(folder, y, dt, grids):
    (folder / "species").write_text(DROP)
    low = (y - 0.47) % 8
    fields = {"low": low, "high": y + 0.47, "below": 0.05 * (low - y), "dt": dt}
    folders = on_grids(PART, folder, grids, steps=round(6 / dt), **fields)
    return [np.loadtxt(each / "lost") for each in folders.values()]


def test_a_contact_that_ends_across_a_boundary(tmp_path):
    """It loses as much as in the middle of the box, up to the time step; on any ranks the same."""
    differences = []
    for dt in (0.01, 0.0025):
        found = []
        for y in (4, 0):
            folder = tmp_path / f"{y} {dt}"
            folder.mkdir()
            on_ranks = lost(folder, y, dt, GRIDS if dt == 0.01 else GRIDS[:1])
            for each in on_ranks:
                np.testing.assert_allclose(each, on_ranks[0], rtol=1e-8)
            assert on_ranks[0][3] == 0  # it has ended
            found.append(on_ranks[0][:3].sum())
        differences.append(abs(found[1] / found[0] - 1))
    assert differences[0] < 0.01
    assert differences[1] < 0.3 * differences[0]

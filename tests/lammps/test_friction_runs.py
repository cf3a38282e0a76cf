"""What contacts remember goes along: to other ranks, through borders, into restart files."""

import numpy as np
import pytest
from grains import Grains
from laws import EXACT, ring_laws
from parallel import (
    TILED,
    TWO,
    assert_atoms_change_ranks,
    assert_same,
    finished,
    in_process,
    on_grids,
    report,
    reported,
)

# a dense fluid of disks, sheared by their velocities; neighbor lists are new in each step
FLUID = """units lj
dimension 2
boundary p p p
atom_style sphere
processors {grid}
region box block 0 8 0 8 -0.5 0.5
create_box 1 box
{particles}
set group all diameter 2.0
set group all mass 1.0
pair_style {law}
pair_coeff * * ../species drop
neighbor {skin} bin
neigh_modify {lists}
comm_modify cutoff 4.0
{balance}
velocity all create 0.02 4711 loop all
velocity all ramp vx -0.3 0.3 y 0 8
velocity all set NULL NULL 0.0
fix move all nve/sphere disc
fix rub all deformable/friction 0.4 0.5 0.1 damp 0.1
fix flat all enforce2d
timestep 0.02
compute stress all stress/atom NULL fix
thermo_style custom step pe ke econserve f_rub[1] f_rub[2] f_rub[3] f_rub[4] f_rub[5] f_rub[6]
thermo_modify norm no
"""
COLUMNS = "x y vx vy omegaz fx fy tqz c_stress[1] c_stress[2] c_stress[4]"
SCALARS = "pe ke econserve " + " ".join(f"f_rub[{k}]" for k in range(1, 7))
STEPS = 60, 120
EACH_STEP = "every 1 delay 0 check no"


def fluid(folder, law, grids, steps, skin=0.3, lists=EACH_STEP):
    rng = np.random.default_rng(5)
    x = np.array([[1.75 + 2 * i, 1.0 + 2 * j] for i in range(4) for j in range(4)])
    x += rng.uniform(-0.1, 0.1, x.shape)
    (folder / "species").write_text("# UNITS: lj\ndrop 1.0 inf 0 tension 1\n")
    particles = "\n".join(f"create_atoms 1 single {a} {b} 0" for a, b in x)
    script = FLUID + "".join(report(n, SCALARS, COLUMNS) for n in steps)
    fields = {"particles": particles, "skin": skin, "lists": lists, "law": EXACT[law]}
    return on_grids(script, folder, grids, **fields)


@ring_laws
def test_ranks(law, tmp_path):
    """Positions, spins, stresses and what is stored and lost are those of one rank."""
    grids = ("1 1 1", TILED) if law == "balanced" else TWO
    folders = fluid(tmp_path, law, grids, STEPS)
    first, second = (reported(folders, n) for n in STEPS)
    for found in (first, second):
        assert_same(found, 1e-9, atol=1e-9)
    assert_atoms_change_ranks(first, second)
    stored, sliding = first["1 1 1"][0][3:5]
    assert stored > 1e-4
    assert second["1 1 1"][0][4] > sliding > 1e-3


def test_four_ranks(tmp_path):
    assert_same(reported(fluid(tmp_path, "balanced", ("1 1 1", "2 2 1"), (20,)), 20), 1e-10)


def test_neighbor_lists(tmp_path):
    """The same where neighbor lists, and the order of particles, are new in each step or seldom."""
    found = {}
    for grid, skin in (("1 1 1", 0.3), ("seldom", 0.9)):
        (tmp_path / grid).mkdir()
        every = "every 10 delay 0 check yes" if skin > 0.5 else EACH_STEP
        folders = fluid(tmp_path / grid, "curved", ("1 1 1",), (240,), skin, every)
        found[grid] = reported(folders, 240)["1 1 1"]
    assert_same(found, 1e-7, atol=1e-7)


END = """
write_dump all custom atoms id proc {columns} modify sort id format float %.17g
print "{scalars}" file terms
"""


@ring_laws
def test_restart(law, tmp_path):
    """A run in two parts, the second one from a file, is one run, to rounding."""
    fluid(tmp_path, law, ("1 1 1",), (0,))
    folder = tmp_path / "111"
    start = (folder / "in.script").read_text().rsplit("run 0", 1)[0].replace("processors", "# ")
    scalars = " ".join(f"$({name}:%.17g)" for name in SCALARS.split())
    end = END.format(columns=COLUMNS, scalars=scalars)
    in_process(start + "run 40\nrun 40\n" + end, folder)
    expected = np.loadtxt(folder / "atoms", skiprows=9), np.loadtxt(folder / "terms")
    assert expected[1][4] > 1e-4
    head, tail = start.split("atom_style")[0], "pair_style" + start.split("pair_style", 1)[1]
    tail = "\n".join(line for line in tail.splitlines() if not line.startswith("velocity"))
    for write, read in ((1, 1), (2, 1), (1, 2)) if law == "balanced" else ((1, 1),):
        finished(write, start + "run 40\nwrite_restart half\n", folder)
        finished(read, f"{head}\nread_restart half\n{tail}\nrun 40\n{end}", folder)
        found = np.loadtxt(folder / "atoms", skiprows=9), np.loadtxt(folder / "terms")
        scale = np.abs(expected[0][:, 2:]).max(axis=0)
        assert (np.abs(found[0] - expected[0])[:, 2:] <= 1e-10 * scale).all()
        np.testing.assert_allclose(found[1], expected[1], rtol=1e-10, atol=1e-11)


PAIR = np.array([[-0.98, 0.0], [0.98, 0.0]])


def rubbed(folder, x, steps=400, commands=""):
    """Two droplets that are pressed, turn about each other and do not slide."""
    press = "group a id 1\ngroup b id 2\nfix press a spring couple b 0.5 0 0 0 1.8\n"
    scene = Grains(
        x, 1, "inf 0.2 0", folder, [[-0.01, -0.05], [-0.01, 0.05]], [0.03, -0.01], dt=0.02,
        commands=press + commands, box=(-3, 3, -3, 3),
    )  # fmt: skip
    scene.run(f"run {steps} post no")
    assert scene.terms["contacts"] == 1
    return scene


def test_history_through_a_border(tmp_path):
    """A contact that crosses a periodic border, or turns, is the same contact."""
    inside = rubbed(tmp_path, PAIR)
    across = rubbed(tmp_path, [[2.02, 0], [-2.02, 0]], commands="set atom 2 image 1 NULL NULL")
    assert inside.terms["stored"] > 1e-6
    for name in ("stored", "sliding", "dashpots"):
        assert across.terms[name] == pytest.approx(inside.terms[name], rel=1e-9, abs=1e-18)
    np.testing.assert_allclose(across.spin, inside.spin, rtol=1e-10)


def test_a_spring_is_the_way_of_the_contact(tmp_path):
    """Without sliding, xi is the integral of the relative velocity: as two gears turn."""
    scene = rubbed(tmp_path, PAIR, steps=0)
    xi = 0.0
    for _ in range(50):
        scene.run("run 1 pre no post no")
        v, spin, x = scene.v, scene.spin, scene.x
        n = (x[1] - x[0]) / np.linalg.norm(x[1] - x[0])
        middle = 0.5 * np.linalg.norm(x[1] - x[0])
        xi += 0.02 * ((v[1] - v[0]) @ [-n[1], n[0]] - middle * spin.sum())
    assert scene.rows[0, 8] == pytest.approx(xi, rel=0.01)  # of velocities of whole steps
    assert scene.terms["stored"] == pytest.approx(0.1 * scene.rows[0, 8] ** 2, rel=1e-12)


def test_a_contact_that_ends_forgets(tmp_path):
    """What its spring has stored is lost, and a new contact begins without."""
    scene = rubbed(tmp_path, PAIR)
    stored = scene.terms["stored"]
    apart = 5 * np.array([[-1], [1]]) * (scene.x[1] - scene.x[0])
    scene.v, scene.spin = apart, 0
    scene.run("run 4 post no")
    terms = scene.terms
    assert terms["stored"] == terms["contacts"] == 0
    assert terms["dashpots"] + terms["sliding"] == pytest.approx(stored, rel=0.1)
    scene.v = -apart
    scene.run("run 4 post no")
    assert scene.terms["contacts"] == 1
    assert abs(scene.rows[0, 8]) < 1e-3


def test_a_minimization_between_runs(tmp_path):
    """Minimizers pass over friction: springs stay as they are, nothing is counted."""
    scene = rubbed(tmp_path, PAIR)
    before, xi = scene.terms, scene.rows[0, 8]
    scene.run("minimize 0 0 2 10\nrun 0 post no")
    assert scene.terms == pytest.approx(before)
    assert scene.rows[0, 8] == xi


def test_walls_that_come_and_go(tmp_path):
    """Springs stay with their walls when others are defined or removed between runs."""
    walls = (
        "fix lid all deformable/wall plane 0 5 0 -1\n"
        "region room block -0.98 5.5 -0.98 5.5 INF INF\nfix room all deformable/wall room"
    )
    scene = Grains([[0, 0]], 1, "inf 0.2 0", tmp_path, [[-0.03, -0.05]], 0.02, commands=walls)
    scene.run("run 20 post no")
    before = scene.rows[np.argsort(scene.rows[:, 4])]
    assert len(before) == 2
    assert (np.abs(before[:, 8]) > 1e-3).all()
    for commands in (
        "fix post all deformable/wall disk 4 0 0.5",
        "unfix lid",
        "unfix post\nfix post all deformable/wall disk 4 0 0.5",
        "fix lid all deformable/wall plane 0 5 0 -1",
    ):
        scene.run(f"{commands}\nrun 0 post no")
        rows = scene.rows[np.argsort(scene.rows[:, 4])]
        np.testing.assert_allclose(rows[:, :10], before[:, :10], rtol=0, atol=1e-10)
    scene.run("unfix room\nrun 0 post no")
    assert len(scene.rows) == 0


def test_images_of_one_partner(tmp_path):
    """Two particles that touch each other twice, or one that touches itself."""
    box = (-1.96, 1.96, -4, 4)
    scene = Grains(
        PAIR, 1, "inf 0.2 0", tmp_path, [[0, -0.05], [0, 0.05]], 0.02, dt=0.02, box=box
    )  # fmt: skip
    scene.run("run 0 post no")
    before = scene.balance()
    scene.run("run 50 post no")
    xi = scene.rows[np.argsort(scene.rows[:, 2]), 8]
    # across the border the other one is on the left: v.t has the other sign, spins add to both
    slide, roll = 0.5 * (xi[0] - xi[1]), 0.5 * (xi[0] + xi[1])
    assert len(xi) == 2
    assert abs(slide) > 0.05
    assert abs(roll) > 0.01
    assert scene.balance() == pytest.approx(before, rel=1e-4)

    alone = Grains(
        [[0.0, 0]], 1, "inf 0.2 0.1", tmp_path, 0.0, 0.05, dt=0.02, box=(-0.99, 0.99, -4, 4)
    )  # fmt: skip
    alone.run("run 0 post no")
    before = alone.balance()
    alone.run("run 500 post no")
    assert alone.terms["contacts"] == 1
    assert abs(alone.spin[0]) < 0.05
    assert alone.balance() == pytest.approx(before, rel=1e-4)


def test_losses_that_are_given_are_those_of_all_ranks(tmp_path):
    fluid(tmp_path, "balanced", ("1 1 1",), (0,))
    folder = tmp_path / "111"
    start = (folder / "in.script").read_text().rsplit("run 0", 1)[0].replace("processors", "# ")
    end = 'fix_modify rub lost 3 4 5\nrun 0\nprint "lost: $(f_rub[2]) $(f_rub[3]) $(f_rub[4])"\n'
    assert "\nlost: 3 4 5\n" in finished(2, start + end, folder)

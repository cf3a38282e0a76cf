"""Sides of the box as walls: at numbers, at EDGE, and at variables, also of what a run finds."""

import numpy as np
import pytest
from droplet_walls import CUBE, walled
from grains import Grains
from laws import EXACT, LAWS, two_laws
from obstacles import kinetic
from parallel import finished, in_process, on_grids
from scene import FOUR, ROOM_OF_FOUR, Scene
from turns import in_turn

BOX = (-3, 3, -3, 3)
SIDES = "xlo -0.965 xhi 0.97 ylo -0.96 yhi 0.967"
MOVE = "velocity all create 0.001 125\nfix move all nve\nfix flat all enforce2d\ntimestep 0.02\n"


def plane(walls, law="balanced", x=FOUR, boundary="f f p", **options):
    """Particles in the plane, with the fix `walls`: its words, or commands that define it."""
    if "\n" not in walls:
        walls = f"fix walls all deformable/wall {walls}\n"
    kinds = ["small"] * len(x)
    return Scene(
        x, kinds, BOX, EXACT.get(law, LAWS[law]), boundary=boundary, commands=walls, **options
    )


def force(scene):
    return [scene.lmp.extract_fix("walls", 0, 1, k) for k in range(3)]


def given(scene):
    return scene.lmp.extract_fix("walls", 0, 0)


@two_laws
def test_sides_of_the_plane(law):
    """They are those of a block, alone in a periodic box too."""
    sides, block = plane(SIDES, law).evaluate(), plane(ROOM_OF_FOUR, law).evaluate()
    assert sides.energy == pytest.approx(block.energy, rel=1e-12)
    assert sides.energy > 1e-5
    np.testing.assert_allclose(sides.force, block.force, atol=1e-12)
    x = FOUR + np.array([2.4, 0.0])  # two of them across the boundary, in x
    across, within = (plane("ylo -0.96 yhi 0.967", law, y, "p f p").evaluate() for y in (x, FOUR))
    assert across.energy == pytest.approx(within.energy, rel=1e-10)


def test_edges_of_the_plane():
    """They follow the box."""
    scene = plane("xlo EDGE xhi EDGE ylo EDGE yhi EDGE")
    scene.run("change_box all x final -0.965 0.97 y final -0.96 0.967")
    assert scene.energy() == pytest.approx(plane(ROOM_OF_FOUR).energy(), rel=1e-12)


@two_laws
def test_a_side_at_a_variable_of_the_time(law):
    """It moves as a region does that has the variable, and takes the same energy."""
    lid = "variable up equal -0.05*sin(0.05*step*dt)\nvariable top equal 0.967+v_up\n"
    regions = (
        "region room block -0.965 0.97 -0.96 INF -1 1\n"
        "region lid plane 0 0.967 0 0 -1 0 move NULL v_up NULL\n"
        "region all intersect 2 room lid\nfix walls all deformable/wall all\n"
    )
    found = []
    for walls in (f"fix walls all deformable/wall {SIDES.replace('0.967', 'v_top')}\n", regions):
        scene = plane(lid + walls, law)
        scene.run(MOVE + "run 0")
        before = scene.lmp.get_thermo("pe") + kinetic(scene)
        scene.run("run 300")
        after = scene.lmp.get_thermo("pe") + kinetic(scene)
        assert abs(given(scene)) > 0.05 * before
        assert after + given(scene) == pytest.approx(before, abs=1e-3 * before)
        found.append([*scene.x.ravel(), *force(scene), given(scene)])
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9, atol=1e-11)


# What a run finds: words of a variable, of the value of `press` of the column that follows.
SERVO = (
    "compute press all pressure NULL pair\ncompute each all stress/atom NULL pair\n"
    "compute both all reduce sum c_each[2]\nvariable own equal c_press[2]\n"
    "compute heat all temp\n"
)
STATES = {
    "a compute": ("c_press[2]", "c_press[2]"),
    "within another variable": ("v_own", "c_press[2]"),
    "a thermo keyword": ("pe", "pe"),
    "the force on the wall": ("f_walls[2]", "f_walls[2]"),
}


@pytest.mark.parametrize(("word", "column"), STATES.values(), ids=STATES)
def test_a_side_at_what_a_run_finds(word, column):
    """In each step it is where the value of the step before has it, though thermo is silent."""
    walls = f"fix walls all deformable/wall {SIDES.replace('0.967', 'v_top')}\n"
    scene = plane(f"{SERVO}variable top equal 0.967-0.1*{word}\n{walls}")
    scene.run(MOVE)
    values = f"variable value equal {column}\n"
    scene.run(values + "thermo 1000\nrun 0")
    of_ylo = force(scene)[1]  # alone: the lid has no place before that
    scene.run("run 0")
    assert force(scene)[1] > of_ylo + 1e-5
    places = [0.967 - 0.1 * scene.lmp.extract_variable("value")]
    for _ in range(4):
        scene.run("run 1")
        here = plane(SIDES.replace("0.967", f"{places[-1]:.17g}"), x=scene.x)
        here.energy()
        np.testing.assert_allclose(force(scene), force(here), rtol=1e-8, atol=1e-11)
        places.append(0.967 - 0.1 * scene.lmp.extract_variable("value"))
    assert np.ptp(places[1:]) > 1e-8


@pytest.mark.parametrize("dimension", [2, 3])
def test_energy_that_a_servo_takes(dimension, tmp_path):
    """It appears without work, and the total is conserved from then on."""
    lid = "compute press all pressure NULL pair\nvariable top equal {}-{}*c_press\n"
    others = "fix others all deformable/wall xlo -{0}5 xhi {0}5 ylo -{0}6 "
    if dimension == 2:
        scene = plane(others.format(0.96) + "\n")
        scene.run(lid.format(0.967, 300) + "fix walls all deformable/wall yhi v_top")
    else:
        scene = walled(CUBE, others.format(1.9) + "yhi 1.96 zlo -1.97\n", tmp_path)
        scene.run(lid.format(1.97, 3) + "fix walls all deformable/wall zhi v_top")
    scene.run("thermo_style custom step econserve\nthermo_modify norm no\nfix move all nve")
    scene.run("timestep 0.01\nrun 1")
    assert given(scene) == 0
    before = scene.lmp.get_thermo("econserve")
    scene.run("run 400")
    assert abs(given(scene)) > 1e-6
    assert scene.lmp.get_thermo("econserve") == pytest.approx(before, abs=0.01 * abs(given(scene)))


def test_a_servo_in_two_runs():
    """The second one goes on with the lid where it was."""
    walls = f"fix walls all deformable/wall {SIDES.replace('0.967', 'v_top')}\n"
    found = []
    for runs in ("run 60", "run 20\nrun 40", "run 20\nrun 40 pre no", "run 60 every 7 NULL"):
        scene = plane(f"{SERVO}variable top equal 0.967-0.1*c_press[2]\n{walls}")
        scene.run(MOVE + runs)
        found.append([*scene.x.ravel(), *force(scene), given(scene)])
        assert given(scene) != 0
    for other in found[1:]:
        np.testing.assert_allclose(other, found[0], rtol=1e-9, atol=1e-12)


def test_a_servo_in_space(tmp_path):
    walls = (
        "compute press all pressure NULL pair\nvariable top equal 1.97-0.1*c_press\n"
        "fix walls all deformable/wall xlo -1.97 xhi 1.98 ylo -1.96 yhi 1.98 zlo -1.97 zhi v_top\n"
    )
    scene = walled(CUBE, walls, tmp_path)
    scene.run("fix move all nve\ntimestep 0.05\nthermo 1000\nrun 0")
    places = []
    for _ in range(3):
        places.append(1.97 - 0.1 * scene.lmp.extract_compute("press", 0, 0))
        scene.run("run 1")
        here = walled(scene.x, walls.replace("v_top", f"{places[-1]:.17g}"), tmp_path)
        np.testing.assert_allclose(force(scene), force(here), rtol=1e-7, atol=1e-10)
    assert abs(places[2] - places[1]) > 1e-7


def test_contacts_with_a_side_that_moves(tmp_path):
    """A grain at rest is damped by gn times the velocity of the wall."""
    walls = "variable top equal 1-0.1*step*dt\nfix walls all deformable/wall yhi v_top\n"
    scene = Grains([[0, 0.05]], 1, "0.5 1 1 damp 0.2", tmp_path, commands=walls, dt=0.001)
    scene.run("unfix move\nrun 5")
    assert scene.rows[0, 7] == pytest.approx(-0.2 * 0.1, rel=1e-6)
    assert scene.terms["damping"] == pytest.approx(0.2 * 0.1**2 * 0.005, rel=0.2)


RANKS = """units lj
dimension 2
atom_modify map yes
boundary p f p
processors {grid}
region box block 0 8 0 9 -0.5 0.5
create_box 1 box
{balance}
{atoms}
mass * 1.0
pair_style {style}
pair_coeff * * ../species a
compute press all pressure NULL pair
variable top equal 8-0.5*c_press[2]
fix walls all deformable/wall ylo EDGE yhi v_top
velocity all create 0.002 5 loop geom
fix move all nve
timestep 0.02
thermo_modify norm no
run 40
print "$(pe:%.17g) $(f_walls:%.17g) $(f_walls[2]:%.17g) $(v_top:%.17g)" file values
"""


def test_a_servo_in_two_runs_from_a_file(tmp_path):
    """Its place goes on, so that the lid is there from the first force on."""
    (tmp_path / "species").write_text("a 1.0 inf 0 tension 1.0\n")
    atoms = "\n".join(f"create_atoms 1 single {2 * i + 0.9} 4.98 0" for i in range(4))
    start = RANKS.format(grid="* * *", balance="", atoms=atoms, style=EXACT["balanced"])
    start = start.replace("ylo EDGE", "ylo 4").replace("8-0.5", "5.97-0.5").replace("../", "")
    head, tail = start.split("run 40")
    in_process(f"{head}run 40{tail}", tmp_path)
    one = np.loadtxt(tmp_path / "values")
    in_process(f"{head}run 15\nwrite_restart half\n", tmp_path)
    fixes = "pair_style" + head.split("pair_style")[1].replace("velocity", "#")
    in_process(f"atom_modify map yes\nread_restart half\n{fixes}run 25{tail}", tmp_path)
    np.testing.assert_allclose(np.loadtxt(tmp_path / "values"), one, rtol=1e-9, atol=1e-12)
    assert one[1] != 0


def test_a_servo_on_ranks(tmp_path):
    (tmp_path / "species").write_text("a 1.0 inf 0 tension 1.0\n")
    atoms = "\n".join(
        f"create_atoms 1 single {2 * i + 0.9} {2 * j + 0.98} 0" for i in range(4) for j in range(4)
    )
    fields = {"atoms": atoms, "style": EXACT["balanced"]}
    folders = on_grids(RANKS, tmp_path, ("1 1 1", "1 2 1"), **fields)
    found = {grid: np.loadtxt(folder / "values") for grid, folder in folders.items()}
    assert found["1 1 1"][1] != 0
    for values in found.values():
        np.testing.assert_allclose(values, found["1 1 1"], rtol=1e-8, atol=1e-12)


def test_the_servo_of_a_rheologist(tmp_path):
    """As LAMMPS' fix wall/harmonic takes such a variable, without a run before it."""
    (tmp_path / "species").write_text("# UNITS: lj\ndrop 0.5 inf 0 tension 1\n")
    script = """units lj
boundary p p f
region box block -2 2 -2 2 -3 3
create_box 1 box
create_atoms 1 single 0 0 0
create_atoms 1 single 0.95 0 0
mass 1 1.0
pair_style deformable/droplet
pair_coeff * * species drop
compute press all pressure NULL pair
variable top equal 2-0.01*c_press
fix walls all deformable/wall zlo -2 zhi v_top
fix move all nve
thermo 100
run 5
run 5
"""
    for ranks in (1, 2):
        finished(ranks, script, tmp_path)


@pytest.mark.parametrize(
    ("word", "before"), in_turn(["c_press[2]", "c_both", "pe"], ["", "thermo 1\nrun 2\n"])
)
def test_a_region_at_what_a_run_finds(word, before):
    """An error of one line where the walls are placed, in each step and also after a run."""
    region = "region lid plane 0 0.967 0 0 -1 0 move NULL v_up NULL\n"
    scene = plane(f"{SERVO}variable up equal -0.1*{word}\n{region}")
    scene.run(before + "fix walls all deformable/wall lid")
    with pytest.raises(Exception, match="was not tallied on needed timestep"):
        scene.run("run 3")


def test_minimization_needs_the_place():
    walls = f"fix walls all deformable/wall {SIDES.replace('0.967', 'v_top')}\n"
    scene = plane(f"{SERVO}variable top equal 0.967-0.1*c_press[2]\n{walls}")
    with pytest.raises(Exception, match=r"place of yhi depends on .*use 'run 0' before minimize"):
        scene.run("minimize 0 1e-8 10 20")
    scene = plane(f"{SERVO}variable top equal 0.967-0.1*c_press[2]\n{walls}")
    scene.run("run 0\nminimize 0 1e-9 1000 5000")
    assert abs(force(scene)[1]) < 1e-6  # of opposite sides
    assert scene.energy() > 1e-5
    assert given(scene) == 0


def test_variables_that_are_defined_anew():
    scene = plane(f"variable top equal 0.967\nfix walls all deformable/wall {SIDES[:-5]}v_top\n")
    energy = scene.energy()
    assert energy == pytest.approx(plane(SIDES).energy(), rel=1e-12)
    scene.run("variable top delete\nvariable top equal 0.95")
    assert scene.energy() > 1.1 * energy
    scene.run("variable top delete")
    with pytest.raises(
        Exception, match="walls deformable/wall: yhi: variable 'top' does not exist"
    ):
        scene.energy()


WORDS = {
    "zlo -2": "'zlo' is no wall in 2 dimensions: it must .* or a side 'xlo' to 'yhi'",
    "xlo -2 shears y 1": "unknown word 'shears': .* 'yhi', and after them 'shear', 'load' or",
    "xlo": "xlo' of fix deformable/wall does not exist",
    "ylo -2 xlo": "xlo needs its place: a number, EDGE or v_name",
    "ylo top": "Expected floating point.*'top'",
    "ylo v_none": "ylo: variable 'none' does not exist",
    "ylo v_word": "ylo: variable 'word' must be equal-style",
}


def test_words():
    scene = plane("xlo -2")
    scene.run("unfix walls\nvariable word string up")
    for words, message in WORDS.items():
        with pytest.raises(Exception, match=message):
            scene.run(f"fix walls all deformable/wall {words}")


@pytest.mark.parametrize(
    ("place", "boundary", "warns"),
    [
        ("EDGE", "f p p", False),
        ("EDGE", "p f p", True),
        ("-3", "p f p", True),
        ("-2", "p p p", False),
    ],
)
def test_side_of_a_periodic_box(place, boundary, warns, tmp_path):
    """Particles meet through the side, which has nothing behind it."""
    log = tmp_path / "log"
    plane(f"xlo {place}", boundary=boundary, log=log).evaluate()
    assert ("'xlo' lies at a side of the box that is periodic" in log.read_text()) == warns


@pytest.mark.parametrize(("side", "warns"), [("ylo -3", True), ("xlo -3", False)])
def test_side_of_a_tilted_periodic_box(side, warns, tmp_path):
    log = tmp_path / "log"
    scene = plane("ylo -2", boundary="p p p", log=log)
    scene.run(
        f"unfix walls\nchange_box all triclinic xy final 1.0\nfix w all deformable/wall {side}"
    )
    scene.energy()
    assert ("lies at a side of the box that is periodic" in log.read_text()) == warns


def test_edge_of_a_tilted_box():
    with pytest.raises(Exception, match="xlo EDGE: a side of a tilted box is no plane"):
        plane("xlo EDGE", boundary="f p p", tilt=0.0)

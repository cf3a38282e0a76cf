"""Walls that slide along themselves: what friction feels, and the work of the wall."""

import numpy as np
import pytest
from droplet_walls import ORIGIN, walled
from grains import Grains
from laws import ring_laws
from parallel import in_process, on_grids
from scene import Scene

G, SPEED = 0.1, 0.5
FRICTION = "0.5 1 1 damp 1"
WEIGHT = f"fix weight all addforce 0 -{G} 0\n"


def on_belt(floor, folder, law="balanced", **options):
    commands = f"{floor}\n{WEIGHT}"
    return Grains(
        [[-3, 0.985]], 1, FRICTION, folder, law=law, commands=commands, dt=0.01, **options
    )


def total(scene):
    """Of one disk, whose kinetic energy LAMMPS takes for 0."""
    return scene.balance() + 0.5 * np.sum(scene.v**2) + G * scene.x[0, 1]


def given(scene):
    return scene.lmp.extract_fix("floor", 0, 0)


@ring_laws
def test_a_belt_carries_a_disk(law, tmp_path):
    """From rest it rolls with a third of its speed in the end. The belt does the work."""
    scene = on_belt(f"fix floor all deformable/wall ylo 0 shear x {SPEED}", tmp_path, law)
    scene.run("run 0")
    before = total(scene)
    scene.run("run 1500")
    height = scene.x[0, 1]
    rolling = SPEED / (1 + 0.5 / height**2)
    assert scene.v[0, 0] == pytest.approx(SPEED - rolling, rel=2e-3)
    assert scene.spin[0] * height == pytest.approx(rolling, rel=2e-3)
    assert total(scene) == pytest.approx(before, abs=1e-5)
    assert given(scene) < -0.05


WALKS = {
    "steady": (f"{SPEED}", f"{SPEED}*step*dt"),
    "to and fro": ("v_speed", "0.2*(1-cos(0.5*step*dt))/0.5"),
}


@pytest.mark.parametrize(("speed", "way"), WALKS.values(), ids=WALKS)
def test_shear_is_a_plane_that_moves(speed, way, tmp_path):
    """Along itself: the same forces and work, to the second order in the time step."""
    variable = "variable speed equal 0.2*sin(0.5*(step-0.5)*dt)\n"  # in the middle of a step
    shear = on_belt(
        f"{variable}fix floor all deformable/wall plane 0 0 0 1 shear x {speed}", tmp_path
    )
    plane = on_belt(
        f"variable way equal {way}\nregion floor plane 0 0 0 0 1 0 move v_way NULL NULL\n"
        "fix floor all deformable/wall floor",
        tmp_path,
    )
    found = []
    for scene in (shear, plane):
        scene.run("run 1500")
        found.append([*scene.x[0], *scene.v[0], *scene.spin, given(scene), *scene.terms.values()])
    np.testing.assert_allclose(found[0], found[1], rtol=1e-4, atol=1e-7)
    assert abs(given(shear)) > 1e-3


def test_a_cell_between_two_walls(tmp_path):
    """Both sides bear the same shear force; the upper wall's work is what contacts lose."""
    x = [[k % 4 * 2.0 - 3 + 0.9 * (k // 4 % 2), 1.7 * (k // 4) + 0.97] for k in range(12)]
    scene = Grains(
        x, 1, "0.5 1 0.3 damp 0.5", tmp_path, box=(-4, 4, 0, 5.35), boundary="p f p",
        commands="fix low all deformable/wall ylo EDGE\n"
        "fix high all deformable/wall yhi EDGE shear x 0.1",
    )  # fmt: skip
    scene.run("run 2000\nrun 0")
    begin = scene.balance(), scene.lmp.extract_fix("high", 0, 0)
    means = "fix means all ave/time 1 2000 2000 f_high[1] f_low[1] f_high[2] f_low[2]"
    scene.run(f"{means}\nrun 2000")
    high, low, up, down = (scene.lmp.extract_fix("means", 0, 1, k) for k in range(4))
    assert high < -0.01
    assert high == pytest.approx(-low, rel=0.05)
    assert up == pytest.approx(-down, rel=0.02)
    work = begin[1] - scene.lmp.extract_fix("high", 0, 0)
    assert work == pytest.approx(-high * 0.1 * 20, rel=0.01)
    assert scene.balance() == pytest.approx(begin[0], abs=0.02 * work)
    assert scene.lmp.extract_fix("low", 0, 0) == 0


RANKS = """units lj
dimension 2
atom_style sphere
boundary p f p
processors {grid}
region box block 0 8 0 5.35 -0.5 0.5
create_box 1 box
{balance}
{atoms}
set group all diameter 2.0
set group all mass 1.0
pair_style deformable/ring
pair_coeff * * ../species drop
comm_modify cutoff 4.0
fix move all nve/sphere disc
fix low all deformable/wall ylo EDGE
fix high all deformable/wall yhi EDGE shear x 0.1
fix rub all deformable/friction 0.5 1.0 0.3 damp 0.5
timestep 0.02
thermo_modify norm no
run 200
print "$(pe:%.17g) $(f_high:%.17g) $(f_high[1]:%.17g) $(f_low[1]:%.17g) $(f_rub:%.17g)" file values
"""


def test_ranks(tmp_path):
    (tmp_path / "species").write_text("# UNITS: lj\ndrop 1 inf 0 tension 1\n")
    atoms = "\n".join(
        f"create_atoms 1 single {(k % 4 * 2 + 0.9 * (k // 4 % 2)) % 8} {1.7 * (k // 4) + 0.97} 0"
        for k in range(12)
    )
    folders = on_grids(RANKS, tmp_path, ("1 1 1", "2 1 1"), atoms=atoms)
    found = {grid: np.loadtxt(folder / "values") for grid, folder in folders.items()}
    assert found["1 1 1"][1] < -1e-2
    for values in found.values():
        np.testing.assert_allclose(values, found["1 1 1"], rtol=1e-7)


def test_without_friction_it_moves_nothing(tmp_path):
    log = tmp_path / "log"
    floor = "fix floor all deformable/wall ylo -0.45 shear x 1\n"
    scene = Scene(
        np.zeros((1, 2)), ["small"], (-3, 3, -3, 3), "deformable/ring", boundary="p f p",
        commands=floor, log=log,
    )  # fmt: skip
    scene.run("fix move all nve\nrun 10")
    assert np.abs(scene.gather("v", 3)[0, 0]) == 0
    assert "shear moves nothing without fix deformable/friction" in log.read_text()
    assert given(scene) == 0


WORDS = {
    "ylo 0 shear x": "deformable/wall shear",
    "ylo 0 shear z 1": "shear goes along x or y, not 'z'",
    "ylo 0 shear y 1": "'ylo' cannot slide along y, as sides and planes along it do",
    "ylo 0 xlo -5 shear x 1": "'xlo' cannot slide along x.*a fix of its own without shear",
    "circle 0 0 5 shear x 1": "'circle 1' cannot slide along x.*or a region that rotates",
    "plane 0 0 1 1 shear x 1": "'plane 1' cannot slide along x",
    "ylo 0 shear x v_none": "shear: variable 'none' does not exist",
    "ylo 0 shear x 1 ylo 1": "unknown word 'ylo' after shear: only adhesion w, shear dim v",
    "turns shear x 1": "'turns' cannot slide along x",
}


def test_words(tmp_path):
    turns = "variable a equal step\nregion turns plane 0 0 0 0 1 0 rotate v_a 0 0 0 0 0 1\n"
    for words, message in WORDS.items():
        with pytest.raises(Exception, match=message):
            on_belt(f"{turns}fix floor all deformable/wall {words}\nrun 0", tmp_path)


def test_walls_in_space_slide_along_themselves(tmp_path):
    with pytest.raises(Exception, match="'zlo' cannot slide along z"):
        walled(ORIGIN, "zlo -2 shear z 1", tmp_path)


def test_restart_and_minimization(tmp_path):
    """A belt goes on with its speed, and minimizers pass over it."""
    (tmp_path / "species").write_text("# UNITS: lj\ndrop 1 inf 0 tension 1\n")
    style = "pair_style deformable/ring\npair_coeff * * species drop\n"
    fixes = (
        f"fix floor all deformable/wall ylo 0 shear x {SPEED}\n{WEIGHT}"
        f"fix rub all deformable/friction {FRICTION}\nfix move all nve/sphere disc\ntimestep 0.01\n"
        "thermo_style custom step pe\n"
    )
    end = "write_dump all custom {} x y vx vy omegaz modify format float %.17g\n"
    start = (
        "dimension 2\natom_style sphere\nboundary p f p\nregion box block -3 3 -1 3 -0.5 0.5\n"
        "create_box 1 box\ncreate_atoms 1 single 0 0.985 0\nset group all diameter 2\n"
        f"set group all mass 1\n{style}{fixes}"
    )
    in_process(start + "run 80\n" + end.format("one"), tmp_path)
    in_process(start + "run 30\nwrite_restart half\n", tmp_path)
    in_process(f"read_restart half\n{style}{fixes}run 50\n" + end.format("two"), tmp_path)
    one, two = (np.loadtxt(tmp_path / name, skiprows=9) for name in ("one", "two"))
    np.testing.assert_allclose(two, one, rtol=1e-9, atol=1e-12)
    assert one[2] > 0.01
    in_process(start + "minimize 0 1e-9 100 200\n" + end.format("min"), tmp_path)
    assert np.loadtxt(tmp_path / "min", skiprows=9)[[0, 2, 4]] == pytest.approx(0, abs=1e-12)

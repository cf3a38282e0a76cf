"""A wall under a load: Newton's equation, energy and momentum, equilibrium, restarts, ranks."""

import numpy as np
import pytest
from droplet_walls import CUBE, walled
from grains import Grains
from laws import two_laws
from obstacles import kinetic
from parallel import assert_same, finished, in_process, on_grids, report, reported
from test_walls_sides import plane

X = np.array([[i - 1.5, j + 0.48] for i in range(4) for j in range(3)]) * [0.99, 0.975]
FLOOR = "fix floor all deformable/wall xlo -1.98 xhi 1.98 ylo 0\n"
LID = "fix walls all deformable/wall yhi {at} load {load} {mass}\n"
MOVE = "velocity all create 0.01 125\nfix flat all enforce2d\nfix move all nve\ntimestep {dt}\n"


def lid(scene):
    """Its force, place and velocity along its axis, and the energy it has."""
    values = [scene.lmp.extract_fix("walls", 0, 1, k) for k in range(5)]
    return np.array(values[:3]), *values[3:], scene.lmp.extract_fix("walls", 0, 0)


@pytest.mark.parametrize(("side", "sign"), [("xlo", -1), ("yhi", 1)])
def test_a_wall_alone_falls(side, sign):
    """By F t^2/2m, towards the particles."""
    scene = plane(f"{side} {2.5 * sign} load 0.3 6", x=np.zeros((1, 2)), boundary="f f p")
    scene.run("timestep 0.1\nrun 20")
    force, place, velocity, energy = lid(scene)
    time, gain = 2.0, -sign * 0.3 / 6
    assert velocity == pytest.approx(gain * time, rel=1e-12)
    assert place == pytest.approx(2.5 * sign + 0.5 * gain * time**2, rel=1e-12)
    assert not force.any()
    assert energy == 0  # the particles have given none


def test_a_wall_alone_in_other_units(tmp_path):
    """Mass times acceleration is a force by LAMMPS' factor of the units."""
    factor = {"metal": 1 / 1.0364269e-4, "real": 4.184e-4, "si": 1.0}
    for units, ftm2v in factor.items():
        (tmp_path / "species").write_text(f"# UNITS: {units}\na 1.0 inf 0 tension 1.0\n")
        script = (
            f"units {units}\ndimension 2\nboundary p f p\nregion box block 0 9 0 9 -0.5 0.5\n"
            "create_box 1 box\ncreate_atoms 1 single 1 1 0 units box\nmass 1 1\n"
            "pair_style deformable/ring\npair_coeff * * species a\ntimestep 0.01\n"
            "fix walls all deformable/wall yhi 8 load 0.03 50\nthermo_style custom step\n"
            'run 10\nprint "$(f_walls[5]:%.17g)" file velocity\n'
        )
        in_process(script, tmp_path)
        found = float(np.loadtxt(tmp_path / "velocity"))
        assert found == pytest.approx(-0.03 / 50 * ftm2v * 0.1, rel=1e-6), units


@two_laws
def test_energy_and_momentum(law):
    """Kinetic energy of the lid and work of the load are what particles give, to second order."""
    mass, load, errors = 5.0, 0.2, []
    for dt in (0.02, 0.005):
        scene = plane(FLOOR + LID.format(at=2.93, load=load, mass=mass), law, X, "f f p")
        scene.run(MOVE.format(dt=dt) + "run 0")
        before = scene.lmp.get_thermo("pe") + kinetic(scene)
        start, wrong, most = lid(scene)[1], [], 0.0
        for _ in range(8):
            scene.run(f"run {round(1 / dt)} post no")
            _, place, v, energy = lid(scene)
            total = scene.lmp.get_thermo("pe") + kinetic(scene)
            own = 0.5 * mass * v**2 + load * (place - start)
            most = max(most, abs(energy))
            wrong.append((total + energy - before, energy - own))
        errors.append(np.abs(wrong).max(axis=0))
        assert most > 0.03
    assert (errors[0] < 0.01 * most).all()
    assert (errors[1] < 0.15 * errors[0]).all()  # 1/16


def test_momentum():
    """A grain that meets a lid in free space: what both have together changes by F t only."""
    scene = plane(
        LID.format(at=0.6, load=0.01, mass=3), x=np.array([[0.1, -0.2]]), boundary="p f p"
    )
    scene.run("velocity all set 0.1 0.5 0\nfix move all nve\ntimestep 0.02\nrun 0")
    for steps in (25, 75):
        scene.run(f"run {steps}")
    v = lid(scene)[2]
    assert v > 0.05
    momentum = 3 * v + scene.gather("v", 3)[0, 1]
    assert momentum == pytest.approx(0.5 - 0.01 * 100 * 0.02, abs=1e-12)


def test_equilibrium():
    """At rest the particles bear the load: p L of a periodic box, and the wall's weight."""
    rows = [[i - 2.75 + 0.5 * (j % 2), 0.86 * j + 0.45] for i in range(6) for j in range(3)]
    load = 0.05 * 6 + 2.0 * 0.01  # p L + m g
    walls = "fix floor all deformable/wall ylo 0\n" + LID.format(at=2.7, load=load, mass=2)
    scene = plane(walls, x=np.array(rows), boundary="p f p")
    scene.run("fix drag all viscous 0.5\nfix move all nve\ntimestep 0.05\nrun 4000")
    force, place, v, _ = lid(scene)
    assert force[1] == pytest.approx(load, rel=3e-4)
    assert scene.force_on_wall("floor")[1] == pytest.approx(-load, rel=3e-4)
    assert abs(v) < 1e-4
    assert 2.0 < place < 2.6
    h, energies = 1e-4, []
    for at in (place - h, place + h):  # the load is the slope of the energy
        x = np.column_stack([(scene.x[:, 0] + 3) % 6 - 3, scene.x[:, 1]])
        fixed = plane(f"ylo 0 yhi {at!r}", x=x, boundary="p f p")
        energies.append(fixed.energy())
    assert (energies[0] - energies[1]) / (2 * h) == pytest.approx(load, rel=1e-3)


def test_in_space(tmp_path):
    """Droplets under a lid of a cube: energy, and the load in the end."""
    others = "fix others all deformable/wall xlo -1.97 xhi 1.98 ylo -1.96 yhi 1.98 zlo -1.97\n"
    walls = others + "fix walls all deformable/wall zhi 1.97 load 0.6 4\n"
    scene = walled(CUBE, walls, tmp_path)
    scene.run("thermo_style custom step pe ke econserve\nthermo_modify norm no\n")
    scene.run("velocity all create 2e-4 125\nfix move all nve\ntimestep 0.02\nrun 0")
    before = scene.lmp.get_thermo("econserve")
    scene.run("run 300")
    _, place, v, energy = lid(scene)
    assert scene.lmp.get_thermo("econserve") == pytest.approx(before, abs=1e-3 * abs(energy))
    assert energy == pytest.approx(2 * v**2 + 0.6 * (place - 1.97), abs=1e-3 * abs(energy))
    assert place < 1.95
    scene.run("fix drag all viscous 0.5\ntimestep 0.05\nrun 1500")
    assert lid(scene)[0][2] == pytest.approx(0.6, rel=1e-3)


def test_loads_that_vary():
    """A load is a variable of the time, or of what a run finds: here drag of the lid."""
    scene = plane(
        "variable load equal 0.3*step*dt\n" + LID.format(at=2.5, load="v_load", mass=6),
        x=np.zeros((1, 2)),
        boundary="p f p",
    )
    scene.run("timestep 0.01\nrun 100")
    assert lid(scene)[2] == pytest.approx(-0.3 / 6 / 2, rel=1e-9)
    scene = plane(
        "variable load equal 3+6*f_walls[5]\n" + LID.format(at=2.5, load="v_load", mass=6),
        x=np.zeros((1, 2)),
        boundary="p f p",
    )
    scene.run("timestep 0.001\nrun 1000")
    assert lid(scene)[2] == pytest.approx(-0.5 * (1 - np.exp(-1)), rel=2e-3)


def test_minimization():
    """The wall stays where it is, and keeps its velocity."""
    scene = plane(FLOOR + LID.format(at=2.93, load=0.2, mass=5), x=X)
    scene.run(MOVE.format(dt=0.02) + "run 20")
    _, place, v, energy = lid(scene)
    scene.run("minimize 0 1e-8 500 2000")
    assert lid(scene)[1:] == (place, v, energy)
    assert v != 0


RUN = """processors {grid}
boundary p f p
region box block 0 8 0 9 -0.5 0.5
create_box 1 box
{balance}
{atoms}
mass * 1.0
velocity all create 0.002 5 loop geom
{more}
"""
HEAD = "units lj\ndimension 2\natom_modify map yes\n"
MORE = """pair_style deformable/ring balance 1e-12 100
pair_coeff * * {species} a
fix low all deformable/wall ylo EDGE
fix lid all deformable/wall yhi 8.0 load 0.4 12
fix move all nve
timestep 0.02
thermo_modify norm no
"""
ATOMS = "\n".join(
    f"create_atoms 1 single {2 * i + 0.9} {2 * j + 0.98} 0" for i in range(4) for j in range(4)
)
VALUES = "pe econserve f_lid f_lid[2] f_lid[4] f_lid[5]"


def test_ranks(tmp_path):
    (tmp_path / "species").write_text("a 1.0 inf 0 tension 1.0\n")
    more = MORE.format(species=tmp_path / "species") + report(60, VALUES, "x y fx fy")
    fields = {"atoms": ATOMS, "more": more}
    folders = on_grids(HEAD + RUN, tmp_path, ("1 1 1", "1 2 1"), **fields)
    found = reported(folders, 60)
    assert_same(found, 1e-9, atol=1e-11)
    assert found["1 1 1"][0][4] < 7.99


def test_restart(tmp_path):
    """Place, velocity and energy go on; the number of the input is where the first run began."""
    (tmp_path / "species").write_text("a 1.0 inf 0 tension 1.0\n")
    more = MORE.format(species="species")
    start = HEAD + RUN.format(grid="* * *", balance="", atoms=ATOMS, more=more)
    end = report(60, VALUES, "x y fx fy").replace("run 60", "")
    in_process(f"{start}run 60\n{end}", tmp_path)
    one = np.loadtxt(tmp_path / "scalars60"), np.loadtxt(tmp_path / "atoms60", skiprows=9)
    for write, read in ((1, 1), (2, 1), (1, 2)):
        finished(write, f"{start}run 25\nwrite_restart half\n", tmp_path)
        finished(read, f"atom_modify map yes\nread_restart half\n{more}run 35\n{end}", tmp_path)
        two = np.loadtxt(tmp_path / "scalars60"), np.loadtxt(tmp_path / "atoms60", skiprows=9)
        np.testing.assert_allclose(two[0], one[0], rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(two[1][:, 2:], one[1][:, 2:], rtol=1e-8, atol=1e-10)


@pytest.mark.parametrize("wall", ["yhi 8.0", "room"])
def test_restart_without_the_load(wall, tmp_path):
    """Another wall of this ID is as it is written, and a warning tells."""
    (tmp_path / "species").write_text("a 1.0 inf 0 tension 1.0\n")
    more = MORE.format(species="species")
    start = HEAD + RUN.format(grid="* * *", balance="", atoms=ATOMS, more=more)
    in_process(f"{start}run 9\nwrite_restart half\n", tmp_path)
    more = more.replace("fix lid all deformable/wall yhi 8.0 load 0.4 12", "{}").format(
        f"region room block INF INF INF 8.0 INF INF\nfix lid all deformable/wall {wall}"
    )
    values = report(10, "f_lid f_lid[2]", "x y").replace("run 10", "run 1")
    out = in_process(f"atom_modify map yes\nread_restart half\n{more}{values}", tmp_path)
    assert "the restart file has 1 sides of it that move under a load, here are 0, which" in out
    assert np.loadtxt(tmp_path / "scalars10")[0] == 0


def test_thermo_output():
    """Forces are extensive, place and velocity are not: *norm yes* leaves them."""
    scene = plane(FLOOR + LID.format(at=2.93, load=0.2, mass=5), x=X)
    scene.run("thermo_style custom step f_walls[2] f_walls[4] f_walls[5]\nthermo_modify norm yes")
    scene.run(MOVE.format(dt=0.02) + "run 20")
    force, place, v, _ = lid(scene)
    shown = scene.lmp.last_thermo()
    found = [shown[f"f_walls[{k}]"] for k in (2, 4, 5)]
    np.testing.assert_allclose(found, [force[1] / len(X), place, v], rtol=1e-12)
    assert v != 0


def test_two_runs_are_one():
    found = []
    for runs in ("run 60", "run 25\nrun 35", "run 25\nrun 35 pre no"):
        scene = plane(FLOOR + LID.format(at=2.93, load=0.2, mass=5), x=X)
        scene.run(MOVE.format(dt=0.02) + runs)
        found.append([*scene.x.ravel(), *lid(scene)[1:]])
    np.testing.assert_allclose(found[1], found[0], rtol=1e-10)
    np.testing.assert_allclose(found[2], found[0], rtol=1e-10)


def test_a_loaded_lid_that_slides(tmp_path):
    """A shear cell: the lid keeps its load, and friction's work counts with that of the load."""
    x = [[k % 4 * 2.0 - 3 + 0.9 * (k // 4 % 2), 1.7 * (k // 4) + 0.97] for k in range(12)]
    scene = Grains(
        x, 1, "0.5 1 0.3 damp 0.5", tmp_path, box=(-4, 4, 0, 9), boundary="p f p",
        commands="fix low all deformable/wall ylo EDGE\n"
        "fix walls all deformable/wall yhi 5.35 load 0.8 20 shear x 0.1",
    )  # fmt: skip
    scene.run("run 0")
    before = scene.balance()
    scene.run("run 2000\nfix means all ave/time 1 2000 2000 f_walls[1] f_walls[2]\nrun 2000")
    along, across = (scene.lmp.extract_fix("means", 0, 1, k) for k in range(2))
    assert across == pytest.approx(0.8, rel=0.05)
    assert along < -0.05
    lost = sum(scene.terms[name] for name in ("sliding", "dashpots", "damping"))
    assert lost > 0.05
    assert scene.balance() == pytest.approx(before, abs=0.02 * lost)


WORDS = {
    "yhi 2 load 1": "deformable/wall load",
    "yhi 2 load 1 0": "the mass of a wall under a load must be positive and finite, not 0",
    "yhi 2 load x 1": "Expected floating point.*'x'",
    "yhi 2 load v_none 1": "load: variable 'none' does not exist",
    "yhi EDGE load 1 1": "load needs one side, .* with the number where it begins",
    "yhi v_top load 1 1": "load needs one side",
    "yhi 2 ylo -2 load 1 1": "load needs one side.*other walls fixes of their own",
    "room load 1 1": "load needs one side",
}


def test_words():
    scene = plane("yhi 2", x=np.zeros((1, 2)))
    scene.run("unfix walls\nvariable top equal 2\nregion room block -2 2 -2 2 INF INF")
    for words, message in WORDS.items():
        with pytest.raises(Exception, match=message):
            scene.run(f"fix walls all deformable/wall {words}\nrun 0")

"""Walls of any outline in LAMMPS: against planes and polygons, in motion, on ranks, and refused."""

import numpy as np
import pytest
from derivatives import assert_forces
from droplet_walls import CUBE, walled
from droplets import EXACT as DROPLETS
from laws import EXACT, LAWS, two_laws
from meshes import CROSS, box, closed, floor, turned, words, write_stl
from obstacles import ROOM, assert_walls_do_the_work, given, scene_of, total
from parallel import FEW, assert_same, on_grids, report, reported
from scene import SPECIES as UNITS
from scene import Scene
from turns import in_turn

SPECIES = ["large", "unit"] * 4
X = [[-3.2, -3], [-1, -3], [1.2, -3], [3.1, -2.9], [-3.0, 3], [-1, 3], [1.2, 3], [3.1, 2.9]]
PLANES = "plane -4 -4 1 0 plane -4 -4 0 1 plane 4 4 -1 0 plane 4 4 0 -1"
SQUARE = np.array([(-4, -4), (4, -4), (4, 4), (-4, 4)], float)


def assert_same_state(one, other, rtol=1e-10):
    assert one.energy > 1e-8
    assert one.energy == pytest.approx(other.energy, rel=rtol)
    scale = np.abs(other.force).max()
    np.testing.assert_allclose(one.force, other.force, rtol=0, atol=rtol * scale)


@two_laws
@pytest.mark.parametrize("corners", [SQUARE, SQUARE[::-1]], ids=["around", "the other way"])
def test_room_of_a_polygon_is_its_planes(law, corners):
    """Forces, their virial and forces on the wall, and the state after a relaxation."""
    room = words("room", corners)
    scenes = [
        scene_of(X, SPECIES, EXACT[law], f"fix wall all deformable/wall {walls}\n")
        for walls in (room, PLANES)
    ]
    one, other = (scene.evaluate() for scene in scenes)
    assert_same_state(one, other)
    np.testing.assert_allclose(one.virial, other.virial, rtol=1e-10, atol=1e-13)
    on_wall = [scene.force_on_wall("wall") for scene in scenes]
    np.testing.assert_allclose(*on_wall, rtol=0, atol=1e-12)
    for scene in scenes:
        scene.run("minimize 0 1e-13 2000 20000")
    np.testing.assert_allclose(scenes[0].x, scenes[1].x, rtol=0, atol=1e-9)


def test_room_of_triangles_is_its_planes(tmp_path):
    x = CUBE + 0.05 * np.random.default_rng(3).normal(size=CUBE.shape)
    planes = "xlo -1.97 xhi 1.98 ylo -1.96 yhi 1.98 zlo -1.97 zhi 1.96"
    triangles = box((-1.97, -1.96, -1.97), (1.98, 1.98, 1.96))
    path = write_stl(tmp_path / "room.stl", turned(triangles), binary=False)
    scenes = [
        walled(x, walls, tmp_path, style=DROPLETS)
        for walls in (f"room {path}", words("room", triangles), planes)
    ]
    for scene in scenes[:2]:
        assert_same_state(scene, scenes[2])
    for scene in scenes:
        scene.run("min_style fire\nmin_modify dmax 0.02\ntimestep 0.1\nminimize 0 1e-11 3000 9000")
    np.testing.assert_allclose(scenes[0].x, scenes[2].x, rtol=0, atol=1e-8)


@two_laws
def test_convex_outline_is_a_polygon(law):
    """From outside, where they touch a side, a corner, and one another."""
    corners = np.array([(-1, -0.6), (1.1, -0.8), (0.9, 0.9), (-0.8, 0.7)])
    numbers = " ".join(f"{v:.17g}" for v in corners.ravel())
    x = np.array([[-1.75, 1.2], [-1.6, 0.0], [1.4, 1.4]])
    one, other = (
        scene_of(x, ["unit", "small", "unit"], EXACT[law], f"fix w all deformable/wall {walls}\n")
        for walls in (words("surface", closed(corners)), f"polygon 4 {numbers}")
    )
    assert_same_state(one.evaluate(), other.evaluate())


# Particles roll down a floor of many elements under gravity, held by friction.
ROLL = """
fix pull all gravity 0.02 vector 1 -2 0
fix rub all deformable/friction 0.4 0.3 0.1
fix move all nve/sphere disc
timestep 0.02
"""


@pytest.mark.parametrize("friction", [False, True], ids=["smooth", "rough"])
def test_joints_of_a_plane_are_not_felt(friction):
    """A ring that rolls over a hundred segments of a line moves as on a plane."""
    chain = np.c_[np.linspace(-9, 9, 101), np.zeros(101)]
    commands = ROLL if friction else ROLL.replace("fix rub all", "# ")
    found = []
    for walls in (words("surface", chain), "plane 0 0 0 1"):
        scene = scene_of(
            [[-3.0, 0.93]],
            ["unit"],
            "radical",
            f"fix wall all deformable/wall {walls}\n{commands}",
            radii=[1.0],
        )
        scene.run("run 1500")
        found.append(np.concatenate([scene.x[0], scene.gather("omega", 3)[0]]))
    assert found[0][0] > -1.0  # it has come over many
    np.testing.assert_allclose(*found, rtol=0, atol=1e-10)


def test_joints_of_triangles_are_not_felt(tmp_path):
    """A droplet that slides over many triangles in one plane."""
    x = np.array([[-1.3, -0.9, 0.97]])
    paths = []
    mesh = turned(floor(30.0, 40))
    path = write_stl(tmp_path / "floor.stl", mesh, binary=True)
    for walls in (f"surface {path}", "plane 0 0 0 0 0 1"):
        scene = walled(x, walls, tmp_path, boundary="f f f")
        scene.run("velocity all set 0.3 0.2 -0.02\nfix move all nve\ntimestep 0.02\nrun 400")
        paths.append(np.append(scene.x, scene.energy))
    assert paths[1][0] > 1.0
    np.testing.assert_allclose(*paths, rtol=0, atol=1e-10)


@two_laws
@pytest.mark.parametrize("corners", [6, 16, 60])
def test_energy_in_a_polygon(law, corners):
    """Over sharp corners with two contacts, and smooth joints, where one is handed on."""
    angle = 2 * np.pi * np.arange(corners) / corners + 0.1
    room = words("room", 4 * np.c_[np.cos(angle), np.sin(angle)])
    scene = scene_of([[0, -2.9]], ["unit"], EXACT[law], f"fix wall all deformable/wall {room}\n")
    scene.run("velocity all set 0.2 0.05 0\nfix pull all gravity 0.01 vector 0 -1 0\n")
    scene.run("fix move all nve\ntimestep 0.005\nrun 0")
    found, elastic = [], []
    for _ in range(50):
        scene.run("run 200 post no")
        found.append(total(scene) + 0.01 * scene.x[0, 1])
        elastic.append(scene.lmp.get_thermo("pe"))
    assert max(elastic) > 3e-3
    assert np.ptp(found) < 3e-5


def hills(x):
    return -1.3 + 0.25 * np.sin(1.7 * x[..., 0]) * np.cos(1.3 * x[..., 1])


def test_energy_over_hills(tmp_path):
    """A droplet that rolls over hundreds of triangles; the error falls with the time step."""
    errors = []
    for step in (0.02, 0.005):
        mesh = words("surface", floor(7.9, 12, hills))
        scene = walled(np.array([[-1.3, -0.9, -0.1]]), mesh, tmp_path)
        scene.run("velocity all set 0.1 0.07 0\nfix pull all gravity 0.02 vector 0 0 -1\n")
        scene.run(f"fix move all nve\ntimestep {step}\nrun 0")
        found = []
        for _ in range(40):
            scene.run(f"run {round(0.6 / step)} post no")
            kinetic_energy = 0.5 * (scene.gather("v") ** 2).sum()
            found.append(scene.energy + kinetic_energy + 0.02 * scene.x[0, 2])
        errors.append(np.ptp(found))
    assert errors[0] < 5e-5
    assert errors[1] < 0.25 * errors[0]


@pytest.mark.parametrize("dimension", [2, 3])
def test_films_on_joints(dimension, tmp_path):
    """A drop that sticks to a mesh of a plane, and is pulled along it, is one on the plane."""
    pull = "fix pull all addforce 0.03 0.01 0\nfix drag all viscous 0.1\nfix move all nve\n"
    found = []
    if dimension == 2:
        (tmp_path / "species").write_text("a 1.0 2.0 0 tension 1.0\n")
        chain = np.c_[np.linspace(-9, 9, 82), np.zeros(82)]
        for walls in (words("surface", chain), "plane 0 0 0 1"):
            commands = f"fix wall all deformable/wall {walls} adhesion 0.3\n{pull}"
            law, coeff = "deformable/ring contact curved", f"pair_coeff * * {tmp_path}/species a"
            scene = scene_of([[0.0, 0.9]], ["a"], law, commands, coeff=coeff)
            scene.run("timestep 0.05\nrun 400")
            found.append([*scene.x[0], scene.lmp.get_thermo("pe")])
    else:
        mesh = turned(floor(7.9, 20, lambda x: 0 * x[..., 0] - 1))
        for walls in (words("surface", mesh), "plane 0 0 -1 0 0 1"):
            x = np.array([[0.0, 0.0, -0.1]])
            scene = walled(x, f"{walls} adhesion 0.1", tmp_path, style=DROPLETS, more=pull)
            scene.run("timestep 0.05\nrun 400")
            found.append([*scene.x[0], scene.energy])
    assert found[0][0] > 0.5
    np.testing.assert_allclose(*found, rtol=0, atol=1e-9)


STAIRS = np.array([(-8, 0), (-2, 0), (-2, -1.3), (1, -1.3), (1, -2.6), (8, -2.6)], float)


@two_laws
def test_energy_on_a_staircase(law):
    """A particle that falls down steps, over convex corners into concave ones, keeps its energy."""
    walls = f"fix wall all deformable/wall {words('surface', STAIRS)} plane 5 0 -1 0\n"
    scene = scene_of([[-3.0, 1.3]], ["unit"], EXACT[law], walls)
    scene.run("velocity all set 0.15 0 0\nfix pull all gravity 0.01 vector 0 -1 0\n")
    scene.run("fix move all nve\ntimestep 0.01\nrun 0")
    found, lowest = [], 0.0
    for _ in range(80):
        scene.run("run 200 post no")
        found.append(total(scene) + 0.01 * scene.x[0, 1])
        lowest = min(lowest, scene.x[0, 1])
    assert lowest < -1.5
    assert np.ptp(found) < 1e-4 * 0.03


MACHINES = {
    "a cross that turns": (
        "variable angle equal 0.01*step*dt\n",
        words("surface", closed(CROSS * 1.6)) + " rotate v_angle 0.3 0.1 0 0 0 1",
    ),
    "a hook that swings": (
        "variable angle equal 0.3*sin(0.02*step*dt)\nvariable dx equal 0.2*sin(0.03*step*dt)\n",
        words("surface", [(-1.5, 0), (0, 0), (0, 1.6), (1.5, 1.2)])
        + " move v_dx NULL NULL rotate v_angle 0 0 0 0 0 -1",
    ),
    "a room that shakes": (
        "variable dx equal 0.15*sin(0.03*step*dt)\nvariable dy equal 0.1*sin(0.02*step*dt)\n",
        words("room", SQUARE) + " move v_dx v_dy NULL",
    ),
}


@pytest.mark.parametrize(("machine", "law"), in_turn(MACHINES, ["radical", "balanced"]))
def test_energy_that_moving_outlines_take(machine, law):
    """Total energy changes by the work of the wall."""
    variables, moving = MACHINES[machine]
    walls = f"{variables}fix wall all deformable/wall {moving}\n"
    walls += f"fix room all deformable/wall {words('room', SQUARE * 1.1)}\n"
    scene = scene_of(X, SPECIES, law, walls)
    assert_walls_do_the_work(scene, 2e-4)


def test_moved_outline_is_the_outline_there():
    angle, point, shift = 0.7, np.array([0.3, -0.2]), np.array([0.4, -0.1])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved = (CROSS - point) @ turn.T + point + shift
    names = f"variable a equal {angle}\nvariable x equal {shift[0]}\nvariable y equal {shift[1]}\n"
    ways = (
        f"{names}fix wall all deformable/wall {words('surface', closed(CROSS))} "
        f"move v_x v_y NULL rotate v_a {point[0]} {point[1]} 0 0 0 1\n",
        f"fix wall all deformable/wall {words('surface', closed(moved))}\n",
    )
    x = moved[[3, 9]] * 1.7
    one, other = (scene_of(x, ["unit", "unit"], "radical", way) for way in ways)
    assert_same_state(one.evaluate(), other.evaluate())


@two_laws
def test_forces_are_the_gradient(law):
    """At corners of either kind, with several contacts of a particle."""
    walls = f"fix w all deformable/wall {words('surface', closed(CROSS * 1.5))}\n"
    x = np.array([[1.55, 1.48], [-2.3, 1.0], [-1.35, -1.6], [0.2, -2.4]])
    scene = scene_of(x, ["unit", "unit", "small", "unit"], EXACT[law], walls)
    assert_forces(scene, x)
    force = scene.evaluate(x).force.sum(axis=0)
    np.testing.assert_allclose(scene.force_on_wall("w"), -force, rtol=0, atol=1e-12)


def test_forces_of_triangles_are_the_gradient(tmp_path):
    """Of droplets over hills, at edges and corners of the mesh."""

    mesh = words("surface", floor(7.0, 5, hills))
    x = CUBE[::2] * [1, 1, 0] + 0.05 * np.random.default_rng(2).normal(size=(4, 3)) - [0, 0, 0.25]

    def scene(at):
        return walled(at, mesh, tmp_path, style=DROPLETS)

    force, step = scene(x).force, 1e-5
    for k, axis in np.ndindex(x.shape):
        shift = np.zeros_like(x)
        shift[k, axis] = step
        slope = (scene(x + shift).energy - scene(x - shift).energy) / (2 * step)
        assert -slope == pytest.approx(force[k, axis], abs=1e-7)


COMMANDS = """
units lj
dimension 2
boundary f f p
atom_style sphere 1
atom_modify map yes
processors {grid}
region box block -6 6 -4 4 -0.5 0.5
create_box 1 box
{atoms}
set group all diameter 2 mass 1
{balance}
pair_style deformable/ring contact curved
pair_coeff * * {species} a
variable angle equal 0.02*step*dt
fix room all deformable/wall {room} adhesion 0.1
fix mixer all deformable/wall surface {mixer} rotate v_angle 0.2 0.1 0 0 0 1
fix_modify room virial yes
fix rub all deformable/friction 0.4 0.2 0.1
thermo_style custom step pe press pxx pyy pxy
thermo_modify norm no
"""


def test_ranks(tmp_path):
    """A mixer of crossing blades, read from a file, in a room with adhesion and friction."""
    y, x = np.meshgrid(np.linspace(-3.0, 3.0, 4), np.linspace(-5.0, 5.0, 6))
    grid = np.c_[x.ravel(), y.ravel()] + 0.05 * np.random.default_rng(4).normal(size=(24, 2))
    grid = grid[np.abs(grid).max(axis=1) > 1.5]
    atoms = "\n".join("create_atoms 1 single {:.17g} {:.17g} 0".format(*at) for at in grid)
    (tmp_path / "species").write_text("a 1.0 2.0 0 tension 1.0\n")
    np.savetxt(tmp_path / "mixer.csv", closed(CROSS * 2.2), delimiter=",", header="x,y")
    fields = {
        "atoms": atoms,
        "species": tmp_path / "species",
        "mixer": tmp_path / "mixer.csv",
        "room": words("room", [(-5.9, -3.9), (5.9, -3.9), (5.9, 3.9), (0, 3.7), (-5.9, 3.9)]),
    }
    scalars = "pe press pxx pyy pxy f_mixer f_room[1] f_room[2] f_mixer[1] f_mixer[2]"
    commands = COMMANDS + report(0, scalars, "x y fx fy")
    commands += "velocity all create 0.01 5 loop geom\nfix move all nve/sphere disc\n"
    commands += "timestep 0.02\n" + report(60, scalars, "x y fx fy")
    folders = on_grids(commands, tmp_path, FEW, **fields)
    before, after = (reported(folders, steps) for steps in (0, 60))
    assert_same(before, 1e-9, atol=1e-9)
    assert_same(after, 1e-8, atol=1e-8)
    assert abs(after["1 1 1"][0][5]) > 1e-4  # the mixer does work


@pytest.mark.parametrize("friction", [False, True])
def test_restart(friction, tmp_path):
    """In the middle of a turn, with springs of friction at sides and corners."""
    numbers = words("surface", closed(CROSS * 1.6))
    walls = f"""
        variable angle equal 0.01*step*dt
        fix wall all deformable/wall {numbers} rotate v_angle 0.3 0.1 0 0 0 1
        fix room all deformable/wall {words("room", SQUARE)}
        {"fix rub all deformable/friction 0.4 0.1 0.1" if friction else ""}"""
    go_on = "fix move all nve/sphere disc\ntimestep 0.02\n"
    scene = scene_of(X, ["unit"] * 8, "radical", walls, radii=[1.0] * 8)
    scene.run(f"velocity all create 0.01 5\n{go_on}run 300\nwrite_restart {tmp_path}/half")
    scene.run("run 200")
    x, work = scene.x, given(scene)
    scene.run(f"clear\natom_modify map yes\nread_restart {tmp_path}/half")
    scene.run(f"pair_style {LAWS['radical']}\npair_coeff * * {UNITS} unit\n{walls}\n{go_on}run 200")
    assert abs(work) > 1e-4
    np.testing.assert_allclose(scene.x, x, rtol=0, atol=1e-12)
    assert given(scene) == pytest.approx(work, rel=1e-9)


REFUSED = {
    "file": ("surface none.csv", "surface 1, file 'none.csv', cannot be opened: No such file"),
    "no file": ("disk 0 0 1 surface", "surface needs a file, or a number of points"),
    "few": ("room 1 0 0", "room: 1 points are too few, give 2 or more"),
    "words": ("surface 3 0 0 1 0", "surface needs 6 numbers, but 4 follow"),
    "twice": ("surface 3 0 0 1 0 1 0", r"surface 1 has no length at segment 2: both .* \(1, 0\)"),
    "flat": ("room 3 0 0 1 0 0 0", "room 1 has no inside: segment 1 and what is joined"),
    "shear": ("surface 2 0 0 1 0 shear x 1", "'surface 1' cannot slide along x"),
    "load": ("surface 2 0 0 1 0 load 1 1", "load needs one side"),
    "lift": ("surface 2 0 0 1 0 move NULL NULL v_one", "nothing moves along z: use NULL"),
    "tilt": ("surface 2 0 0 1 0 rotate v_one 0 0 0 1 0 0", "the axis of rotate is along z"),
    "no axis": ("surface 2 0 0 1 0 rotate v_one 0 0 0 0 0 0", "needs a point and an axis"),
    "disk": ("disk 0 0 1 move v_one NULL NULL", "only a surface or a room has .*not 'disk 1'"),
    "unknown": ("surface 2 0 0 1 0 move v_none NULL NULL", "variable 'none' does not exist"),
}


@pytest.mark.parametrize(("words_", "message"), REFUSED.values(), ids=REFUSED)
def test_what_is_refused(words_, message):
    with pytest.raises(Exception, match=message):
        scene_of(
            [[7.9, 7.9]],
            ["small"],
            "radical",
            f"variable one equal 1\nfix w all deformable/wall {words_}\n",
        )


def test_center_on_the_wrong_side():
    """In the obstacle, outside of the room, or too near to a chain."""
    for kind, corners, message in (
        ("surface", closed(CROSS), "is in the obstacle 'surface 1' of fix w"),
        ("room", CROSS + np.array([0.0, 1.2]), "is outside of 'room 1' of fix w"),
        ("surface", [(-1, 0.02), (1, 0.02)], "is only 0.02 from 'surface 1' of fix w"),
    ):
        scene = scene_of(
            [[0.0, 0.0]], ["unit"], "radical", f"fix w all deformable/wall {words(kind, corners)}\n"
        )
        with pytest.raises(Exception, match=message):
            scene.run("run 0")


def test_triangles_are_refused(tmp_path):
    triangles = box((-1, -1, -1), (1, 1, 1))
    flat = triangles.copy()
    flat[4] = [(0, 0, 0), (1, 1, 1), (2, 2, 2)]
    for kind, mesh, binary, message in (
        ("room", triangles[1:], True, "room 1, file '.*', is open at .*a container must be closed"),
        ("surface", flat, False, "surface 1, file '.*', has no area at triangle 5: its corners"),
    ):
        path = write_stl(tmp_path / "mesh.stl", mesh, binary)
        with pytest.raises(Exception, match=message):
            walled(np.array([[3.0, 3.0, 3.0]]), f"{kind} {path}", tmp_path)


def test_image_of_an_obstacle():
    """It repeats with the periodic box, if it fits into it."""
    found = []
    for middle, place in ((0.0, [0.9, 0.6]), (8.7, [-8.4, -8.7])):
        walls = f"fix w all deformable/wall {words('surface', closed(CROSS * 0.5 + middle))}\n"
        scene = Scene([place], ["unit"], ROOM, LAWS["radical"], commands=walls)
        found.append(scene.evaluate())
    assert_same_state(*found)

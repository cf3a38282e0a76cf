"""Droplets between walls in three dimensions: exact values, derivatives, contacts with a gap."""

import numpy as np
import pytest
from droplet_walls import (
    CUBE,
    ORIGIN,
    SCENES,
    SIDE,
    at_walls,
    faces,
    force_on_walls,
    region,
    walled,
)
from lammps_deformable import core
from polyhedra import FACES, FORCES, INDENTATIONS

shaken = CUBE + 0.02 * np.random.default_rng(3).normal(size=CUBE.shape)
VIRIAL = "fix_modify walls virial yes\n"


@pytest.mark.parametrize("name", FORCES)
def test_regular_polyhedra(name, tmp_path):
    """One droplet in the polyhedron of its contacts: the table of the theory, to all digits."""
    *forces, energy = FORCES[name]
    normals = FACES[name]
    for indentation, force in zip(INDENTATIONS, forces, strict=True):
        if force is None:
            continue
        scene = walled(ORIGIN, faces(normals, 1 - indentation), tmp_path, more=VIRIAL)
        rows = at_walls(scene)
        assert rows[:, 4] == pytest.approx(np.full(len(normals), force), rel=1e-9)
        assert rows[:, 2] == pytest.approx(indentation)
        assert rows[:, 11] == pytest.approx(1 - indentation)
        assert np.abs(scene.force).max() < 1e-12
        assert np.abs(force_on_walls(scene)).max() < 1e-12
        virial = len(normals) * force * (1 - indentation)
        assert scene.lmp.get_thermo("press") == pytest.approx(virial / 3 / SIDE**3, rel=1e-8)
        if indentation == 0.03:
            assert scene.energy == pytest.approx(energy, rel=1e-8)


def slope(energy, h=2e-5):
    """The derivative of a function at 0."""
    near, far = energy(h) - energy(-h), energy(2 * h) - energy(-2 * h)
    return (8 * near - far) / (12 * h)


@pytest.mark.parametrize("name", SCENES)
def test_derivatives(name, tmp_path):
    """Forces on droplets and on all walls, and what contacts with walls say about them."""
    scene = walled(shaken, SCENES[name], tmp_path)
    x, force, rows = scene.x, scene.force, at_walls(scene)
    on_walls = force_on_walls(scene)
    if "fix second" in SCENES[name]:
        on_walls = on_walls + force_on_walls(scene, "second")
    if "out" in SCENES[name] or "union" in SCENES[name]:
        assert len(rows) > 24  # more than of the room
    rng = np.random.default_rng(1)
    for _ in range(2):
        along = rng.normal(size=x.shape)
        found = slope(lambda h, along=along: scene.energy_at(x + h * along))
        assert found == pytest.approx(-(force * along).sum(), abs=2e-7)
    assert force.sum(axis=0) == pytest.approx(-on_walls, abs=1e-12)
    assert rows[:, 12:15].sum(axis=0) == pytest.approx(-on_walls, abs=1e-12)
    own = rows[:, 0].astype(int) - 1
    middle = x[own] + (1 - rows[:, 2:3]) * rows[:, 8:11]
    assert rows[:, 5:8] == pytest.approx(middle)


def brick(F, low=(-0.43, -0.43, -0.44), sides=(0.87, 0.88, 0.88)):
    """Droplets are at its corners. F is an upper triangle."""
    low, sides = F @ low, F @ np.diag(sides)
    ends = " ".join(
        f"{x:.17g} {x + side:.17g}" for x, side in zip(low, sides.diagonal(), strict=True)
    )
    tilts = " ".join(f"{x:.17g}" for x in (sides[0, 1], sides[0, 2], sides[1, 2]))
    return f"region post prism {ends} {tilts} side out\nfix post all deformable/wall post\n"


def bar(F):
    """Droplets are at its edges."""
    return brick(F, (-0.31, -0.31, -1.5), (0.63, 0.64, 3.0))


def post(F):
    """A round one along z: it stays round to first order, if it is not stretched across."""
    words = " ".join(f"{x:.17g}" for x in [*F @ [0.01, 0.02, 0.3], *F[:, 2]])
    return f"fix post all deformable/wall post {words} 0.44\n"


STRAINS = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]


def strained(F):
    """Planes and droplets in a strained space, where normals are those of the strained planes."""
    normals = np.vstack([np.eye(3), -np.eye(3)]) + 0.02 * np.array(
        [[0, 1, 2], [2, 0, 1], [1, -1, 0], [0, -1, 1], [1, 0, -2], [-2, 1, 0]]
    )
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    points = (1.97 * normals) @ F.T
    normals = normals @ np.linalg.inv(F)
    lengths = np.linalg.norm(normals, axis=1)
    heights = (points * normals).sum(axis=1) / lengths
    return shaken @ F.T, faces(normals / lengths[:, None], heights)


@pytest.mark.parametrize(
    ("obstacle", "strains"),
    [(None, STRAINS), (brick, STRAINS), (bar, STRAINS), (post, [(2, 2), (0, 2), (1, 2)])],
    ids=["planes", "corners", "edges", "post"],
)
def test_virial(obstacle, strains, tmp_path):
    """The derivative of the energy by strains of droplets and walls. They may turn all: a simple
    shear is as good as a pure one."""

    def scene(F, more=""):
        x, walls = strained(F)
        return walled(x, walls + (obstacle(F) if obstacle else ""), tmp_path, more=more)

    virial = VIRIAL + VIRIAL.replace("walls", "post") * bool(obstacle)
    start = scene(np.eye(3), virial)
    assert len(at_walls(start)) >= 19 + 4 * bool(obstacle)
    for a, b in strains:

        def energy(h, a=a, b=b):
            F = np.eye(3)
            F[a, b] += h
            return scene(F).energy

        expected = -start.stress()[STRAINS.index((a, b))] * SIDE**3
        assert slope(energy) == pytest.approx(expected, abs=1e-6), (a, b)


@pytest.mark.parametrize("name", ["ball", "cone"])
def test_virial_at_round_walls(name, tmp_path):
    """The trace is the derivative by the size of the scene, without the radii of droplets."""
    scene = walled(shaken, SCENES[name], tmp_path, more=VIRIAL)

    def energy(h):
        words = [
            [f"{float(w) * (1 + h):.17g}" if "." in w else w for w in line.split()]
            for line in SCENES[name].splitlines()
        ]
        walls = "\n".join(" ".join(line) for line in words) + "\n"
        return walled(shaken * (1 + h), walls, tmp_path).energy

    assert slope(energy) == pytest.approx(-scene.stress()[:3].sum() * SIDE**3, abs=1e-6)


def test_walls_with_a_gap(tmp_path):
    """Plates press a droplet against walls that it would not touch."""
    normals, heights = FACES["sc"], np.array([1.003, 1.02, 0.93, 0.93, 1.004, 1.002])
    scene = walled(ORIGIN, faces(normals, heights), tmp_path)
    rows = at_walls(scene)
    assert len(rows) == 5
    assert (rows[:, 2] < 0).sum() == 3
    theory = core.droplet(rows[:, 8:11], rows[:, 4])
    assert theory.indentation == pytest.approx(1 - rows[:, 11], abs=1e-9)
    far = core.droplet(np.vstack([rows[:, 8:11], normals[1]]), np.append(rows[:, 4], 0.0))
    assert 1 - heights[1] < far.indentation[-1]  # it does not touch this one


def test_results_of_a_droplet(tmp_path):
    fix = "fix shape all pair 1 deformable/droplet area 0 contacts 0 pressure 0 load 0\n"
    scene = walled(ORIGIN, faces(FACES["sc"], 0.97), tmp_path, more=fix)
    area, contacts, pressure, load = np.array(scene.lmp.gather("f_shape", 1, 4))
    force = FORCES["sc"][1]
    assert contacts == 6
    assert load == pytest.approx(6 * force / (8 * np.pi))
    assert area - 4 * np.pi == pytest.approx(scene.energy)
    assert pressure * 4 * np.pi == pytest.approx(2 * area + 6 * force * 0.97)


def test_words_and_regions_are_the_same(tmp_path):
    """Sides of the box, planes, and round walls; a turned cylinder; the group of the fix."""

    def energy(walls, **options):
        return walled(shaken, walls, tmp_path, **options).energy

    block = energy(SCENES["block"])
    sides = "xlo -1.97 xhi 1.98 ylo -1.96 yhi 1.98 zlo -1.97 zhi 1.96"
    assert energy(sides) == pytest.approx(block, rel=1e-13)
    planes = "plane 0 0 -1.97 0 0 2 plane 0 0 1.96 0 0 -1 xlo -1.97 xhi 1.98 ylo -1.96 yhi 1.98"
    assert energy(planes) == pytest.approx(block, rel=1e-13)
    assert energy("sphere 0.02 0.01 -0.01 2.7") == pytest.approx(
        energy(SCENES["sphere"]), rel=1e-13
    )
    ball = f"{sides} ball 0.01 0.02 0 0.75"
    assert energy(ball) == pytest.approx(energy(SCENES["ball"]), rel=1e-13)
    tube = "cylinder 0.02 0 0.01 0 -3 0 2.39 ylo -1.97 yhi 1.96"
    assert energy(tube) == pytest.approx(energy(SCENES["cylinder"]), rel=1e-13)
    post = f"{sides} post 0.01 0.02 9 0 0 -3 0.44"
    assert energy(post) == pytest.approx(energy(SCENES["pillar"]), rel=1e-13)
    funnel = f"cone -1.97 0.01 0.02 3 0 0 2.5 {(2.33 - 2.5) / 3.94!r} xlo -1.97 xhi 1.97"
    assert energy(funnel) == pytest.approx(energy(SCENES["cone"]), rel=1e-10)
    turned = "variable quarter equal PI/2\n" + region(
        "room cylinder x -0.02 0.01 2.39 -1.97 1.96 rotate v_quarter 0 0 0 0 0 1"
    )
    assert energy(turned) == pytest.approx(energy(SCENES["cylinder"]), rel=1e-10)
    none = energy("zlo -9", more="group few id 1 2\n")
    few = "group few id 1 2\n" + SCENES["block"].replace("walls all", "walls few")
    assert none < energy(few) < block


def test_edge_of_the_box(tmp_path):
    """EDGE follows the box."""
    walls = "xlo EDGE xhi EDGE ylo EDGE yhi EDGE zlo EDGE zhi EDGE"
    scene = walled(shaken, walls, tmp_path)
    none = scene.energy
    scene.run(
        "change_box all x final -1.97 1.98 y final -1.96 1.98 z final -1.97 1.96 units box\nrun 0"
    )
    assert none < scene.energy == pytest.approx(walled(shaken, SCENES["block"], tmp_path).energy)


def test_obstacles_without_room_for_images_have_none(tmp_path):
    """The image would be around the droplet."""
    scene = walled(np.array([[-3.7, 0, 0]]), "ball 3.4 0 0 3.2", tmp_path, boundary="p p p")
    assert len(scene.contacts()) == 0


@pytest.mark.parametrize(
    "post", ["ball 3.4 3.5 3.3 0.6", "cylinder y 3.4 3.3 0.3 INF INF side out"]
)
def test_obstacles_repeat_with_the_box(post, tmp_path):
    """A droplet on the other side of the boundary touches it, as one at its image does."""
    x = np.array([[-3.7, -3.6, -3.8]])
    if "side" in post:
        post = region(f"post {post}")
    near = walled(x, post, tmp_path, boundary="p p p")
    assert len(at_walls(near)) == 1
    inside = walled(x + np.array([SIDE, SIDE, 0]), post, tmp_path, boundary="p p p")
    assert inside.energy == pytest.approx(near.energy, rel=1e-12)

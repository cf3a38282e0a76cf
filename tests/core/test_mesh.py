"""Contacts with walls of any outline: where distances are smallest, each once."""

from itertools import pairwise

import numpy as np
import pytest
from lammps_deformable import core
from meshes import CROSS, box, closed, floor, turned

RNG = np.random.default_rng(1)
REACH = 0.9


def scene_of(dimension, corners, inside=False):
    scene = core.Scene(0, 0, 0) if dimension == 2 else core.SpaceScene(0, 0, 0, 0, 0, 0)
    scene.add_mesh(np.reshape(corners, (-1, dimension)), inside)
    return scene


def contacts(scene, x, reach=REACH):
    """Rows of the point, direction, distance and turn, in order."""
    rows = scene.contacts(np.ascontiguousarray(x, float), reach)
    rows = np.delete(rows, [1, -1], axis=1)
    return rows[np.lexsort(np.round(rows.T, 9)[::-1])]


def same(first, second, x, reach=REACH, atol=1e-12):
    one, other = contacts(first, x, reach), contacts(second, x, reach)
    assert one.shape == other.shape
    np.testing.assert_allclose(one, other, rtol=0, atol=atol)
    return one


@pytest.mark.parametrize("cells", [1, 7, 40])
def test_floor_of_triangles_is_a_plane(cells):
    """Also above joints and corners of the mesh, from both sides, whichever way triangles face."""
    x = RNG.uniform(-3, 3, (4000, 3)) * [1, 1, 0.3]
    grid = np.linspace(-3, 3, cells + 1)
    x[:1000, 0] = RNG.choice(grid, 1000)
    x[500:1500, 1] = RNG.choice(grid, 1000)
    x[1500:2000, 1] = x[1500:2000, 0]
    x = x[np.abs(x[:, 2]) > 1e-3]
    rows = contacts(scene_of(3, turned(floor(6.0, cells))), x)
    assert (rows[:, 0] == np.arange(len(x))).all()
    np.testing.assert_allclose(rows[:, 1:4], -np.sign(x[:, 2:]) * [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(rows[:, 4], np.abs(x[:, 2]), rtol=1e-12)
    within = np.abs(x[:, :2]).max(axis=1) < 3.0
    assert (rows[within, 5] == 0.0).all()  # a plane, not a corner


def test_straight_chain_is_a_line():
    scene = scene_of(2, np.c_[np.linspace(-3, 3, 14), np.zeros(14)])
    x = np.concatenate([np.linspace(-2.9, 2.9, 201), np.linspace(-3, 3, 14)[1:-1]])
    rows = contacts(scene, np.c_[x, 0 * x + 0.5])
    expected = [[k, 0.0, -1.0, 0.5] for k in range(len(x))]
    np.testing.assert_allclose(rows[:, :4], expected, rtol=0, atol=1e-14)
    assert (rows[:, 4] == 0.0).all()


@pytest.mark.parametrize("corners", [3, 4, 5, 6, 9])
def test_convex_container_is_its_planes(corners):
    """A polygon from inside: at blunt corners, too, where a foot lies beyond the end of a side."""
    angle = 2 * np.pi * np.arange(corners) / corners + 0.3
    polygon = 5 * np.c_[np.cos(angle), np.sin(angle)]
    planes = core.Scene(0, 0, 0)
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        planes.add_plane(*a, a[1] - b[1], b[0] - a[0])
    x = RNG.uniform(-5, 5, (8000, 2))
    x = x[planes.nearest(*x.T).reshape(corners, -1, 4)[..., 2].min(axis=0) > 0.05]
    for chain in (polygon, closed(polygon), polygon[::-1]):
        rows = same(scene_of(2, chain, True), planes, x)
    assert len(rows) > len(np.unique(rows[:, 0])) > 100  # two at corners


def test_box_of_triangles_is_its_planes():
    planes = core.SpaceScene(0, 0, 0, 0, 0, 0)
    for n in np.eye(3):
        planes.add_plane(0, 0, 0, *n)
        planes.add_plane(3, 2, 4, *-n)
    x = RNG.uniform(0.05, 0.95, (4000, 3)) * [3, 2, 4]
    for triangles in (box((0, 0, 0), (3, 2, 4)), turned(box((0, 0, 0), (3, 2, 4)))):
        rows = same(scene_of(3, triangles, True), planes, x)
    assert np.bincount(rows[:, 0].astype(int)).max() >= 3


@pytest.mark.parametrize("dimension", [2, 3])
def test_convex_obstacle_is_its_nearest_point(dimension):
    """From outside, however its parts face; inside of it the distance is negative."""
    low, high = np.array([-1.0, -0.4, 0.2])[:dimension], np.array([0.7, 0.9, 1.1])[:dimension]
    if dimension == 2:
        corners = closed(np.array([low, (high[0], low[1]), high, (low[0], high[1])]))
        versions = [corners, corners[::-1]]
    else:
        versions = [box(low, high), turned(box(low, high))]
    x = RNG.uniform(-2.5, 2.5, (6000, dimension))
    to = np.clip(x, low, high) - x
    distance = np.linalg.norm(to, axis=1)
    outside = distance > 1e-9
    near = outside & (distance < REACH)
    for corners in versions:
        scene = scene_of(dimension, corners)
        rows = contacts(scene, x[near])
        assert (rows[:, 0] == np.arange(near.sum())).all()
        np.testing.assert_allclose(rows[:, -2], distance[near], rtol=1e-10)
        np.testing.assert_allclose(
            rows[:, 1:-2], to[near] / distance[near, None], rtol=0, atol=1e-10
        )
        found = scene.nearest(*x.T)
        np.testing.assert_allclose(found[outside, -2], distance[outside], rtol=1e-10)
        depth = np.minimum(x - low, high - x).min(axis=1)
        np.testing.assert_allclose(found[~outside, -2], -depth[~outside], rtol=1e-10)


def test_what_lies_behind_a_thin_plate():
    """Its other side is not touched; triangles that are there twice count once."""
    x = RNG.uniform(-1.5, 1.5, (200, 3)) * [1, 1, 0] + [0, 0, 0.4]
    ground = floor(4.0, 3)
    meshes = box((-2, -2, -0.1), (2, 2, 0.0)), np.concatenate([ground, turned(ground[::2])])
    for mesh in meshes:
        rows = contacts(scene_of(3, mesh), x, 0.6)
        assert (rows[:, 0] == np.arange(len(x))).all()
        np.testing.assert_allclose(rows[:, 4], 0.4, rtol=1e-12)


def bumpy(x):
    return 0.25 * np.sin(1.7 * x[..., 0]) * np.cos(1.3 * x[..., 1])


def samples(triangles, number):
    """Points of all triangles."""
    u = np.stack(np.meshgrid(*[np.linspace(0, 1, number)] * 2), axis=-1).reshape(-1, 2)
    u = u[u.sum(axis=1) <= 1 + 1e-12]
    weights = np.c_[1 - u.sum(axis=1), u]
    return np.einsum("pk,tkd->tpd", weights, triangles).reshape(-1, 3)


def test_nearest_contact_is_the_nearest_point():
    """Over a surface of hills, against points of all of its triangles."""
    triangles = floor(6.0, 6, bumpy)
    points = samples(triangles, 41)
    x = RNG.uniform(-2, 2, (200, 3)) * [1, 1, 0.4] + [0, 0, 0.1]
    rows = contacts(scene_of(3, triangles), x, 2.0)
    for k, center in enumerate(x):
        least = np.linalg.norm(points - center, axis=1).min()
        own = rows[rows[:, 0] == k, 4].min()
        assert least - 0.02 < own <= least + 1e-12


@pytest.mark.parametrize("corners", [3, 30])
@pytest.mark.parametrize("way", ["over an edge", "into a valley"])
def test_energy_is_continuous(way, corners):
    """Of springs at all contacts: wide faces go on, of facets the nearest one counts."""
    up = -1.0 if way == "over an edge" else 1.0
    cells = corners + 1
    triangles = floor(
        6.0, cells, lambda x: 0.2 * up * np.abs(x[..., 0]) + 0.1 * up * np.abs(x[..., 1])
    )
    along = np.linspace(-1, 1, 4001)
    for x in ([1.0, 0.3, 0.0], [0.7, 0.71, 0.0], [0.2, -1.0, 0.0]):
        rows = contacts(scene_of(3, triangles), along[:, None] * x + [0.01, 0.0, 0.5])
        energy = np.zeros(len(along))
        np.add.at(energy, rows[:, 0].astype(int), (REACH - rows[:, 4]) ** 2)
        assert energy.min() > 0.0
        assert np.abs(np.diff(energy)).max() < 2e-3


def test_sharp_concave_corner_has_two_contacts():
    """At the cross: its re-entrant corners are sharp and have two, its outer ones have one."""
    scene = scene_of(2, closed(CROSS))
    rows = contacts(scene, [[0.9, 0.8], [1.3, 0.9], [0.5, 1.6], [0.0, 1.4]], 0.7)
    assert rows[:, 0].tolist() == [0.0, 0.0, 1.0, 2.0, 3.0]
    np.testing.assert_allclose(rows[:, 3], [0.4, 0.3, 0.5, 0.6, 0.4], atol=1e-12)


def test_chain_has_both_sides():
    """Also around its ends, and its order does not matter."""
    chain = np.array([(-1, 0), (0, 0), (0.8, 0.9), (0.8, 2.0)], float)
    x = RNG.uniform(-2, 3, (3000, 2))
    rows = same(scene_of(2, chain), scene_of(2, chain[::-1]), x)
    assert len(rows) > len(np.unique(rows[:, 0])) > 900
    segment = core.Scene(0, 0, 0)
    segment.add_polygon([-1, 2], [0.5, -0.7])
    same(scene_of(2, [(-1, 0.5), (2, -0.7)]), segment, x)


def test_corners_that_agree_but_for_rounding():
    """As in files with few digits, or in single precision."""
    angle = np.linspace(0.0, 2.0 * np.pi, 13)
    ring = np.c_[np.cos(angle), np.sin(angle), 0 * angle]
    sides = [(a, b, [0, 0, z]) for z in (-1, 1) for a, b in pairwise(ring)]
    noise = np.random.default_rng(5).uniform(-3e-8, 3e-8, (24, 3, 3))
    volume, edges = core.mesh(3, np.reshape(sides + noise, (-1, 3)), True)
    assert volume == pytest.approx(2.0 / 3.0 * 3.0, rel=1e-6)
    assert len(edges) == 2 * 36


def test_what_is_enclosed():
    triangles = box((0, 0, 0), (1, 2, 3))
    volume, edges = core.mesh(3, turned(triangles).reshape(-1, 3), True)
    assert volume == pytest.approx(6.0)
    assert edges.shape == (24, 3)  # of the twelve edges, without diagonals
    both = np.concatenate([triangles, triangles + 5.0])
    assert core.mesh(3, both.reshape(-1, 3), False)[0] == pytest.approx(12.0)
    assert core.mesh(3, triangles[:-1].reshape(-1, 3), False)[0] == 0.0
    assert core.mesh(2, closed(CROSS), False)[0] == pytest.approx(3.0)
    assert core.mesh(2, CROSS[::-1], True)[0] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("dimension", "corners", "inside", "message"),
    [
        (2, [(0, 0), (1, 0), (1, 0), (2, 0)], False, r"no length at segment 2: .* \(1, 0\)"),
        (3, [(0, 0, 0), (1, 1, 1), (2, 2, 2)], False, "no area at triangle 1: .* on a line"),
        (3, box((0, 0, 0), (1, 1, 1))[1:], True, "is open at .*must be closed"),
        (2, [(0, 0), (1, 0)], True, "is open at .*must be closed"),
        (2, [(0, 0), (1, 0), (0, 0)], True, "has no inside: segment 1"),
    ],
)
def test_what_is_refused(dimension, corners, inside, message):
    with pytest.raises(ValueError, match=message):
        core.mesh(dimension, np.reshape(np.array(corners, float), (-1, dimension)), inside)


def test_files():
    chain = b"x,y\n0, 1 # first\n\n2;3\r\n4\t5\n"
    assert core.read_mesh(2, chain).tolist() == [[0, 1], [2, 3], [4, 5]]
    for content, message in (
        (b"0 1\n2 x\n", "no point x y in line 2, but '2 x'"),
        (b"x y\n0 1\n", "1 points: a chain has two or more"),
    ):
        with pytest.raises(ValueError, match=message):
            core.read_mesh(2, content)
    with pytest.raises(ValueError, match="no vertex x y z in triangle 1, but '0 0 z'"):
        core.read_mesh(3, b"solid\nvertex 0 0 z")
    with pytest.raises(ValueError, match="is no STL file: it has 1 corners"):
        core.read_mesh(3, b"solid\nvertex 0 0 0\n")

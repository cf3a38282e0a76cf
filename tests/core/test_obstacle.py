"""The point of a convex polygon nearest to a particle, against shapely and in closed form."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from lammps_deformable import core, core_for_tests
from shapely import LineString, MultiPoint, Point, Polygon
from shapely.geometry import box

EPSILON = np.finfo(float).eps
SQUARE = ([1, 0, -1, 0], [0, 1, 0, -1], [1, 1, 1, 1])
coordinates = st.floats(-4, 4)
# normals at least 1 degree apart
polygons = st.lists(
    st.tuples(st.integers(0, 359), st.floats(0.2, 2)),
    min_size=1,
    max_size=7,
    unique_by=lambda p: p[0],
)


def half_planes(sides):
    angle, offset = np.radians([a for a, _ in sides]), np.array([h for _, h in sides])
    return np.cos(angle), np.sin(angle), offset


def clipped(nx, ny, offset):
    """The polygon by clipping a box of 2000."""
    found = box(-1e3, -1e3, 1e3, 1e3)
    for x, y, h in zip(nx, ny, offset, strict=True):
        n, t = np.array([x, y]), np.array([-y, x])
        corners = [
            h * n - 1e4 * t,
            h * n + 1e4 * t,
            (h - 1e4) * n + 1e4 * t,
            (h - 1e4) * n - 1e4 * t,
        ]
        found = found.intersection(Polygon(corners))
    return found


@given(sides=polygons, x=coordinates, y=coordinates)
def test_distance_of_any_polygon(sides, x, y):
    """Bounded or not, with redundant half planes or without."""
    planes = half_planes(sides)
    expected = clipped(*planes).distance(Point(x, y))
    found = core_for_tests.nearest_on_polygon(*planes, x, y)
    if found is None:
        assert expected < 1e-9
        return
    nx, ny, height, turn = found
    assert height == pytest.approx(expected, abs=1e-9)
    assert np.hypot(nx, ny) == pytest.approx(1, rel=4 * EPSILON)
    # the point is on the polygon, and no point of the polygon is beyond its contact line
    at = np.array([x + height * nx, y + height * ny])
    assert clipped(*planes).distance(Point(at)) < 1e-9
    assert turn in (0, pytest.approx(1 / height))


@given(sides=polygons, x=coordinates, y=coordinates, direction=st.floats(0, 2 * np.pi))
def test_continuous(sides, x, y, direction):
    """Distance and nearest point do not jump, wherever the center goes."""
    planes = half_planes(sides)
    center = np.array([x, y])
    step = 1e-6 * np.array([np.cos(direction), np.sin(direction)])
    found = [core_for_tests.nearest_on_polygon(*planes, *p) for p in (center, center + step)]
    assume(None not in found)
    heights = [f[2] for f in found]
    assert abs(heights[1] - heights[0]) <= 1e-6 * (1 + 1e-6)
    points = [
        np.array(p) + f[2] * np.array(f[:2])
        for p, f in zip((center, center + step), found, strict=True)
    ]
    assert np.hypot(*(points[1] - points[0])) <= 1e-6 * (1 + 1e-6)


def test_square():
    for center, contact in (
        ((2.5, 0.3), (-1, 0, 1.5, 0)),
        ((0.3, -3), (0, 1, 2, 0)),
        ((4, 5), (-0.6, -0.8, 5, 0.2)),
        ((4, 1), (-1, 0, 3, 1 / 3)),  # where the face ends, the corner
        ((4, -1), (-1, 0, 3, 1 / 3)),  # and at its other end
        ((0.3, 0.9), None),
        ((1, 0), None),  # on the surface
    ):
        found = core_for_tests.nearest_on_polygon(*SQUARE, *center)
        assert found == (contact if contact is None else pytest.approx(contact, rel=1e-15, abs=0))


@given(angle=st.floats(0, 2 * np.pi), length=st.floats(0.01, 3), x=coordinates, y=coordinates)
def test_segment(angle, length, x, y):
    """Two half planes that share a line, and two ends."""
    c, s = np.cos(angle), np.sin(angle)
    planes = [c, -s, -c, s], [s, c, -s, -c], [1 + length, 0.2, -1.0, -0.2]
    along, across = c * x + s * y, -s * x + c * y - 0.2
    assume(abs(across) > 1e-9)
    height, turn = core_for_tests.nearest_on_polygon(*planes, x, y)[2:]
    beyond = max(1 - along, 0.0, along - 1 - length)
    assert height == pytest.approx(np.hypot(beyond, across), rel=1e-12, abs=1e-14)
    assert turn == pytest.approx(0 if beyond < 1e-13 else 1 / height)


def test_center_on_the_line_of_a_segment():
    planes = [1, 0, -1, 0], [0, 1, 0, -1], [1, 0, 1, 0]
    assert core_for_tests.nearest_on_polygon(*planes, 1.25, 0) == (-1, 0, 0.25, 4)
    assert core_for_tests.nearest_on_polygon(*planes, 0.5, 0) is None


def test_edges():
    """Redundant half planes have none, open ones no end."""
    nx, ny, offset = SQUARE
    edges = core.polygon_edges([*nx, 1, 1], [*ny, 0, 1], [*offset, 1.5, 3])
    np.testing.assert_allclose(
        edges[:4], [[1, -1, 1, 1], [1, 1, -1, 1], [-1, 1, -1, -1], [-1, -1, 1, -1]]
    )
    assert np.isnan(edges[4:]).all()
    np.testing.assert_array_equal(
        core.polygon_edges([1, 0], [0, 1], [1, 2]), [[np.nan, np.nan, 1, 2], [1, 2, np.nan, np.nan]]
    )


def test_refusals():
    for planes, message in (
        (([1, -1], [0, 0], [1, -2]), "no point in common"),
        (([1], [0, 1], [1]), "one value for each"),
        (([], [], []), "at least one"),
        (([0], [0], [1]), "both 0"),
    ):
        with pytest.raises(ValueError, match=message):
            core_for_tests.nearest_on_polygon(*planes, 0.0, 0.0)


grid = st.integers(-4, 4)
corner_lists = st.lists(st.tuples(grid, grid), min_size=2, max_size=6)


@given(corners=corner_lists)
def test_planes_of_corners(corners):
    """Those of a convex polygon or segment are refused or enclose it."""
    x, y = np.transpose(corners)
    shape = MultiPoint(corners).convex_hull
    try:
        planes = core.polygon_planes(x, y)
    except ValueError:
        ring = [*corners, corners[0]]
        a, b = np.diff(ring, axis=0), np.diff([*ring[1:], ring[1]], axis=0)
        turns = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        hull = shape.exterior.coords if shape.geom_type == "Polygon" else []
        assert len(hull) != len(ring) or not (np.ptp(np.sign(turns)) == 0 and turns.all())
        return
    assert len(planes) == (4 if len(corners) == 2 else len(corners))
    for a, b in corners:
        assert (planes[:, 0] * a + planes[:, 1] * b <= planes[:, 2] + 1e-9).all()
    edges = core.polygon_edges(*planes.T)
    ends = edges[~np.isnan(edges).any(axis=1)].reshape(-1, 2)
    assert MultiPoint(corners).hausdorff_distance(MultiPoint(ends)) < 1e-9


@given(x=st.floats(-9, 9), y=st.floats(-9, 9))
def test_scene(x, y):
    """Distances by shapely, of the nearest images in a tilted box."""
    corners = [(-0.2, 0), (1, 0.1), (0.5, 0.8)]
    scene = core.Scene(6.0, 5.0, 1.5)
    scene.add_plane(0, -9, 1, 1)
    scene.add_round(0.5, 0.2, 9, True)
    scene.add_round(0.5, 0.2, 0.7, False)
    scene.add_polygon(*np.transpose(corners))
    scene.add_polygon([0, 1], [0.5, 1])
    found = scene.nearest([x, 0.0], [y, 0.1])
    assert found.shape == (10, 4)
    direction, distance = found[::2, :2], found[::2, 2]
    assert np.linalg.norm(direction, axis=1) == pytest.approx(1)
    shifts = [(6 * a + 1.5 * b, 5 * b) for a in range(-4, 5) for b in range(-3, 4)]
    images = [Point(x + a, y + b) for a, b in shifts]
    disk = min(np.hypot(p.x - 0.5, p.y - 0.2) for p in images) - 0.7
    expected = [(x + y + 9) / np.sqrt(2), 9 - np.hypot(x - 0.5, y - 0.2)]
    assert distance[:2] == pytest.approx(expected, abs=1e-12)
    triangle, line = Polygon(corners), LineString([(0, 0.5), (1, 1)])
    exact = [disk, *(min(shape.distance(p) for p in images) for shape in (triangle, line))]
    for true, near in zip(exact, distance[2:], strict=True):
        # beyond half of the box it is not always the nearest image that is taken
        assert near > -0.5
        if 0 < true < 1.3:
            assert near == pytest.approx(true, abs=1e-12)


def test_scene_inside_of_a_polygon():
    scene = core.Scene(0, 0, 0)
    scene.add_polygon([0, 2, 2, 0], [0, 0, 1, 1])
    assert scene.nearest([1.9], [0.5]).tolist() == [pytest.approx([-1, 0, -0.1, 0])]
    with pytest.raises(ValueError, match="one value for each"):
        scene.nearest([1.0], [0.5, 2.0])


def test_middles_have_any_direction():
    scene = core.Scene(0, 0, 0)
    scene.add_round(1, 2, 2.0, True)
    scene.add_round(1, 2, 2.0, False)
    found = scene.nearest([1], [2])
    assert np.linalg.norm(found[:, :2], axis=1) == pytest.approx(1)
    assert found[:, 2].tolist() == [2, -2]
    assert np.isinf(found[:, 3]).all()

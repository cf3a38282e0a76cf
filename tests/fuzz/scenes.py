"""Scenes of walls in Python, right and wrong ones."""

from hypothesis import strategies as st

GOOD = st.floats(-6, 6)
SIZES = st.floats(0.1, 9)
ODD = st.sampled_from([0, -1, 1e-9, 1e9, 1e300, float("nan"), float("inf"), None, "1", [1], True])
# one number in twenty is an odd one
coordinate = st.one_of(*[GOOD] * 19, ODD)
size = st.one_of(*[SIZES] * 19, ODD)
point = st.tuples(coordinate, coordinate)

CENTER = st.tuples(st.floats(-1, 1), st.floats(-1, 1))
rooms = st.one_of(
    st.just([]),
    st.tuples(st.just("Sphere"), st.floats(5, 9), CENTER).map(lambda c: [c]),
    st.tuples(st.just("BoxWall"), st.tuples(*[st.floats(7, 14)] * 2), point).map(lambda r: [r]),
    st.tuples(st.just("channel"), st.floats(7, 14)).map(lambda c: [c]),
    st.lists(st.tuples(st.just("Plane"), point, point), max_size=4),
)
obstacles = st.one_of(
    st.tuples(st.just("obstacle"), size, point),
    st.tuples(st.just("Sphere"), size, point),
    st.tuples(st.just("Segment"), point, point),
    st.tuples(st.just("PolygonWall"), st.lists(point, min_size=2, max_size=5)),
    st.tuples(GOOD, GOOD, st.floats(0.3, 2)).map(
        lambda t: ("PolygonWall", [(t[0], t[1]), (t[0] + t[2], t[1]), (t[0], t[1] + t[2])])
    ),
)
scenes = st.tuples(rooms, st.lists(obstacles, max_size=4)).map(lambda parts: parts[0] + parts[1])

spot = st.tuples(coordinate, coordinate, coordinate)
space_rooms = st.one_of(
    st.just([]),
    st.tuples(st.just("Sphere"), st.floats(4, 9), st.tuples(*[st.floats(-1, 1)] * 3))
    .map(lambda s: [s]),
    st.tuples(st.just("BoxWall"), st.tuples(*[st.floats(5, 12)] * 3), spot).map(lambda c: [c]),
    st.tuples(st.just("Cylinder"), st.floats(3, 9), st.sampled_from("xyzw"), spot)
    .map(lambda c: [c]),
    st.tuples(spot, st.floats(0.3, 3), st.floats(0.2, 1.1), st.floats(5, 12)).map(
        lambda t: [("Cone", (*t[0][:2], -t[1]), "z", t[2]), ("Plane", 0, (0, 0, 1)),
                   ("Plane", (0, 0, t[3]), (0, 0, -1))]),
    st.lists(st.tuples(st.just("Plane"), spot, spot), max_size=4),
)  # fmt: skip
posts = st.one_of(
    st.tuples(st.just("obstacle"), size, spot),
    st.tuples(st.just("post"), size, st.sampled_from("xyzw"), spot),
    st.tuples(st.just("Sphere"), size, spot),
    st.tuples(st.just("Cone"), spot, st.sampled_from(["z", "-z", "x"]), coordinate),
    st.tuples(st.just("Plane"), spot, spot),
    st.tuples(st.just("obstacle"), size, point),
)
space_scenes = st.tuples(space_rooms, st.lists(posts, max_size=3)).map(
    lambda parts: parts[0] + parts[1]
)


def build(ld, parts):
    """The walls of such a scene."""
    walls = []
    for kind, *values in parts:
        if kind == "obstacle":
            walls.append(ld.Sphere(*values, inside=False))
        elif kind == "post":
            walls.append(ld.Cylinder(*values, inside=False))
        elif kind == "channel":
            half = values[0] / 2
            walls += [ld.Plane((0, s * half), (0, -s)) for s in (1, -1)]
        else:
            walls.append(getattr(ld, kind)(*values))
    return walls

"""Outlines of walls: chains of points and triangles, as arrays, in words of LAMMPS, and as STL."""

import struct

import numpy as np

# A cross: concave corners between convex ones.
_ARM = np.array([(-0.5, -1.0), (0.5, -1.0), (0.5, -0.5)])
CROSS = np.concatenate(
    [_ARM @ np.array([(c, s), (-s, c)]) for c, s in [(1, 0), (0, 1), (-1, 0), (0, -1)]]
)


def closed(points):
    """A chain that ends where it begins."""
    return np.concatenate([points, points[:1]])


def box(low, high):
    """Triangles of a cuboid, which face outward."""
    low, high = np.array(low, float), np.array(high, float)
    corner = [np.where([n >> k & 1 for k in range(3)], high, low) for n in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return np.array(
        [[corner[k] for k in face] for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    )


def floor(side, cells, height=lambda x: 0.0 * x[..., 0]):
    """Triangles of a square around 0, in cells along each axis."""
    ends = np.linspace(-0.5 * side, 0.5 * side, cells + 1)
    x = np.stack(np.meshgrid(ends, ends, indexing="ij"), axis=-1)
    points = np.concatenate([x, height(x)[..., None]], axis=-1)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    return np.array([(a, b, c), (a, c, d)]).transpose(2, 3, 0, 1, 4).reshape(-1, 3, 3)


def turned(triangles, seed=0):
    """Half of the triangles face the other way."""
    which = np.random.default_rng(seed).random(len(triangles)) < 0.5
    return np.where(which[:, None, None], triangles[:, ::-1], triangles)


def words(kind, corners):
    """Words of fix deformable/wall."""
    numbers = " ".join(f"{value:.17g}" for value in np.ravel(corners))
    return f"{kind} {len(corners)} {numbers}"


def write_stl(path, triangles, binary):
    """An STL file, whose normals are 0."""
    if binary:
        rows = b"".join(
            struct.pack("<12fH", 0, 0, 0, *np.ravel(triangle), 0) for triangle in triangles
        )
        path.write_bytes(b"solid, but binary".ljust(80) + struct.pack("<I", len(triangles)) + rows)
        return path
    text = ["solid test"]
    for triangle in triangles:
        text += ["facet normal 0 0 0", "outer loop"]
        text += ["vertex {!r} {!r} {!r}".format(*map(float, x)) for x in triangle]
        text += ["endloop", "endfacet"]
    path.write_text("\n".join([*text, "endsolid test", ""]))
    return path

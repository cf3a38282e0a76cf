"""Corners of convex polygons and polyhedra, intersections of half planes or half spaces."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Normals that are nearer to a plane than this part of a radian, and parts of a normal: rounding.
ROUNDING = 1e-12

# Corners count that are outside of other half spaces by this part of the largest offset.
_OUTSIDE = 1e-12


def are_open(normals: Floats) -> bool:
    """Whether half planes or half spaces with these unit normals have no end, shape (n, d)."""
    if normals.shape[1] == 2:
        angles = np.sort(np.arctan2(normals[:, 1], normals[:, 0]))
        widest = np.diff(angles, append=angles[0] + 2.0 * np.pi).max()
        return bool(widest > np.pi - ROUNDING)
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(normals)
    except (QhullError, ValueError):  # all in a plane
        return True
    return bool((hull.equations[:, -1] >= -ROUNDING).any())  # the origin is not within


def corners_of(normals: Floats, offsets: Floats) -> Floats:
    """Corners of the points n x <= offset, shape (m, d); some may be there more than once.

    Args:
        normals: unit vectors, shape (n, d).
        offsets: shape (n,) [length].
    """
    if normals.shape[1] == 2:
        from .. import core

        try:
            edges = core.polygon_edges(normals[:, 0], normals[:, 1], offsets)
        except ValueError:
            return np.empty((0, 2))
        return edges[~np.isnan(edges).any(axis=1)].reshape(-1, 2)
    three = np.array(list(combinations(range(len(normals)), 3)))
    a, b, c = np.moveaxis(normals[three], 1, 0)
    crossed = [np.cross(b, c), np.cross(c, a), np.cross(a, b)]
    volume = np.sum(a * crossed[0], axis=1)
    meet = np.abs(volume) > ROUNDING
    parts = offsets[three].T[..., None] * np.array(crossed)
    points = parts.sum(axis=0)[meet] / volume[meet, None]
    outside = points @ normals.T - offsets
    return points[(outside <= _OUTSIDE * np.abs(offsets).max()).all(axis=1)]

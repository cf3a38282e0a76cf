"""Balls that the planes of their contacts cut, and their surfaces as polygons."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Points on a sphere, and on the rim of a facet.
_POINTS, _RIM = 120, 12

# Points of the sphere are so far from facets, over the radius: no triangles are long and thin.
_MARGIN = 0.02

# What is within a plane, over the radius.
_WITHIN = 1e-9


class Facets(NamedTuple):
    """Planes that cut bodies.

    Attributes:
        i: particle of each, shape (M,).
        normal: out of it, shape (M, 3).
        height: distance from its center, shape (M,) [length].
    """

    i: Integers
    normal: Floats
    height: Floats

    def of_each(self, number: int) -> list[Integers]:
        """Places of the facets of each of so many particles."""
        order = np.argsort(self.i, kind="stable")
        return np.split(order, np.searchsorted(self.i[order], np.arange(1, number)))


# Of bodies that nothing cuts.
WHOLE = Facets(np.empty(0, np.int64), np.empty((0, 3)), np.empty(0))


class Surfaces(NamedTuple):
    """Triangles of spheres and polygons of facets, counterclockwise seen from outside.

    Attributes:
        points: shape (P, 3) [length].
        normals: at the points, out of the sphere or of the facet, shape (P, 3).
        corners: points of all polygons, one polygon after the other, shape (K,).
        ends: where each polygon ends in them, shape (M,).
        body: particle of each polygon, shape (M,).
        facet: place of its facet, -1 on the sphere, shape (M,).
    """

    points: Floats
    normals: Floats
    corners: Integers
    ends: Integers
    body: Integers
    facet: Integers


def surfaces_of(centers: Floats, radius: Floats, facets: Facets) -> Surfaces:
    """The surfaces of bodies, with corners and edges where facets meet.

    Args:
        centers: shape (N, 3) [length].
        radius: shape (N,) [length].
        facets: of all bodies.
    """
    found, count, end = [], 0, 0
    for n, own in enumerate(facets.of_each(len(radius))):
        cut = own[facets.height[own] < radius[n]]
        unit = _unit_surface(facets.normal[cut], facets.height[cut] / radius[n])
        corners, ends, on = count + unit.corners, end + unit.ends, np.append(cut, -1)[unit.facet]
        points = centers[n] + radius[n] * unit.points
        found.append((points, unit.normals, corners, ends, np.full(len(ends), n), on))
        count, end = count + len(points), end + len(corners)
    return Surfaces(*map(np.concatenate, zip(*found, strict=True)))


def _unit_surface(normal: Floats, height: Floats) -> Surfaces:
    """The surface of a cut unit sphere; facets are numbered as the planes.

    It is the convex hull of points on the sphere, on the rims of facets, and where facets meet.
    """
    from scipy.spatial import ConvexHull

    away = _sphere()
    away = away[(away @ normal.T < height - _MARGIN).all(axis=1)]
    edge = np.concatenate([_rims(normal, height), _meetings(normal, height)])
    edge = edge[(edge @ normal.T <= height + _WITHIN).all(axis=1)]
    points = np.concatenate([away, edge])
    triangles = ConvexHull(points).simplices.astype(np.int64)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    inward = np.sum(np.cross(b - a, c - a) * (a - points.mean(axis=0)), axis=1) < 0.0
    triangles[inward] = triangles[inward, ::-1]
    within = (np.abs(points @ normal.T - height) < _WITHIN)[triangles].all(axis=1)
    free = triangles[~within.any(axis=1)]
    plane = [np.full(3 * len(free), -1)]
    faces, polygons = [-1] * len(free), [free.ravel()]
    for k in np.flatnonzero(within.any(axis=0)).tolist():
        own = np.unique(triangles[within[:, k]])
        arm = points[own] - points[own].mean(axis=0)
        turn = np.arctan2(arm @ np.cross(normal[k], arm[0]), arm @ arm[0])
        polygons.append(own[np.argsort(turn)])
        plane.append(np.full(len(own), k))
        faces.append(k)
    corners, on = np.concatenate(polygons), np.concatenate(plane)
    sizes = [3] * len(free) + [len(each) for each in polygons[1:]]
    # a point of several faces is there once for each, with the normal of each
    key, place = np.unique((on + 1) * len(points) + corners, return_inverse=True)
    face, point = np.divmod(key, len(points))
    kept = points[point]
    of_sphere = kept / np.linalg.norm(kept, axis=1)[:, None]
    of_face = np.concatenate([np.zeros((1, 3)), normal])[face]
    normals = np.where(face[:, None] > 0, of_face, of_sphere)
    body = np.zeros(len(faces), np.int64)
    return Surfaces(kept, normals, place.ravel(), np.cumsum(sizes), body, np.array(faces))


def _sphere() -> Floats:
    """Points all over the unit sphere, on a spiral."""
    k = np.arange(_POINTS) + 0.5
    z, turn = 1.0 - 2.0 * k / _POINTS, np.pi * (3.0 - np.sqrt(5.0)) * k
    return np.column_stack([*(np.sqrt(1.0 - z**2) * (np.cos(turn), np.sin(turn))), z])


def _rims(normal: Floats, height: Floats) -> Floats:
    """Points on the circles in which planes cut the unit sphere."""
    least = np.eye(3)[np.abs(normal).argmin(axis=1)]
    u = np.cross(normal, least)
    u /= np.linalg.norm(u, axis=1)[:, None]
    v = np.cross(normal, u)
    turn = np.linspace(0.0, 2.0 * np.pi, _RIM, endpoint=False)[:, None, None]
    radius = np.sqrt(1.0 - height**2)[:, None]
    circles = height[:, None] * normal + radius * (np.cos(turn) * u + np.sin(turn) * v)
    return circles.reshape(-1, 3)


def _meetings(normal: Floats, height: Floats) -> Floats:
    """Where two planes meet on the unit sphere, and where they meet a third one within it."""
    k, j = np.triu_indices(len(height), 1)
    cosine = np.sum(normal[k] * normal[j], axis=1)
    k, j, cosine = (each[np.abs(cosine) < 1.0 - _WITHIN] for each in (k, j, cosine))
    sine2 = 1.0 - cosine**2
    along = np.cross(normal[k], normal[j]) / np.sqrt(sine2)[:, None]
    middle = ((height[k] - cosine * height[j]) / sine2)[:, None] * normal[k]
    middle += ((height[j] - cosine * height[k]) / sine2)[:, None] * normal[j]
    half = np.sqrt(np.maximum(1.0 - np.sum(middle**2, axis=1), 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        third = (height - middle @ normal.T) / (along @ normal.T)
    place = np.column_stack([half, -half, third])
    place[~(np.abs(place) <= half[:, None])] = np.nan
    points = middle[:, None] + place[..., None] * along[:, None]
    return points[(half > 0.0)[:, None] & np.isfinite(place)]

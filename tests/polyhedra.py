"""Directions in space: faces of regular arrangements, and random ones that keep a distance."""

from itertools import product

import numpy as np


def _directions(rows):
    rows = np.array(rows, float)
    return rows / np.linalg.norm(rows, axis=1)[:, None]


_CUBE = np.array(list(product((-1, 0, 1), repeat=3)))
_SQUARE = (_CUBE**2).sum(axis=1)

FACES = {
    "plates": _directions([[0, 0, 1], [0, 0, -1]]),
    "tetrahedron": _directions([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]),
    "sc": _directions(_CUBE[_SQUARE == 1]),
    "bcc": _directions(_CUBE[_SQUARE == 3]),
    "fcc": _directions(_CUBE[_SQUARE == 2]),
}


def random_normals(count, seed, nearest=0.6):
    """So many directions, no two of them nearer than this angle [rad]."""
    rng = np.random.default_rng(seed)
    found = np.zeros((0, 3))
    while len(found) < count:
        (each,) = _directions(rng.normal(size=(1, 3)))
        if not len(found) or (found @ each).max() < np.cos(nearest):
            found = np.vstack([found, each])
    return found

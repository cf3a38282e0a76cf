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

# f of equal contacts at these indentations, and the energy at 0.03 (R = g = 1)
INDENTATIONS = 0.01, 0.03, 0.05, 0.08
FORCES = {
    "plates": (0.0173192690750, 0.0638316107312, 0.1201056823524, 0.2201792235753, 0.0017464265925),
    "tetrahedron": (
        *(0.0224549753126, 0.0902273560520, 0.1815466563809, 0.3657670507215),
        0.0047519750676,
    ),
    "sc": (0.0258224892945, 0.1109428059811, 0.2376108594559, 0.5333168305533, 0.0085071675324),
    "bcc": (0.0280349555285, 0.1262643270858, 0.2838202009083, 0.7000707909527, 0.0126416203626),
    "fcc": (0.0326954481734, 0.1655540289015, 0.4350515729448, None, 0.0235832254998),
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

"""Pairs of disks that are near one another, among all periodic images."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..common.box import cartesian, fractional, lengths, widths
from .containers import closed

if TYPE_CHECKING:
    from .packing import Packing

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def pairs_within(packing: Packing, distance: float) -> tuple[Integers, Integers, Floats]:
    """Pairs of centers that are nearer than a distance, as `near_pairs`, with all images.

    Args:
        packing: gives centers and box, and the directions that walls close.
        distance: [length].
    """
    return near_pairs(packing.replace(radii=0.5 * distance), 0.0)


def near_pairs(packing: Packing, skin: float) -> tuple[Integers, Integers, Floats]:
    """Pairs with d < R_i + R_j + skin, each once, with every image and with images of itself.

    Args:
        packing: gives centers, radii and box; directions that walls close have no images.
        skin: see above [length].

    Returns:
        Numbers i and j of the particles, shape (M,), and the lattice vector that is to be added to
        r_j - r_i, shape (M, d) [length]; sorted by i, j and that vector.
    """
    from scipy.spatial import cKDTree

    box, radius, dimension = packing.box, packing.radii, packing.dimension
    shut = closed(packing.walls, dimension)
    reach = 2.0 * float(radius.max()) + skin
    fractions = fractional(packing.positions, box)
    cell = np.where(shut, 0.0, np.floor(fractions))
    fractions = fractions - cell
    margin = reach / widths(box)
    counts = np.where(shut, 0, np.ceil(margin)).astype(int).tolist()
    images = [(np.arange(len(packing)), np.zeros((len(packing), dimension)))]
    for step in product(*(range(-count, count + 1) for count in counts)):
        if any(step):
            moved = fractions + step
            near = (moved >= -margin) & (moved <= 1.0 + margin)
            inside = (near | shut).all(axis=1)  # walls may be anywhere
            number = np.flatnonzero(inside)
            images.append((number, np.tile(np.array(step, float), (len(number), 1))))
    number = np.concatenate([which for which, _ in images])
    lattice = np.concatenate([steps for _, steps in images])
    tree = cKDTree(cartesian(fractions[number] + lattice, box))
    i, image = np.sort(tree.query_pairs(reach, output_type="ndarray").astype(np.int64), axis=1).T
    j, step = number[image], lattice[image]
    # particles of the box come first; i with an image of j is also j with the opposite image of i
    once = (i < j) | ((i == j) & forward(step))
    once &= i < len(packing)
    i, j, image, step = i[once], j[once], image[once], step[once]
    apart = tree.data[image] - tree.data[i]
    near = lengths(apart) < radius[i] + radius[j] + skin
    i, j, step = i[near], j[near], step[near] + cell[i[near]] - cell[j[near]]
    order = np.lexsort((*step.T[::-1], j, i))
    return i[order], j[order], cartesian(step[order], box)


def forward(steps: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether the first number that is not 0 is above it: one of each image and its opposite.

    Args:
        steps: numbers of lattice vectors, shape (M, d).
    """
    found = np.zeros(len(steps), dtype=bool)
    for step in steps.T[::-1]:
        found = (step > 0) | ((step == 0) & found)
    return found

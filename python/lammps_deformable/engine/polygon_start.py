"""The start of bead polygons: undeformed, separate, within walls; as a LAMMPS data file."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..core import unit_vectors
from ..formats.lammps_data import data_file
from ..model.lattice import cartesian, fractional
from ..model.packing import Packing
from ..model.polygon_walls import Walls
from ..model.polygons import PolygonModel, Polygons


def undeformed(packing: Packing, polygons: Polygons) -> list[NDArray[np.float64]]:
    """Beads of undeformed polygons around the centers of a packing, arrays (N_v, 2)."""
    positions = []
    for center, kind in zip(packing.positions, packing.species, strict=True):
        angle = 2.0 * np.pi * np.arange(polygons.number[kind]) / polygons.number[kind]
        positions.append(center + polygons.radius[kind] * unit_vectors(angle))
    return positions


def _translations(box: NDArray[np.float64]) -> NDArray[np.float64]:
    """The shortest lattice vectors, one of each pair v, -v, shape (4, 2) [length]."""
    (lx, _), (xy, ly) = box.tolist()
    upright = np.array([[lx, 0.0], [xy - lx * np.rint(xy / lx), ly]])  # a cell of the same lattice
    return cartesian(np.array([(1, 0), (-1, 1), (0, 1), (1, 1)]), upright)


def refuse_start(
    packing: Packing,
    positions: list[NDArray[np.float64]],
    model: PolygonModel,
    walls: Walls | None,
) -> None:
    """Refuse polygons that cannot start where they are."""
    if walls is None:
        _refuse_overlap(packing, model)
        refuse_own_image(positions, packing.box, model.radius)
    else:
        _refuse_outside(packing, model, walls)


def _refuse_overlap(packing: Packing, model: PolygonModel) -> None:
    """Refuse polygons that overlap by more than a bead radius: they could stay entangled."""
    steps = _translations(packing.box)
    cell = steps[[0, 2]]
    steps = np.vstack([np.zeros(2), steps, -steps])
    for n, (center, radius) in enumerate(zip(packing.positions, packing.radius, strict=True)):
        apart = packing.positions[n + 1 :] - center
        apart -= cartesian(np.rint(fractional(apart, cell)), cell)
        distance = np.hypot(*np.moveaxis(apart[:, None] + steps, -1, 0)).min(axis=1)
        overlap = packing.radius[n + 1 :] + radius - distance
        if overlap.max(initial=0.0) > model.radius:
            raise ParameterError(
                f"particles {n} and {n + 1 + int(overlap.argmax())} overlap by "
                f"{overlap.max():.3g}, but polygons may overlap by at most the bead radius "
                f"{model.radius:g} at the start: take a packing at jamming"
            )


def refuse_own_image(
    polygons: list[NDArray[np.float64]], box: NDArray[np.float64], radius: float
) -> None:
    """Refuse a polygon that reaches its own periodic image: beads of one polygon do not repel."""
    for step in _translations(box):
        length = np.hypot(*step)
        for n, polygon in enumerate(polygons):
            if np.ptp(polygon @ step) / length + 2.0 * radius > length:
                raise ParameterError(
                    f"particle {n} reaches its own image, {length:.4g} away, but beads of one "
                    "polygon do not repel each other: repeat the packing in that direction"
                )


def _refuse_outside(packing: Packing, model: PolygonModel, walls: Walls) -> None:
    """Refuse a polygon that starts beyond its walls, or beyond the box around them."""
    if len(packing) != 1 or packing.positions.any():
        raise ParameterError("walls must be around a single particle at the origin")
    radius = packing.radius[0]
    if packing.box[1, 0] != 0.0 or not (packing.box.diagonal() > 2.0 * radius).all():
        raise ParameterError(
            f"walls need a rectangular box wider than the particle, {2.0 * radius:g}, not "
            f"{packing.box.tolist()}"
        )
    if walls.height.min() <= radius - model.radius:
        raise ParameterError(
            f"a wall at {walls.height.min():g} cuts through the particle of radius {radius:g}: "
            "start with walls around it, and move them in with confine"
        )


def polygon_file(packing: Packing, polygons: list[NDArray[np.float64]], centered: bool) -> str:
    """LAMMPS data file of bead polygons.

    Args:
        packing: gives the box and the species.
        polygons: positions of the beads of each, arrays (N_v, 2) [length].
        centered: the center of the box is the origin; otherwise its lower left corner is.
    """
    sizes = [len(polygon) for polygon in polygons]
    types = np.repeat(packing.species + 1, sizes)
    ids = np.arange(1, len(types) + 1)
    following = np.concatenate(
        [np.roll(polygon, -1) for polygon in np.split(ids, np.cumsum(sizes)[:-1])]
    )
    (lx, _), (_, ly) = packing.box.tolist()
    return data_file(
        "bead polygons",
        "bond",
        packing.box,
        len(packing.radii),
        [np.repeat(np.arange(1, len(polygons) + 1), sizes), types],
        np.vstack(polygons),
        np.column_stack([types, ids, following]),
        (-0.5 * lx, -0.5 * ly) if centered else (0, 0),
    )

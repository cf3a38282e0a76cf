"""GSD, the files of HOOMD-blue, by its own package. They have single precision.

A file without diameters has the diameter 1 by its schema, and gsd writes none if all of them are 1.
So radii stand in the log of particles too, and what is read has diameters only if the file does.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..common.optional import optional
from .particles import Particles, check_frame
from .universes import in_space

# Name of the radii in the log.
_RADII = "particles/radius"


def write_gsd(
    path: Path,
    box: NDArray[np.float64],
    species: NDArray[np.int64],
    positions: NDArray[np.float64],
    radius: NDArray[np.float64],
    types: int,
) -> None:
    """Write a frame; types are A, B, ... Directions are periodic.

    Args:
        path: of the file.
        box: lattice vectors as rows, those of a packing, shape (d, d) [length].
        species: of the particles, from 0, shape (N,).
        positions: from the lower left corner of the box, shape (N, d) [length].
        radius: of the particles, shape (N,) [length].
        types: number of species.
    """
    hoomd = optional("gsd.hoomd", "gsd")
    dimension = len(box)
    space = np.zeros((3, 3))  # a plane has no height there
    space[:dimension, :dimension] = box
    (lx, *_), (xy, ly, _), (xz, yz, lz) = space.tolist()
    x, y, z = in_space(positions).T
    h = z / lz if lz else z + 0.5  # in the middle
    g = (y - h * yz) / ly
    fractions = np.column_stack([(x - h * xz - g * xy) / lx, g, h])
    image = np.floor(fractions)
    # the box is about the origin, and particles are in it
    f, g, h = (fractions - image - 0.5).T
    frame = hoomd.Frame()
    frame.configuration.dimensions = dimension
    frame.configuration.box = [lx, ly, lz, xy / ly, *((xz / lz, yz / lz) if lz else (0.0, 0.0))]
    particles = frame.particles
    particles.N = len(species)
    particles.position = np.column_stack([lx * f + xy * g + xz * h, ly * g + yz * h, lz * h])
    particles.image = image.astype(np.int32)
    particles.types = [_letters(n) for n in range(types)]
    particles.typeid = species
    particles.diameter = 2.0 * radius
    frame.log[_RADII] = radius
    with hoomd.open(path, "w") as file:
        file.append(frame)


def read_gsd(path: Path, number: int) -> Particles:
    """The particles of a frame.

    Args:
        path: of the file.
        number: of the frame, negative from the end.

    Raises:
        ValueError: there is no such frame.
        RuntimeError, OSError: the file is damaged.
    """
    hoomd = optional("gsd.hoomd", "gsd")
    with hoomd.open(path, "r") as file:
        check_frame(number, len(file))
        frame, places = file[number], {number % len(file), 0}  # defaults are those of the first
        sized = any(file.file.chunk_exists(n, "particles/diameter") for n in places)
    lx, ly, lz, xy, xz, yz = frame.configuration.box.astype(np.float64).tolist()
    box = np.array([[lx, 0.0, 0.0], [xy * ly, ly, 0.0], [xz * lz, yz * lz, lz]])
    particles, count = frame.particles, frame.particles.N
    columns = {
        name: getattr(particles, name) for name in ("diameter",) * sized + ("mass", "charge")
    }
    if _RADII in frame.log:
        columns["radius"] = frame.log[_RADII]
    image = particles.image * [1.0, 1.0, float(frame.configuration.dimensions == 3)]
    return Particles(
        particles.position + image @ box,
        box,
        np.arange(1, count + 1),
        np.array(particles.types)[particles.typeid],
        columns,
        -0.5 * box.sum(axis=0),
        names=particles.types,
        count=len(particles.types),
    )


def _letters(n: int) -> str:
    """A, B, ..., Z, AA, AB, ..."""
    return ("" if n < 26 else _letters(n // 26 - 1)) + chr(ord("A") + n % 26)

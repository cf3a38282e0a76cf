"""GSD, by its own package, in single precision.

A file without diameters has the diameter 1 by its schema, and gsd writes none if all of them are 1.
So radii stand in the log of particles too, and what is read has diameters only if the file does.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..common.box import cartesian, fractional, in_space
from ..common.versions import optional
from ..particles.columns import Floats, Particles, box_of, check_frame, step_of, tilts_of

# Name of the radii in the log.
_RADII = "particles/radius"


def write_gsd(
    path: Path,
    box: Floats,
    species: NDArray[np.int64],
    positions: Floats,
    radius: Floats,
    types: int,
) -> None:
    """Write a frame, with positions from the corner of the box; types are A, B, ..."""
    hoomd = optional("gsd.hoomd", "gsd")
    dimension = len(box)
    space = np.eye(3)
    space[:dimension, :dimension] = box
    fractions = fractional(in_space(positions), space)
    fractions[:, dimension:] = 0.5  # in the middle
    image = np.floor(fractions)
    (lx, ly, lz), (xy, xz, yz) = space.diagonal().tolist(), tilts_of(box)
    frame = hoomd.Frame()
    frame.configuration.dimensions = dimension
    frame.configuration.box = [lx, ly, lz * (dimension == 3), xy / ly, xz / lz, yz / lz]
    particles = frame.particles
    particles.N = len(species)
    particles.position = cartesian(fractions - image - 0.5, space)  # the box is about the origin
    particles.image = image.astype(np.int32)
    particles.types = [_letters(n) for n in range(types)]
    particles.typeid = species
    particles.diameter = 2.0 * radius
    frame.log[_RADII] = radius
    with hoomd.open(path, "w") as file:
        file.append(frame)


def read_gsd(path: Path, number: int) -> Particles:
    hoomd = optional("gsd.hoomd", "gsd")
    with hoomd.open(path, "r") as file:
        check_frame(number, len(file))
        frame, places = file[number], {number % len(file), 0}  # defaults are those of the first
        sized = any(file.file.chunk_exists(n, "particles/diameter") for n in places)
    lx, ly, lz, xy, xz, yz = frame.configuration.box.astype(np.float64).tolist()
    box = box_of([lx, ly, lz], xy * ly, xz * lz, yz * lz)
    particles, count = frame.particles, frame.particles.N
    columns = {
        name: getattr(particles, name) for name in ("diameter",) * sized + ("mass", "charge")
    }
    if _RADII in frame.log:
        columns["radius"] = frame.log[_RADII]
    image = particles.image * [1.0, 1.0, float(frame.configuration.dimensions == 3)]
    return Particles(
        particles.position + cartesian(image, box),
        box,
        np.arange(1, count + 1),
        np.array(particles.types)[particles.typeid],
        columns,
        -0.5 * box.sum(axis=0),
        names=particles.types,
        count=len(particles.types),
        step=step_of(particles.position),
    )


def _letters(n: int) -> str:
    """A, B, ..., Z, AA, AB, ..."""
    return ("" if n < 26 else _letters(n // 26 - 1)) + chr(ord("A") + n % 26)

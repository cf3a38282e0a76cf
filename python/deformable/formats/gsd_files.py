"""GSD, the files of HOOMD-blue, by its own package. They have single precision."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..common.optional import optional
from .particles import Particles, check_frame


def write_gsd(
    path: Path,
    box: NDArray[np.float64],
    species: NDArray[np.int64],
    positions: NDArray[np.float64],
    radius: NDArray[np.float64],
    types: int,
) -> None:
    """Write a frame of a two-dimensional system; types are A, B, ... Directions are periodic.

    Args:
        path: of the file.
        box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length].
        species: of the particles, from 0, shape (N,).
        positions: from the lower left corner of the box, shape (N, 2) [length].
        radius: of the particles, shape (N,) [length].
        types: number of species.
    """
    hoomd = optional("gsd.hoomd", "gsd")
    (lx, _), (xy, ly) = box.tolist()
    g = positions[:, 1] / ly
    fractions = np.column_stack([(positions[:, 0] - g * xy) / lx, g])
    image = np.floor(fractions)
    f, g = (fractions - image - 0.5).T  # the box is about the origin, and particles are in it
    frame = hoomd.Frame()
    frame.configuration.dimensions = 2
    frame.configuration.box = [lx, ly, 0.0, xy / ly, 0.0, 0.0]
    particles = frame.particles
    particles.N = len(species)
    particles.position = np.column_stack([lx * f + xy * g, ly * g, np.zeros(len(species))])
    particles.image = np.column_stack([image, np.zeros(len(species))]).astype(np.int32)
    particles.types = [_letters(n) for n in range(types)]
    particles.typeid = species
    particles.diameter = 2.0 * radius
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
        frame = file[number]
    lx, ly, lz, xy, xz, yz = frame.configuration.box.astype(np.float64).tolist()
    box = np.array([[lx, 0.0, 0.0], [xy * ly, ly, 0.0], [xz * lz, yz * lz, lz]])
    particles, count = frame.particles, frame.particles.N
    image = particles.image * [1.0, 1.0, 0.0]
    return Particles(
        particles.position + image @ box,
        box,
        np.arange(1, count + 1),
        np.array(particles.types)[particles.typeid],
        {name: getattr(particles, name) for name in ("diameter", "mass", "charge")},
        -0.5 * box[:2, :2].sum(axis=0),
        names=particles.types,
        count=len(particles.types),
    )


def _letters(n: int) -> str:
    """A, B, ..., Z, AA, AB, ..."""
    return ("" if n < 26 else _letters(n // 26 - 1)) + chr(ord("A") + n % 26)

"""MDAnalysis, which reads the files of most other programs."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .particles import Particles, as_types, check_frame

if TYPE_CHECKING:
    from MDAnalysis import Universe


def universe_of(
    box: NDArray[np.float64],
    species: NDArray[np.int64],
    positions: NDArray[np.float64],
    radius: NDArray[np.float64],
) -> Universe:
    """A Universe of one frame.

    Args:
        box: lattice vectors as rows, shape (d, d) [length].
        species: of the particles, from 0, shape (N,).
        positions: from the lower left corner of the box, shape (N, d) [length].
        radius: of the particles, shape (N,) [length].
    """
    import MDAnalysis

    number = len(species)
    universe = MDAnalysis.Universe.empty(number, trajectory=True, velocities=True)
    universe.add_TopologyAttr("ids", np.arange(1, number + 1))
    universe.add_TopologyAttr("types", (species + 1).astype(str))
    universe.add_TopologyAttr("radii", radius)
    universe.add_TopologyAttr("masses", np.ones(number))
    frame = universe.trajectory.ts
    frame.dimensions = box_in_space(box)
    frame.positions = in_space(positions)
    return universe


def open_universe(path: Path, topology: Path | int | None) -> Universe:
    """The Universe of a file, with lengths as they are in it, or of a trajectory.

    Args:
        path: of the file.
        topology: file that tells the particles of a trajectory, or their number.

    Raises:
        Exception: whatever MDAnalysis and its readers raise.
    """
    import MDAnalysis

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # masses that are guessed, and the like, are not used
        if isinstance(topology, int):
            return MDAnalysis.Universe.empty(topology).load_new(str(path), convert_units=False)
        files = [path] if topology is None else [topology, path]
        return MDAnalysis.Universe(*map(str, files), convert_units=False)


def read_universe(universe: Universe, number: int, wanted: Sequence[str]) -> Particles:
    """The particles of a frame.

    Args:
        universe: of a file.
        number: of the frame, negative from the end.
        wanted: names of the attributes of atoms that become columns, if there are such.

    Raises:
        ValueError: there is no such frame.
    """
    check_frame(number, len(universe.trajectory))
    frame, atoms = universe.trajectory[number], universe.atoms
    typed = hasattr(atoms, "types")
    types, names = as_types(np.asarray(atoms.types if typed else np.ones(len(atoms))))
    box = None if frame.dimensions is None else frame.triclinic_dimensions.astype(np.float64)
    columns = {name: np.asarray(getattr(atoms, name)) for name in wanted if hasattr(atoms, name)}
    positions = frame.positions.astype(np.float64)
    ids = atoms.indices + 1
    return Particles(positions, box, ids, types, columns, names=names, typed=typed)


def in_space(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors of the plane with z = 0, those of space as they are, shape (N, 3)."""
    return np.column_stack([vectors, np.zeros((len(vectors), 3 - vectors.shape[1]))])


def box_in_space(box: NDArray[np.float64]) -> list[float]:
    """Lengths and angles [degrees] of a box; that of a plane is as high as its longer side."""
    if len(box) == 3:
        from MDAnalysis.lib.mdamath import triclinic_box

        return [float(number) for number in triclinic_box(*box)]
    a, b = np.linalg.norm(box, axis=1).tolist()
    return [a, b, max(a, b), 90.0, 90.0, float(np.degrees(np.arctan2(box[1, 1], box[1, 0])))]

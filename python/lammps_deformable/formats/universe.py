"""What MDAnalysis reads, mostly in single precision, and a Universe of particles.

MDAnalysis takes seconds to load: it is imported where it is used.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..common.box import in_space
from ..common.errors import FileError
from ..particles.columns import Floats, Particles, as_types, check_frame, step_of

if TYPE_CHECKING:
    from MDAnalysis import Universe


def universe_of(
    box: Floats, species: NDArray[np.int64], positions: Floats, radius: Floats
) -> Universe:
    """A Universe of one frame, with positions from the lower left corner of the box."""
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


def box_in_space(box: Floats) -> list[float]:
    """Lengths and angles [degrees] of a box; that of a plane is as high as its longer side."""
    if len(box) == 3:
        from MDAnalysis.lib.mdamath import triclinic_box

        return [float(number) for number in triclinic_box(*box)]
    a, b = np.linalg.norm(box, axis=1).tolist()
    return [a, b, max(a, b), 90.0, 90.0, float(np.degrees(np.arctan2(box[1, 1], box[1, 0])))]


def open_universe(path: Path, topology: Path | int | None) -> Universe:
    """The Universe of a file, with lengths as they are in it; a topology or a number of atoms."""
    import MDAnalysis

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # masses that are guessed, and the like, are not used
            if isinstance(topology, int):
                empty = MDAnalysis.Universe.empty(topology)
                return empty.load_new(str(path), convert_units=False)
            files = [path] if topology is None else [topology, path]
            return MDAnalysis.Universe(*map(str, files), convert_units=False)
    except Exception as error:  # of many readers
        reason = " ".join(str(error).split()) or type(error).__name__
        raise FileError(
            f"'{path}' is no LAMMPS data file, dump, XYZ or GSD, and MDAnalysis cannot read it; "
            "numbers of a table are for Packing(positions, radii, box) (MDAnalysis says: "
            f"{reason[:200]})"
        ) from None


def read_universe(universe: Universe, number: int, wanted: Sequence[str]) -> Particles:
    check_frame(number, len(universe.trajectory))
    frame, atoms = universe.trajectory[number], universe.atoms
    kind = np.asarray(atoms.types) if hasattr(atoms, "types") else None
    box = None if frame.dimensions is None else frame.triclinic_dimensions.astype(np.float64)
    return Particles(
        frame.positions.astype(np.float64),
        box,
        atoms.indices + 1,
        columns={name: np.asarray(getattr(atoms, name)) for name in wanted if hasattr(atoms, name)},
        step=step_of(frame.positions),
        **as_types(kind, len(atoms)),
    )

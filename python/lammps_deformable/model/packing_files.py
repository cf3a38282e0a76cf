"""Packings from arrays and files, and files of packings."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError, UnsavedWarning
from ..common.files import reading, refuse_present
from ..common.validate import expect, numbers, shown
from ..formats.files import read_particles, write_particles
from ..formats.particles import RADII, check_radii
from .lattice import lattice_vectors
from .plane import dimension_of
from .room import closed
from .walls import Wall, as_walls

if TYPE_CHECKING:
    from MDAnalysis import Universe

Floats = NDArray[np.float64]


class _Packing(Protocol):
    """What a packing has."""

    @property
    def positions(self) -> Floats: ...
    @property
    def species(self) -> NDArray[np.int64]: ...
    @property
    def radii(self) -> Floats: ...
    @property
    def box(self) -> Floats: ...
    @property
    def walls(self) -> tuple[Wall, ...]: ...
    @property
    def dimension(self) -> int: ...
    @property
    def radius(self) -> Floats: ...
    @property
    def origin(self) -> Floats: ...


P = TypeVar("P")


class PackingFiles:
    """How a packing comes from arrays and files, and goes to them."""

    @classmethod
    def from_arrays(
        cls: type[P],
        positions: ArrayLike,
        radii: ArrayLike,
        box: ArrayLike,
        species: ArrayLike | None = None,
        walls: Wall | Sequence[Wall] = (),
    ) -> P:
        """A packing of particles whose radii are known one by one.

            Packing.from_arrays(positions, radii, box=(lx, ly))

        Args:
            positions: centers, shape (N, 2), of spheres (N, 3) [length].
            radii: of each particle, shape (N,), or one number for all [length].
            box: as that of a packing, or (lx, ly), or (lx, ly, lz) [length].
            species: of each particle, counted from 0, shape (N,); one species if not given.
            walls: as those of a packing.

        Raises:
            ParameterError: as for a packing.
        """
        places, radius = np.atleast_1d(numbers("positions", positions)), numbers("radii", radii)
        if radius.shape not in ((), places.shape[:1]):
            raise ParameterError(
                f"radii must be one number, or one for each of {len(places)} particles, not "
                f"{radius.shape}"
            )
        kinds = np.zeros(places.shape[:1]) if species is None else numbers("species", species)
        if kinds.shape != places.shape[:1] or (kinds % 1 != 0).any() or (kinds < 0).any():
            raise ParameterError(
                f"species must be {len(places)} whole numbers from 0, not {shown(kinds)}"
            )
        radius = np.broadcast_to(radius, kinds.shape)
        return _of(
            cls, places, radius, lattice_vectors(box), kinds.astype(np.int64), as_walls(walls)
        )

    @classmethod
    def from_file(
        cls: type[P],
        path: str | Path,
        radii: float | str | Mapping[Any, float] | None = None,
        frame: int = -1,
        box: ArrayLike | None = None,
        walls: Wall | Sequence[Wall] = (),
        topology: str | Path | None = None,
        dimension: int = 2,
    ) -> P:
        """The packing in a file of another program, or in one that `to_file` has written.

            Packing.from_file("trajectory.lammpstrj", frame=0)
            Packing.from_file("conf.gro", radii={"A": 0.5, "B": 0.7})

        LAMMPS data files and dumps, extended XYZ and GSD are read with all their digits, all other
        formats by MDAnalysis, in single precision. Particles are in the order of
        their IDs. Species count the types: from 1 if these are numbers, in alphabetical order if
        they are names. Lengths are the numbers of the file, whatever its units: radii, box and
        walls are in the same. (MDAnalysis itself takes those of XTC, TRR and GRO for nanometers,
        and writes a tenth of its own there.) Positions count from the lower left corner of the box,
        or, if walls are given, as in the file. Particles outside of the box are images. Under
        mpiexec one rank may call it, or each.

        Args:
            path: of the file, which must be of one plane if not said else.
            radii: one number [length]; or those of the types, such as `{1: 0.5, 2: 0.7}`; or the
                name of a column or of an attribute of MDAnalysis' atoms. By default what the file
                calls radius, diameter or radii. (HOOMD writes no diameters that are all 1.)
            frame: number of the frame, from 0, or from the end if negative.
            box: in the place of that of the file, as that of a packing, or (lx, ly) [length].
            walls: of the packing; no file has them. A box that is not periodic needs them.
            topology: file of the particles of a trajectory of MDAnalysis that has positions only;
                in any of these formats.
            dimension: 3 for a packing of spheres.

        Raises:
            FileError: the file cannot be read: it is damaged, not of one plane, lacks radii, the
                box or the frame, or has a number that is not finite or an ID twice.
            ParameterError: an argument is out of range.
            ImportError: gsd is missing (`pip install 'lammps-deformable[gsd]'`).
        """
        expect("path", path, str, Path)
        expect("topology", topology, str, Path, type(None))
        expect("radii", radii, float, int, np.number, str, Mapping, type(None))
        check_radii(radii)
        plane = dimension_of(dimension) == 2
        walls, given = as_walls(walls, dimension), None if box is None else lattice_vectors(box)
        wanted = (radii,) if isinstance(radii, str) else RADII
        found = read_particles(
            Path(path), frame, None if topology is None else Path(topology), wanted
        )
        with reading(f"'{path}'"):
            places, radius = found.places(dimension), found.radius(radii)
            shut = closed(walls, dimension)
            if given is None:
                given = found.lattice(dimension)
                container = "rectangle(width, height)" if plane else "cuboid(lx, ly, lz)"
                for axis, periodic, walled in zip("xyz", found.periodic, shut, strict=False):
                    if not (periodic or walled):
                        raise ValueError(
                            f"its box is not periodic along {axis}: give "
                            + f"the walls there, such as walls={container}, or "
                            + f"a periodic box, as box={'(lx, ly)' if plane else '(lx, ly, lz)'}"
                        )
                if not walls:
                    places = places - found.origin[:dimension]
            species = found.species
        return _of(cls, places, radius, given, species, walls, found.count)

    def to_file(self: _Packing, path: str | Path, overwrite: bool = False) -> None:
        """Write the packing for other programs; `from_file` reads it again.

        Positions, radii, species and box come back to the last bit, from GSD in single precision.
        Walls are in none of these files. Particles have mass 1. Under mpiexec one rank calls it.

        Args:
            path: `.data` is a LAMMPS data file of atom_style sphere, `.lammpstrj` or `.dump` a
                LAMMPS dump, `.xyz` or `.extxyz` extended XYZ, `.gsd` a file of HOOMD-blue.
            overwrite: replace a file that is there.

        Raises:
            ParameterError: the suffix is another.
            FileError: there is a file and `overwrite` is not given, or it cannot be written.
            ImportError: gsd is missing (`pip install 'lammps-deformable[gsd]'`).

        Warns:
            UnsavedWarning: the packing has walls.
        """
        expect("path", path, str, Path)
        refuse_present(Path(path), overwrite)
        write_particles(
            Path(path),
            self.box,
            self.species,
            self.positions,
            self.radius,
            len(self.radii),
            self.origin,
            closed(self.walls, self.dimension),
        )
        if self.walls:
            warnings.warn(
                f"'{path}' lacks the walls of the packing: give them to Packing.from_file again",
                UnsavedWarning,
                stacklevel=2,
            )

    def to_mdanalysis(self: _Packing) -> Universe:
        """A Universe of MDAnalysis with one frame.

        Particles have `ids` and `types` (from 1, as in LAMMPS), `radii` and `masses`. MDAnalysis
        has three dimensions: of a plane z is 0, and the box is as high as its longer side, so that
        searches for neighbors find none above. Positions are rounded to 32 bits there, and count
        from the lower left corner of the box, `Packing.origin`. Walls are left out.
        """
        from ..formats.universes import universe_of

        return universe_of(self.box, self.species, self.positions - self.origin, self.radius)


def _of(
    kind: Any,
    positions: Floats,
    radius: Floats,
    box: Floats,
    species: NDArray[np.int64],
    walls: tuple[Wall, ...],
    count: int = 0,
) -> Any:
    """A packing; particles have radii of their own where those of a species differ.

    A species without particles, of so many as are counted, has the largest radius.
    """
    largest = np.zeros(max(count, int(species.max(initial=0)) + 1))
    np.maximum.at(largest, species, radius)
    empty = np.bincount(species, minlength=len(largest)) == 0
    largest[empty] = radius.max(initial=0.0)
    # as many radii as particles would be taken for theirs
    own = bool((radius != largest[species]).any()) or (
        len(largest) == len(species) and bool(empty.any())
    )
    return kind(positions, species, largest, box, radius if own else None, walls)

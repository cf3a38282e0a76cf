"""Packings from arrays and files, and files of packings.

Packings: undeformed disks, or spheres, of any sizes in a periodic box, or between walls.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import room
from ._checks import expect, numbers, positive, shown, whole
from ._files import reading, refuse_present
from .box import dimension_of, fractional, lattice_vectors, refuse_space, shown_box
from .drawing import Scale, limited, per_particle
from .drawing import scale as scale_of
from .errors import ParameterError, UndefinedError, UnsavedWarning
from .files import RADII, check_radii, read_particles, write_particles
from .laws import root, undeformed
from .room import closed
from .versions import optional
from .walls import Wall, as_walls

if TYPE_CHECKING:
    from matplotlib.axes import Axes
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
        from .files import universe_of

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


# Largest packing fraction: far beyond any use, and far below percent.
_DENSEST = 10.0

# Points of a circle.
_POINTS = 60

# Largest distance from the box, in box lengths: LAMMPS brings particles back by one length a step.
_FARTHEST = 1e6


@dataclass(frozen=True, eq=False, repr=False)
class Packing(PackingFiles):
    """Disks in a periodic two-dimensional box, or spheres in a box in space, or between walls.

    Attributes:
        positions: centers, shape (N, 2), of spheres (N, 3) [length].
        species: species of each particle, counted from 0, shape (N,).
        radii: undeformed radius of each species, shape (number of species,) [length]. Those of
            particles make a packing by `Packing.from_arrays`.
        box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length]; (lx, ly) may be
            given for a rectangle. Of spheres ((lx, 0, 0), (xy, ly, 0), (xz, yz, lz)), or
            (lx, ly, lz).
        particle_radii: undeformed radius of each particle, shape (N,) [length], or None: the radius
            of its species. If given, `radii` are the largest radii that a species allows.
        walls: one shape or several: `Plane`, `Circle`, `Disk`, `Segment`, `Polygon`; of spheres
            `Plane`, `Sphere`, `Cylinder`, `Cone`, `Ball`, `Post`. Where a container of planes and
            round walls closes a direction, the box is not periodic and spans it, whatever is given.
            Obstacles repeat with the box.

    Raises:
        ParameterError: shapes disagree, walls have another dimension, a number is not finite, a
            radius or box length is not positive, a species has no radius, as many radii as
            particles are given and some species have none, or a particle is larger than its
            species allows.
    """

    positions: NDArray[np.float64]
    species: NDArray[np.int64]
    radii: NDArray[np.float64]
    box: NDArray[np.float64]
    particle_radii: NDArray[np.float64] | None = None
    walls: tuple[Wall, ...] = ()

    def __post_init__(self) -> None:
        for name in ("positions", "species", "radii", "particle_radii"):
            if name == "particle_radii" and self.particle_radii is None:
                continue
            array: NDArray[np.generic] = numbers(name, getattr(self, name))
            if name == "species":
                if not np.array_equal(array, np.rint(array)):
                    raise ParameterError("species must be whole numbers")
                array = array.astype(np.int64)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        n, shape = self.species.size, self.positions.shape
        if n == 0 or shape not in ((n, 2), (n, 3)) or self.species.shape != (n,):
            raise ParameterError(
                "positions must have shape (N, 2), or (N, 3) in three dimensions, and species (N,) "
                f"with N > 0, not {shape} and {self.species.shape}"
            )
        given = lattice_vectors(self.box)
        if len(given) != self.dimension:
            raise ParameterError(
                f"positions have {self.dimension} columns, so that the box must have as many "
                f"sides, not {len(given)}"
            )
        object.__setattr__(self, "walls", as_walls(self.walls, self.dimension))
        box = room.box_between(self.walls, given)
        object.__setattr__(self, "box", lattice_vectors(box))
        boxes = np.abs(fractional(self.positions, self.box)).max(axis=1)
        if boxes.max() > _FARTHEST:
            far = int(boxes.argmax())
            raise ParameterError(
                f"positions of particle {far}, {self.positions[far].tolist()}, are "
                f"{boxes[far]:.2g} boxes away: move it into the box"
            )
        if self.radii.ndim != 1 or not (self.radii > 0.0).all():
            raise ParameterError(f"radii must be positive, not {self.radii.tolist()}")
        if self.species.min() < 0 or self.species.max() >= len(self.radii):
            raise ParameterError(
                f"species must lie in 0..{len(self.radii) - 1}, the numbers of the radii, "
                f"not {self.species.min()}..{self.species.max()}"
            )
        if self.particle_radii is not None:
            self._check_particle_radii(self.particle_radii)
        elif len(self.radii) == n > 2:  # two particles of one of two species are usual
            self._refuse_unused_radii()

    def _refuse_unused_radii(self) -> None:
        """Refuse as many radii as particles, of which some would be left out."""
        used = np.unique(self.species)
        if len(used) < len(self.radii) and np.ptp(self.radii) > 0.0:
            raise ParameterError(
                f"radii are those of species, and the {len(self.radii)} particles are of "
                f"{len(used)} of them: give radii of particles to Packing.from_arrays(positions, "
                "radii, box, species), or species that all have particles"
            )

    def _check_particle_radii(self, particle_radii: NDArray[np.float64]) -> None:
        if particle_radii.shape != self.species.shape:
            raise ParameterError(
                f"particle_radii must have shape {self.species.shape}, not {particle_radii.shape}"
            )
        most = self.radii[self.species]
        # data files of LAMMPS keep 16 digits
        wrong = np.flatnonzero(~((particle_radii > 0.0) & (particle_radii <= most * (1.0 + 1e-12))))
        if len(wrong) > 0:
            n = int(wrong[0])
            raise ParameterError(
                "particle_radii must be positive and at most the radius of the species, "
                f"{most[n]:g} for particle {n}, not {particle_radii[n]:g}"
            )

    def __len__(self) -> int:
        return len(self.species)

    def __repr__(self) -> str:
        count = f"{len(self)} particles of {len(self.radii)} species"
        return f"<Packing: {count}, phi = {self.phi:.4f}, {shown_box(self.box)}>"

    @property
    def dimension(self) -> int:
        """2 of disks, 3 of spheres."""
        return int(self.positions.shape[1])

    @property
    def radius(self) -> NDArray[np.float64]:
        """Undeformed radius of each particle, shape (N,) [length]."""
        return self.radii[self.species] if self.particle_radii is None else self.particle_radii

    @property
    def area(self) -> float:
        """Area that is free to particles: of the box, or the container, without obstacles."""
        refuse_space("area", self.dimension, "take the volume", attribute=True)
        return self._room

    @property
    def volume(self) -> float:
        """Volume that is free to spheres: of the box, or the container, without obstacles."""
        if self.dimension == 2:
            raise UndefinedError("a packing in the plane has no volume: take the area")
        return self._room

    @cached_property
    def _room(self) -> float:
        return room.free_room(self.walls, self.box)

    @property
    def origin(self) -> NDArray[np.float64]:
        """Lower left corner of the box, (0, 0) but for containers, shape (d,) [length]."""
        return room.bounds(self.walls, self.box)[0]

    @property
    def phi(self) -> float:
        """Packing fraction of the undeformed disks, sum pi R^2 / `area`; overlaps count twice.

        Of spheres it is sum 4 pi R^3 / (3 `volume`).
        """
        return undeformed(self.radius, self.dimension) / self._room

    @property
    def outlines(self) -> list[NDArray[np.float64]]:
        """Circles of the undeformed disks, closed polygons of shape (m, 2) [length]."""
        refuse_space("outlines", self.dimension, "take positions and radius", attribute=True)
        turn = np.linspace(0.0, 2.0 * np.pi, _POINTS)
        circle = np.column_stack([np.cos(turn), np.sin(turn)])
        return list(self.positions[:, None] + self.radius[:, None, None] * circle)

    def plot(
        self,
        ax: Axes | None = None,
        color_by: str | ArrayLike = "radius",
        scale: Scale | None = None,
        cmap: str | None = None,
        vmin: float | None = None,
        vmax: float | None = None,
        title: str | None = None,
        colorbar: bool = True,
        label: str | None = None,
    ) -> Axes:
        """Draw the undeformed disks, box and walls, or spheres; words are those of `State.plot`.

        Args:
            ax: axes to draw into; those of a new figure if not given.
            color_by: `radius`, `species`, or one number for each particle, shape (N,).
            scale: of the colors, to use one for several pictures.
            cmap: name of one of matplotlib's color maps.
            vmin: value of the first color.
            vmax: value of the last color.
            title: of the picture; phi if not given.
            colorbar: draw a bar of the colors.
            label: of the bar; the name of the values if not given.

        Returns:
            The axes, with a figure that pyplot does not know.

        Raises:
            ParameterError: as `State.plot`.
            ImportError: matplotlib is missing (`pip install lammps-deformable[plot]`).
        """
        optional("matplotlib", "plot")
        columns = {"radius": self.radius, "species": self.species}
        found = columns.get(color_by) if isinstance(color_by, str) else color_by
        values = per_particle(color_by, found, len(self), columns)
        expect("scale", scale, Scale, type(None))
        expect("label", label, str, type(None))
        on = scale or scale_of([values], [], color_by)
        if label is None:
            label = color_by if isinstance(color_by, str) else ""
        title = f"$\\phi$ = {self.phi:.4f}" if title is None else title
        on = limited(on, vmin, vmax)
        named: dict[str, Any] = {"cmap": cmap, "colorbar": colorbar}
        if self.dimension == 3:
            from . import plot3d

            return plot3d.draw(self, values, label, title, on, ax, **named)
        from .drawing import draw

        return draw(self, self.outlines, values, label, title, on, ax, **named)

    def at(self, phi: float, grow: bool = False) -> Packing:
        """The packing at another packing fraction.

        Box, centers and walls are scaled by one factor, about the origin of the coordinates.

        Args:
            phi: packing fraction of the undeformed disks.
            grow: scale the radii instead, and keep box, centers and walls.

        Raises:
            ParameterError: phi is not above 0, or above 10.
        """
        factor = root(self.phi / fraction_of(phi), self.dimension)
        if grow:
            own = None if self.particle_radii is None else self.particle_radii / factor
            return replace(self, radii=self.radii / factor, particle_radii=own)
        box = self.box * factor
        walls = room.stretched(self.walls, self.box, box)
        return replace(self, positions=self.positions * factor, box=box, walls=walls)

    def between(self, walls: Wall | Sequence[Wall], seed: int | None = None) -> Packing:
        """The same particles at random places between walls, where they may overlap.

            bidisperse(60).between([Circle((0, 0), 7), Disk((2, 0), 1)])
            bidisperse(200, dimension=3).between(Sphere((0, 0, 0), 8))

        It is a start for `push_off` and `jam`. The walls have the size that is given, so that the
        packing fraction follows from them; `at` scales all to another one.

        Args:
            walls: one shape or several, see `Packing`.
            seed: of numpy's default generator. By default the former positions take its place:
                packings from several seeds have several places between walls too.

        Raises:
            ParameterError: walls leave no room.
        """
        packing = replace(self, walls=as_walls(walls))
        if seed is None:
            rng = np.random.default_rng(
                np.frombuffer(self.positions.astype("<f8").tobytes(), "<u4")
            )
        else:
            rng = generator(seed)
        centers = room.random_places(packing.walls, packing.box, len(self), rng)
        return replace(packing, positions=centers)


def fraction_of(phi: float) -> float:
    """The packing fraction, if it is one."""
    if positive("phi", phi) > _DENSEST:
        raise ParameterError(
            f"phi is a fraction, such as 0.84, and at most {_DENSEST:g}, not {shown(phi)}"
        )
    return float(phi)


def generator(seed: int) -> np.random.Generator:
    seed = whole("seed", seed)
    if seed < 0:
        raise ParameterError(f"seed must not be negative, not {seed}")
    return np.random.default_rng(seed)

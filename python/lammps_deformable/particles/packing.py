"""Packings: undeformed disks, or spheres, in a periodic box or between walls, and their files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.box import (
    cartesian,
    dimension_of,
    fractional,
    lattice_vectors,
    refuse_space,
    shown_box,
)
from ..common.checks import count, expect, numbers, positive, shown, whole
from ..common.errors import FileError, ParameterError, UnsavedWarning, renamed, warn
from ..common.files import at_home, reading, replaces, writing
from ..common.versions import optional
from . import containers
from .columns import RADII, Particles, check_radii
from .containers import closed
from .laws import root, undeformed
from .walls import Plane, Wall, as_walls

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from MDAnalysis import Universe

    from ..pictures.drawing import Scale

Floats = NDArray[np.float64]

# Largest packing fraction: far beyond any use, and far below percent.
_DENSEST = 10.0

# Points of a circle.
_POINTS = 60

# Largest distance from the box, in box lengths: LAMMPS brings particles back by one length a step.
_FARTHEST = 1e6

# Radii at most; powers of them, such as volumes and moments, are numbers still.
_LARGEST = 1e50

# LAMMPS has tables of all pairs of types.
_MOST_SPECIES = 10_000


@dataclass(frozen=True, eq=False, repr=False)
class Packing:
    """Disks in a periodic box in the plane, or spheres in a box in space, or between walls.

        Packing(positions, radii, (lx, ly))
        Packing(positions, 0.5, (lx, ly, lz), walls=Sphere(8))

    Attributes:
        positions: centers, shape (N, 2), of spheres (N, 3) [length].
        radii: undeformed radius of each particle, shape (N,); one number is that of all [length].
        box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length]; (lx, ly) may be
            given for a rectangle. Of spheres ((lx, 0, 0), (xy, ly, 0), (xz, yz, lz)), or
            (lx, ly, lz).
        species: of each particle, counted from 0, shape (N,), all 0 if not given: labels for laws
            with one value for each species. Particles of a species may have different radii.
        periodic: whether the box repeats along each axis; one value is that of all axes. Where it
            is False the sides of the box, at 0 and at its length, become walls.
        walls: one or several: `Plane`, `Sphere`, `BoxWall`, `SurfaceWall`; in the plane `Segment`
            and `PolygonWall`, in space `Cylinder` and `Cone`. Where a container closes a direction,
            the box is not periodic and spans it, whatever is given. Obstacles repeat with the box.
        seed: from which positions were drawn, None if they were not.
        species_radii: largest radius of each species, shape (number of species,) [length].
        own_radii: whether particles have radii of their own in LAMMPS, by atom_style sphere.

    Raises:
        ParameterError: shapes disagree, walls have another dimension, a number is not finite, or a
            radius or box length is not positive.
    """

    positions: Floats
    radii: Floats
    box: Floats
    _: KW_ONLY
    species: NDArray[np.int64] = None  # type: ignore[assignment]
    periodic: tuple[bool, ...] = True  # type: ignore[assignment]
    walls: tuple[Wall, ...] = ()
    seed: int | None = None
    species_radii: Floats = field(init=False)
    own_radii: bool = field(init=False)

    def __post_init__(self) -> None:
        positions, radii = numbers("positions", self.positions), numbers("radii", self.radii)
        number = len(positions) if positions.ndim == 2 else 0
        if number == 0 or positions.shape[1] not in (2, 3):
            raise ParameterError(
                "positions must have shape (N, 2), or (N, 3) in three dimensions, with N > 0, not "
                f"{positions.shape}"
            )
        if radii.shape not in ((), (number,)):
            raise ParameterError(
                f"radii must be one number, or one for each of {number} particles, not "
                f"{radii.shape}"
            )
        if not (radii > 0.0).all():
            raise ParameterError(f"radii must be positive, not {shown(radii[~(radii > 0.0)])}")
        if radii.max() > _LARGEST or radii.min() < 1.0 / _LARGEST:
            raise ParameterError(
                f"radii must be between {1.0 / _LARGEST:g} and {_LARGEST:g}, not "
                f"{radii.min():.3g} to {radii.max():.3g}: choose another unit of length"
            )
        kinds = np.zeros(number) if self.species is None else numbers("species", self.species)
        if kinds.shape != (number,) or (kinds % 1 != 0).any() or (kinds < 0).any():
            raise ParameterError(
                f"species must be {number} whole numbers from 0, not {shown(kinds)}"
            )
        if kinds.max() >= _MOST_SPECIES:
            raise ParameterError(
                f"species must be numbers below {_MOST_SPECIES}, not {kinds.max():.0f}: number "
                "them from 0"
            )
        if self.seed is not None:
            self._set("seed", checked_seed(self.seed))
        self._set("positions", positions)
        self._set("radii", np.array(np.broadcast_to(radii, number)))
        self._set("species", kinds.astype(np.int64))
        given = lattice_vectors(self.box)
        if len(given) != self.dimension:
            raise ParameterError(
                f"positions have {self.dimension} columns, so that the box must have as many "
                f"sides, not {len(given)}"
            )
        self._set("walls", self._all_walls(given))
        self._set("box", lattice_vectors(containers.box_between(self.walls, given)))
        self._set("periodic", tuple(not shut for shut in closed(self.walls, self.dimension)))
        boxes = np.abs(fractional(self.positions, self.box)).max(axis=1)
        if boxes.max() > _FARTHEST:
            far = int(boxes.argmax())
            raise ParameterError(
                f"positions of particle {far}, {self.positions[far].tolist()}, are "
                f"{boxes[far]:.2g} boxes away: move it into the box"
            )
        self._count_species(0)

    def _set(self, name: str, value: Any) -> None:
        if isinstance(value, np.ndarray):
            value.setflags(write=False)
        object.__setattr__(self, name, value)

    def _all_walls(self, box: Floats) -> tuple[Wall, ...]:
        """The walls that are given, and those sides of the box that are not periodic."""
        walls = as_walls(self.walls, self.dimension)
        flags = numbers("periodic", self.periodic)
        if flags.shape not in ((), (self.dimension,)) or not np.isin(flags, (0, 1)).all():
            raise ParameterError(
                f"periodic must be True or False, or {self.dimension} of them, not "
                f"{shown(self.periodic)}"
            )
        shut, sides = closed(walls, self.dimension), []
        for axis, flag in enumerate(np.broadcast_to(flags, self.dimension)):
            if not (flag or shut[axis]):
                unit = np.eye(self.dimension)[axis]
                for end, inward in ((0.0, unit), (box[axis, axis], -unit)):
                    sides.append(Plane(tuple(end * unit), tuple(inward)))
        return (*walls, *sides)

    def _count_species(self, least: int) -> None:
        """Find the largest radius of each species; of one without particles it is that of all.

        Args:
            least: number of species, if some at the end have no particles.
        """
        largest = np.zeros(max(least, int(self.species.max()) + 1))
        np.maximum.at(largest, self.species, self.radii)
        self._set("own_radii", bool((self.radii != largest[self.species]).any()))
        largest[largest == 0.0] = self.radii.max()
        self._set("species_radii", largest)

    @classmethod
    def from_file(
        cls,
        path: str | Path,
        *,
        radii: float | str | Mapping[Any, float] | None = None,
        frame: int = -1,
        box: ArrayLike | None = None,
        walls: Wall | Sequence[Wall] = (),
        topology: str | Path | None = None,
        dimension: int = 2,
    ) -> Packing:
        """The packing in a file of another program, or in one that `export` has written.

            Packing.from_file("trajectory.lammpstrj", frame=0)
            Packing.from_file("conf.gro", radii={"A": 0.5, "B": 0.7})

        LAMMPS data files and dumps, extended XYZ and GSD are read with all their digits, all other
        formats by MDAnalysis, in single precision; those of LAMMPS, XYZ and GSD may be compressed
        by gzip, bzip2 or xz. Particles are in the order of their IDs. Species count the types: from
        1 if these are numbers or a data file has their labels, in alphabetical order if they are
        names. Lengths are the numbers of the file, whatever its units: radii, box and
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
        dimension_of(dimension)
        wanted = (radii,) if isinstance(radii, str) else RADII
        path, topology = at_home(path), topology and at_home(topology)
        from ..formats.particle_files import read_particles

        found = read_particles(path, frame, topology or None, wanted)
        return packing_of_particles(found, path, radii, walls, box, dimension)

    def export(self, path: str | Path, mode: str = "x") -> None:
        """Write the packing for other programs; `from_file` reads it again.

        Positions, radii, species and box come back to the last bit, from GSD in single precision.
        Walls are in none of these files. Particles have mass 1. Under mpiexec one rank calls it.

        Args:
            path: `.data` is a LAMMPS data file of atom_style sphere, `.lammpstrj` or `.dump` a
                LAMMPS dump, `.xyz` or `.extxyz` extended XYZ, `.gsd` a file of HOOMD-blue.
            mode: `x` makes a new file, `w` replaces one that is there.

        Raises:
            ParameterError: the suffix or the mode is another.
            FileError: there is a file and the mode is `x`, or it cannot be written.
            ImportError: gsd is missing (`pip install 'lammps-deformable[gsd]'`).

        Warns:
            UnsavedWarning: the packing has walls.
        """
        expect("path", path, str, Path)
        overwrite, path = replaces(mode), at_home(path)
        with writing(path):  # names may be too long
            there = path.exists()
        if there and not overwrite:
            raise FileError(
                f"'{path}' is there already: replace it by export({str(path)!r}, mode='w'), or "
                "give another name"
            )
        from ..formats.particle_files import write_particles

        write_particles(
            path,
            self.box,
            self.species,
            self.positions,
            self.radii,
            len(self.species_radii),
            self.origin,
            closed(self.walls, self.dimension),
        )
        if self.walls:
            warn(
                f"'{path}' lacks the walls of the packing: give them to Packing.from_file again",
                UnsavedWarning,
            )

    to_file = renamed("to_file", "export")

    def to_mdanalysis(self) -> Universe:
        """A Universe of MDAnalysis with one frame.

        Particles have `ids` and `types` (from 1, as in LAMMPS), `radii` and `masses`. MDAnalysis
        has three dimensions: of a plane z is 0, and the box is as high as its longer side, so that
        searches for neighbors find none above. Positions are rounded to 32 bits there, and count
        from the lower left corner of the box, `Packing.origin`. Walls are left out.
        """
        from ..formats.universe import universe_of

        return universe_of(self.box, self.species, self.positions - self.origin, self.radii)

    def __len__(self) -> int:
        return len(self.species)

    def __repr__(self) -> str:
        kinds = len(self.species_radii)
        drawn = "" if self.seed is None else f", seed {self.seed}"
        return (
            f"<Packing: {len(self)} particles of {kinds} species, phi = {self.phi:.4f}, "
            f"{shown_box(self.box)}{drawn}>"
        )

    @property
    def dimension(self) -> int:
        """2 of disks, 3 of spheres."""
        return int(self.positions.shape[1])

    @cached_property
    def volume(self) -> float:
        """Area, in space volume, that is free: of the box, or the container, without obstacles."""
        return containers.free_room(self.walls, self.box)

    @property
    def origin(self) -> Floats:
        """Lower left corner of the box, (0, 0) but for containers, shape (d,) [length]."""
        return containers.bounds(self.walls, self.box)[0]

    @property
    def phi(self) -> float:
        """Packing fraction of the undeformed disks, sum pi R^2 / `volume`; overlaps count twice.

        Of spheres it is sum 4 pi R^3 / (3 `volume`).
        """
        return undeformed(self.radii, self.dimension) / self.volume

    @property
    def outlines(self) -> list[Floats]:
        """Circles of the undeformed disks, closed polygons of shape (m, 2) [length]."""
        refuse_space("outlines", self.dimension, "take positions and radii", attribute=True)
        turn = np.linspace(0.0, 2.0 * np.pi, _POINTS)
        circle = np.column_stack([np.cos(turn), np.sin(turn)])
        return list(self.positions[:, None] + self.radii[:, None, None] * circle)

    def plot(
        self,
        ax: Axes | None = None,
        *,
        color: str | ArrayLike = "radius",
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
            color: `radius`, `species`, or one number for each particle, shape (N,).
            scale: of the colors, to use one for several pictures.
            cmap: name of one of matplotlib's color maps.
            vmin: value of the first color.
            vmax: value of the last color.
            title: of the picture; none if not given.
            colorbar: draw a bar of the colors.
            label: of the bar; the name of the values if not given.

        Returns:
            The axes, with a figure that pyplot does not know.

        Raises:
            ParameterError: as `State.plot`.
            ImportError: matplotlib is missing (`pip install lammps-deformable[plot]`).
        """
        optional("matplotlib", "plot")
        from ..pictures import drawing, plot3d

        columns = {"radius": self.radii, "species": self.species}
        found = columns.get(color) if isinstance(color, str) else color
        values = drawing.per_particle(color, found, len(self), columns)
        look = drawing.Look(
            color=color,
            scale=scale,
            cmap=cmap,
            vmin=vmin,
            vmax=vmax,
            title=title,
            label=label,
            colorbar=colorbar,
        )
        if self.dimension == 3:
            return plot3d.draw(self, values, look, ax)
        return drawing.draw(self, self.outlines, values, look, ax)

    def replace(self, **changes: Any) -> Packing:
        """The packing with other values of some attributes.

        Args:
            changes: any of `positions`, `radii`, `box`, `species`, `periodic`, `walls`, `seed`.

        Raises:
            ParameterError: as for a packing; or its walls close the box, and another box or
                `periodic` is given without walls.
            TypeError: there is no such attribute.
        """
        kept = {name: getattr(self, name) for name in _ATTRIBUTES}
        if "walls" in changes:
            kept["periodic"] = True
        packing = Packing(**kept | changes)
        if "walls" not in changes:  # those that there are decide where they close the box
            box, periodic = lattice_vectors(kept["box"]), np.array(kept["periodic"])
            box = lattice_vectors(changes.get("box", box))
            periodic = np.array(changes.get("periodic", periodic))
            if not np.allclose(packing.box, box, 1e-9) or np.any(packing.periodic != periodic):
                raise ParameterError(
                    f"box and periodic are those of the {len(self.walls)} walls of this packing, "
                    f"the first a {self.walls[0]._kind}: give `walls` too, () for none"
                )
        if "species" not in changes:
            if "radii" in changes:
                packing._count_species(len(self.species_radii))
            else:
                packing._set("species_radii", self.species_radii)
                packing._set("own_radii", self.own_radii)
        return packing

    def replicate(self, nx: int, ny: int, nz: int = 1) -> Packing:
        """The packing beside images of itself, as LAMMPS' *replicate*: one box after the other.

        Args:
            nx: number of boxes along the first lattice vector.
            ny: along the second one.
            nz: along the third one, in space.

        Raises:
            ParameterError: a number is no count, or is not 1 where there are no images: along z in
                the plane, or along a direction that walls close; or there are obstacles.
        """
        numbers_of = [count(name, n) for name, n in (("nx", nx), ("ny", ny), ("nz", nz))]
        repeats = (*self.periodic, False)[:3]
        for name, n, periodic in zip("xyz", numbers_of, repeats, strict=True):
            if n > 1 and not periodic:
                raise ParameterError(
                    f"there are no images along {name}: n{name} must be 1, not {n}"
                )
        if not all(wall.inside for wall in self.walls):
            raise ParameterError("replicate takes no obstacles: replace the walls first")
        along = numbers_of[: self.dimension]
        steps = np.array(list(product(*map(range, along))), dtype=np.float64)
        places = cartesian(steps, self.box)[:, None] + self.positions
        packing = self.replace(
            positions=places.reshape(-1, self.dimension),
            radii=np.tile(self.radii, len(steps)),
            species=np.tile(self.species, len(steps)),
            box=self.box * np.array(along)[:, None],
        )
        packing._count_species(len(self.species_radii))
        return packing

    def at(self, phi: float, *, grow: bool = False) -> Packing:
        """The packing at another packing fraction.

        Box, centers and walls are scaled by one factor, about the origin of the coordinates.

        Args:
            phi: packing fraction of the undeformed disks.
            grow: scale the radii instead, and keep box, centers and walls.

        Raises:
            ParameterError: phi is not above 0, or above 10.
        """
        factor = root(self.phi / fraction_of(phi), self.dimension)
        expect("grow", grow, bool)
        if grow:
            grown = self.replace(radii=self.radii / factor)
            grown._set("own_radii", self.own_radii)
            grown._set("species_radii", self.species_radii / factor)
            return grown
        box = self.box * factor
        walls = containers.stretched(self.walls, self.box, box)
        return self.replace(positions=self.positions * factor, box=box, walls=walls)

    def between(
        self, walls: Wall | Sequence[Wall], seed: int | np.random.Generator | None = None
    ) -> Packing:
        """The same particles at random places between walls, where they may overlap.

            bidisperse(60).between([Sphere(7), Sphere(1, (2, 0), inside=False)])
            bidisperse(200, dimension=3).between(Sphere(8))

        It is a start for `push_off` and `jam`. The walls have the size that is given, so that the
        packing fraction follows from them; `at` scales all to another one.

        Args:
            walls: one wall or several, see `Packing`.
            seed: as for `bidisperse`. By default the former positions take its place: packings from
                several seeds have several places between walls too.

        Raises:
            ParameterError: walls leave no room.
        """
        packing = self.replace(walls=walls, periodic=True)
        if seed is None:
            rng = np.random.default_rng(
                np.frombuffer(self.positions.astype("<f8").tobytes(), "<u4")
            )
        else:
            rng = np.random.default_rng(drawn_seed(seed))
        centers = containers.random_places(packing.walls, packing.box, len(self), rng)
        return packing.replace(positions=centers)

    def push_off(self) -> Packing:
        """The particles relaxed as soft disks or spheres, in their box, to reduce their overlaps.

        Particles at random positions overlap too deeply for contacts in front of their centers.
        Soft ones have no such limit. The result is a start for `Simulation`, at any packing
        fraction.

        Returns:
            The packing with balanced forces between soft particles.

        Warns:
            StalledWarning: the forces are not balanced.
        """
        from ..engine.push_off import push_off

        return push_off(self)


_ATTRIBUTES = ("positions", "radii", "box", "species", "periodic", "walls", "seed")


def fraction_of(phi: float) -> float:
    """The packing fraction, if it is one."""
    if positive("phi", phi) > _DENSEST:
        raise ParameterError(
            f"phi is a fraction, such as 0.84, and at most {_DENSEST:g}, not {shown(phi)}"
        )
    return float(phi)


def refuse_crushed(packing: Packing) -> None:
    """Raise an error where particles are so large that LAMMPS could not list their neighbors."""
    if packing.phi > _DENSEST:
        raise ParameterError(
            f"phi = {packing.phi:.3g}: particles of the radius {packing.radii.max():g} are far too "
            "large for their box; give radii and box in one unit of length"
        )


def drawn_seed(seed: int | np.random.Generator | None) -> int:
    """The seed, or one that is drawn, by the generator if that is given."""
    if seed is None or isinstance(seed, np.random.Generator):
        return int(np.random.default_rng(seed).integers(2**32))
    return checked_seed(seed)


def checked_seed(seed: int) -> int:
    """The seed, if it is none below 0."""
    if (number := whole("seed", seed)) < 0:
        raise ParameterError(f"seed must not be negative, not {number}")
    return number


def packing_of_species(
    positions: ArrayLike,
    species: ArrayLike,
    species_radii: ArrayLike,
    box: ArrayLike,
    own: ArrayLike | None = None,
    walls: Sequence[Wall] = (),
    seed: int | None = None,
) -> Packing:
    """A packing of species, some of which may have no particles.

    Args:
        positions: as of a packing.
        species: as of a packing.
        species_radii: of each species, at least those of its particles.
        box: as of a packing.
        own: radii of particles, where LAMMPS has such; those of the species if None.
        walls: as of a packing.
        seed: as of a packing.
    """
    largest, kinds = numbers("radii", species_radii), np.asarray(species)
    radii = largest[kinds.astype(np.int64)] if own is None else numbers("radii", own)
    made = Packing(positions, radii, box, species=kinds, walls=walls, seed=seed)  # type: ignore[arg-type]
    made._set("species_radii", largest)
    made._set("own_radii", own is not None)
    return made


def with_own_radii(packing: Packing) -> Packing:
    """The packing whose particles have radii of their own in LAMMPS, which lets them turn."""
    packing = packing.replace()
    packing._set("own_radii", True)
    return packing


def packing_of_particles(
    found: Particles,
    path: str | Path,
    radii: float | str | Mapping[Any, float] | None,
    walls: Wall | Sequence[Wall],
    box: ArrayLike | None,
    dimension: int,
) -> Packing:
    """The packing of particles that were read; see `from_file`."""
    plane = dimension == 2
    walls, given = as_walls(walls, dimension), None if box is None else lattice_vectors(box)
    with reading(f"'{path}'"):
        places, radius = found.places(dimension), found.radius(radii)
        shut = closed(walls, dimension)
        if given is None:
            given = found.lattice(dimension)
            lengths = "(lx, ly)" if plane else "(lx, ly, lz)"
            for axis, periodic, walled in zip("xyz", found.periodic, shut, strict=False):
                if not (periodic or walled):
                    raise ValueError(
                        f"its box is not periodic along {axis}: give "
                        + f"the walls there, such as walls=BoxWall({lengths}), or "
                        + f"a periodic box, as box={lengths}"
                    )
            if not walls:
                places = places - found.origin[:dimension]
        species = found.species
    packing = Packing(places, radius, given, species=species, walls=walls)
    packing._count_species(found.count)
    return packing


def with_species(packing: Packing, number: int, **changes: Any) -> Packing:
    """The packing with other particles, whose species are so many: some may have none left."""
    changed = packing.replace(**changes)
    changed._count_species(number)
    return changed

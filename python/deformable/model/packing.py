"""Packings: undeformed disks of any sizes in a periodic box, or between walls."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError
from ..common.validate import count, finite, numbers, positive, shown, whole
from ..model import room
from .lattice import cartesian, fractional
from .walls import Wall, as_walls

# Largest packing fraction: far beyond any use, and far below percent.
_DENSEST = 10.0

# Largest tilt of a box over its width: LAMMPS loses particles, or hangs, at some more.
_MOST_TILTED = 30.0

# Largest distance from the box, in box lengths: LAMMPS brings particles back by one length a step.
_FARTHEST = 1e6


@dataclass(frozen=True, eq=False, repr=False)
class Packing:
    """Disks in a periodic two-dimensional box, or between walls.

    Attributes:
        positions: centers, shape (N, 2) [length].
        species: species of each particle, counted from 0, shape (N,).
        radii: undeformed radius of each species, shape (number of species,) [length].
        box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length].
        particle_radii: undeformed radius of each particle, shape (N,) [length], or None: the radius
            of its species. If given, `radii` are the largest radii that a species allows.
        walls: one shape or several: `Plane`, `Circle`, `Disk`, `Segment`, `Polygon`. Where a
            container of planes and circles closes a direction, the box is not periodic and spans
            it, whatever is given. Obstacles repeat with the box.

    Raises:
        ParameterError: shapes disagree, a number is not finite, a radius or box length is not
            positive, a species has no radius, or a particle is larger than its species allows.
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
        object.__setattr__(self, "walls", as_walls(self.walls))
        box = room.box_between(self.walls, lattice_vectors(self.box))
        object.__setattr__(self, "box", lattice_vectors(box))
        n = self.species.size
        if n == 0 or self.positions.shape != (n, 2) or self.species.shape != (n,):
            raise ParameterError(
                f"positions must have shape (N, 2) and species (N,) with N > 0, "
                f"not {self.positions.shape} and {self.species.shape}"
            )
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
    def radius(self) -> NDArray[np.float64]:
        """Undeformed radius of each particle, shape (N,) [length]."""
        return self.radii[self.species] if self.particle_radii is None else self.particle_radii

    @cached_property
    def area(self) -> float:
        """Area that is free to particles: of the box, or the container, without obstacles."""
        return room.free_area(self.walls, self.box)

    @property
    def origin(self) -> NDArray[np.float64]:
        """Lower left corner of the box, (0, 0) but for containers, shape (2,) [length]."""
        return room.bounds(self.walls, self.box)[0]

    @property
    def phi(self) -> float:
        """Packing fraction of the undeformed disks, sum pi R^2 / `area`; overlaps count twice."""
        return float(np.pi * np.sum(self.radius**2) / self.area)

    def at(self, phi: float) -> Packing:
        """The packing at another packing fraction.

        Box, centers and walls are scaled by one factor, about the origin of the coordinates.

        Raises:
            ParameterError: phi is not above 0, or above 10.
        """
        factor = np.sqrt(self.phi / _fraction(phi))
        box = self.box * factor
        walls = room.stretched(self.walls, self.box, box)
        return replace(self, positions=self.positions * factor, box=box, walls=walls)

    def between(self, walls: Wall | Sequence[Wall], seed: int | None = None) -> Packing:
        """The same particles at random places between walls, where they may overlap.

            bidisperse(60).between([Circle((0, 0), 7), Disk((2, 0), 1)])

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
            rng = _generator(seed)
        places = room.random_places(packing.walls, packing.box, len(self), rng)
        return replace(packing, positions=places)


def lattice_vectors(box: ArrayLike) -> NDArray[np.float64]:
    """The box, if it is ((lx, 0), (xy, ly)) with finite numbers, lx, ly > 0 and |xy| <= 30 lx."""
    vectors = numbers("box", box)
    if vectors.shape != (2, 2) or vectors[0, 1] != 0.0 or not (vectors.diagonal() > 0.0).all():
        raise ParameterError(
            f"box must be ((lx, 0), (xy, ly)) with lx, ly > 0, not {shown(vectors.tolist())}"
        )
    (lx, _), (xy, _) = vectors.tolist()
    if abs(xy) > _MOST_TILTED * lx:
        raise ParameterError(
            f"box must be tilted by at most {_MOST_TILTED:g} of its widths, not {xy / lx:.3g}: the "
            f"box with xy = {xy - lx * np.rint(xy / lx):.6g} has the same images"
        )
    vectors.setflags(write=False)
    return vectors


def shown_box(box: NDArray[np.float64]) -> str:
    """A box in a few words, for `repr`."""
    (lx, _), (xy, ly) = box.tolist()
    return f"box {lx:.4g} x {ly:.4g}" + (f" tilted by {xy:.4g}" if xy else "")


def bidisperse(
    number: int,
    radii: Sequence[float] | None = None,
    fraction: float = 0.5,
    phi: float = 0.3,
    aspect: float = 1.0,
    tilt: float = 0.0,
    seed: int = 1,
    ratio: float | None = None,
) -> Packing:
    """Disks of two sizes at random positions, which may overlap: the start of `jam`.

    Args:
        number: number of particles N.
        radii: radius of the small (species 0) and the large particles (species 1) [length];
            (0.5, 0.7) if neither these nor a ratio are given.
        fraction: number fraction of large particles, in [0, 1].
        phi: packing fraction, sum pi R^2 / box area, at most 10.
        aspect: height over width of the box, ly / lx.
        tilt: shear of the box, xy / ly; 0 is a rectangle, at most 30 widths.
        seed: seed of numpy's default generator; the same seed gives the same packing anywhere.
        ratio: of the large to the small radius, in place of radii; the small radius is then 0.5.

    Returns:
        The packing; large particles come last.

    Raises:
        ParameterError: a value is out of range.
    """
    number, fraction = count("number", number), finite("fraction", fraction)
    if ratio is not None and radii is not None:
        raise ParameterError(f"give radii or a ratio, not both: {shown(radii)} and {shown(ratio)}")
    if radii is None:
        radii = (0.5, 0.7) if ratio is None else (0.5, 0.5 * positive("ratio", ratio))
    pair = numbers("radii", radii)
    if pair.shape != (2,):
        raise ParameterError(f"radii must be two numbers, not {shown(radii)}")
    if not 0.0 <= fraction <= 1.0:
        raise ParameterError(f"fraction must lie between 0 and 1, not {fraction}")
    positions = _random_positions(number, _generator(seed))
    small, large = (positive("radii", radius) for radius in pair)
    species = (np.arange(number) >= number - round(fraction * number)).astype(np.int64)
    box = _box(np.where(species == 1, large, small), phi, aspect, tilt)
    return Packing(cartesian(positions, box), species, np.array([small, large]), box)


class Distribution(Protocol):
    """A frozen distribution of scipy.stats."""

    def rvs(self, *, size: int, random_state: np.random.Generator) -> Any: ...


def polydisperse(
    number: int,
    radii: ArrayLike | Distribution | Callable[[np.random.Generator], ArrayLike],
    phi: float = 0.3,
    aspect: float = 1.0,
    tilt: float = 0.0,
    seed: int = 1,
) -> Packing:
    """Disks of any sizes at random positions, which may overlap: the start of `jam`.

        polydisperse(64, scipy.stats.lognorm(0.1, scale=0.5))
        polydisperse(64, lambda rng: rng.uniform(0.4, 0.6, 64))

    Args:
        number: number of particles N.
        radii: of all particles, shape (N,) [length]; or a distribution of scipy.stats; or a
            function that draws all of them with a generator of random numbers. Those of a
            distribution are rounded to single precision: the last digits that scipy computes
            depend on the processor.
        phi: packing fraction, sum pi R^2 / box area, at most 10.
        aspect: height over width of the box, ly / lx.
        tilt: shear of the box, xy / ly; 0 is a rectangle.
        seed: seed of numpy's default generator, for the positions and then the radii.

    Returns:
        The packing, of one species; particles are in the order of their radii as given or drawn.

    Raises:
        ParameterError: a value is out of range, e.g. a drawn radius is not positive.
    """
    number, rng = count("number", number), _generator(seed)
    positions = _random_positions(number, rng)
    drawn: Any = radii
    if hasattr(radii, "rvs"):
        drawn = np.float32(radii.rvs(size=number, random_state=rng))
    elif callable(radii):
        drawn = radii(rng)
    particle_radii = numbers("radii", drawn)
    if particle_radii.shape != (number,):
        raise ParameterError(
            f"radii must be {number} numbers, shape ({number},), not {particle_radii.shape}"
        )
    wrong = particle_radii[particle_radii <= 0.0]
    if len(wrong) > 0:
        raise ParameterError(
            f"radii must be positive, but {len(wrong)} of {number} are not, such as {wrong[0]:g}: "
            "take positive numbers only"
        )
    box = _box(particle_radii, phi, aspect, tilt)
    species = np.zeros(number, dtype=np.int64)
    largest = np.array([particle_radii.max()])
    return Packing(cartesian(positions, box), species, largest, box, particle_radii)


def _fraction(phi: float) -> float:
    """The packing fraction, if it is one."""
    if positive("phi", phi) > _DENSEST:
        raise ParameterError(
            f"phi is a fraction, such as 0.84, and at most {_DENSEST:g}, not {shown(phi)}"
        )
    return float(phi)


def _generator(seed: int) -> np.random.Generator:
    seed = whole("seed", seed)
    if seed < 0:
        raise ParameterError(f"seed must not be negative, not {seed}")
    return np.random.default_rng(seed)


def _random_positions(number: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Positions in a unit square, shape (N, 2)."""
    return rng.random((number, 2))


def _box(
    radius: NDArray[np.float64], phi: float, aspect: float, tilt: float
) -> NDArray[np.float64]:
    """Lattice vectors of the box in which disks of these radii have phi, shape (2, 2) [length]."""
    tilt = finite("tilt", tilt)
    area = np.pi * np.sum(radius**2) / _fraction(phi)
    lx = np.sqrt(area / positive("aspect", aspect))
    ly = aspect * lx
    return np.array([[lx, 0.0], [tilt * ly, ly]])

"""Packings to start from: disks or spheres at random places, of two or of any sizes; crystals."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.box import cartesian, dimension_of
from ..common.checks import count, finite, numbers, positive, shown
from ..common.errors import ParameterError
from .laws import root, undeformed
from .packing import Packing, drawn_seed, fraction_of, packing_of_species

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


def bidisperse(
    number: int,
    *,
    sizes: Sequence[float] = (0.5, 0.7),
    fraction_large: float = 0.5,
    phi: float = 0.3,
    dimension: int = 2,
    aspect: float = 1.0,
    tilt: float = 0.0,
    seed: int | np.random.Generator | None = None,
) -> Packing:
    """Disks of two sizes at random positions, which may overlap: the start of `jam`.

        bidisperse(512, sizes=(0.5, 0.6), dimension=3)

    Args:
        number: number of particles N.
        sizes: radius of the small (species 0) and of the large particles (species 1) [length].
        fraction_large: number fraction of large particles, in [0, 1].
        phi: packing fraction, sum pi R^2 / box area, or sum 4 pi R^3 / 3 / box volume, at most 10.
        dimension: 2, or 3 for spheres.
        aspect: height over width of the box, ly / lx; in three dimensions lz / lx, and ly = lx.
        tilt: shear of the box, xy / ly; 0 is a rectangle, at most 30 widths.
        seed: of numpy's default generator; the same seed gives the same packing anywhere. One is
            drawn if not given, or if this is a generator, by it: `Packing.seed` tells which. Each
            rank of an MPI run draws its own.

    Returns:
        The packing; large particles come last.

    Raises:
        ParameterError: a value is out of range.
    """
    number, fraction = count("number", number), finite("fraction_large", fraction_large)
    pair = numbers("sizes", sizes)
    if pair.shape != (2,):
        raise ParameterError(f"sizes must be two numbers, not {shown(sizes)}")
    if not 0.0 <= fraction <= 1.0:
        raise ParameterError(f"fraction_large must lie between 0 and 1, not {fraction}")
    seed = drawn_seed(seed)
    dimension = dimension_of(dimension)
    positions = np.random.default_rng(seed).random((number, dimension))
    small, large = (positive("sizes", radius) for radius in pair)
    species = (np.arange(number) >= number - round(fraction * number)).astype(np.int64)
    box = _box(np.where(species == 1, large, small), phi, aspect, tilt, dimension)
    places = cartesian(positions, box)
    return packing_of_species(places, species, (small, large), box, seed=seed)


class Distribution(Protocol):
    """A frozen distribution of scipy.stats."""

    def rvs(self, *, size: int, random_state: np.random.Generator) -> Any: ...


def polydisperse(
    number: int,
    radii: ArrayLike | Distribution | Callable[[np.random.Generator, int], ArrayLike],
    *,
    phi: float = 0.3,
    dimension: int = 2,
    aspect: float = 1.0,
    tilt: float = 0.0,
    seed: int | np.random.Generator | None = None,
) -> Packing:
    """Disks of any sizes at random positions, which may overlap: the start of `jam`.

        polydisperse(64, scipy.stats.lognorm(0.1, scale=0.5))
        polydisperse(64, lambda rng, n: rng.uniform(0.4, 0.6, n))

    Args:
        number: number of particles N.
        radii: of all particles, shape (N,) [length]; or a distribution of scipy.stats; or a
            function f(rng, N) that draws N of them with a generator of random numbers. Those of a
            distribution are rounded to single precision: the last digits that scipy computes
            depend on the processor.
        phi: as for `bidisperse`.
        dimension: 2, or 3 for spheres.
        aspect: as for `bidisperse`.
        tilt: as for `bidisperse`.
        seed: as for `bidisperse`, for the positions and then the radii.

    Returns:
        The packing, of one species; particles are in the order of their radii as given or drawn.

    Raises:
        ParameterError: a value is out of range, e.g. a drawn radius is not positive.
    """
    number, seed = count("number", number), drawn_seed(seed)
    rng = np.random.default_rng(seed)
    dimension = dimension_of(dimension)
    positions = rng.random((number, dimension))
    drawn: Any = radii
    if hasattr(radii, "rvs"):
        drawn = np.float32(radii.rvs(size=number, random_state=rng))
    elif callable(radii):
        drawn = radii(rng, number)
    own = numbers("radii", drawn)
    if own.shape != (number,):
        raise ParameterError(
            f"radii must be {number} numbers, shape ({number},), not {own.shape}; or a "
            "distribution, such as scipy.stats.norm(1.0, 0.15)"
        )
    wrong = own[own <= 0.0]
    if len(wrong) > 0:
        raise ParameterError(
            f"radii must be positive, but {len(wrong)} of {number} are not, such as {wrong[0]:g}: "
            "take positive numbers only"
        )
    box = _box(own, phi, aspect, tilt, dimension)
    return Packing(cartesian(positions, box), own, box, seed=seed)


def _box(
    radius: NDArray[np.float64], phi: float, aspect: float, tilt: float, dimension: int
) -> NDArray[np.float64]:
    """Lattice vectors of the box in which particles of these radii have phi, shape (d, d)."""
    tilt, aspect = finite("tilt", tilt), positive("aspect", aspect)
    lx = root(undeformed(radius, dimension) / fraction_of(phi) / aspect, dimension)
    box = np.diag([lx] * (dimension - 1) + [aspect * lx])
    box[1, 0] = tilt * box[1, 1]
    return box


# Sides of the rectangular cell, the distance of neighbors in it, and the particles, in parts of the
# sides.
_LATTICES: dict[str, tuple[tuple[float, ...], float, list[tuple[float, ...]]]] = {
    "square": ((1.0, 1.0), 1.0, [(0.0, 0.0)]),
    "hex": ((1.0, 2.0 * math.sqrt(0.75)), 1.0, [(0.0, 0.0), (0.5, 0.5)]),
    "sc": ((1.0, 1.0, 1.0), 1.0, [(0.0, 0.0, 0.0)]),
    "bcc": ((1.0, 1.0, 1.0), math.sqrt(0.75), [(0.0, 0.0, 0.0), (0.5, 0.5, 0.5)]),
    "fcc": (
        (1.0, 1.0, 1.0),
        math.sqrt(0.5),
        [(0.0, 0.0, 0.0), (0.5, 0.5, 0.0), (0.5, 0.0, 0.5), (0.0, 0.5, 0.5)],
    ),
    "hcp": (
        (1.0, 2.0 * math.sqrt(0.75), 2.0 * math.sqrt(2.0 / 3.0)),
        1.0,
        [(0.0, 0.0, 0.0), (0.5, 0.5, 0.0), (0.5, 5.0 / 6.0, 0.5), (0.0, 1.0 / 3.0, 0.5)],
    ),
}


def crystal(
    lattice: str, cells: int | Sequence[int], *, radius: float = 0.5, phi: float | None = None
) -> Packing:
    """Equal particles on a lattice that fits into its periodic box.

        crystal("hex", (16, 8), phi=0.95)
        crystal("fcc", 4, phi=0.8)

    Neighbors touch from the packing fraction pi/sqrt(12) = 0.9069 on in `hex`, pi/4 = 0.7854 in
    `square`; in three dimensions pi/sqrt(18) = 0.7405 in `fcc` and `hcp`, sqrt(3) pi/8 = 0.6802 in
    `bcc`, pi/6 = 0.5236 in `sc`.

    Args:
        lattice: in the plane `hex` (triangular; rows along x, cells of 1 by sqrt(3) diameters with
            2 particles) or `square` (1); in three dimensions `fcc` (4), `bcc` (2), `sc` (1), or
            `hcp` (layers across z, cells of 1 by sqrt(3) by sqrt(8/3) diameters with 4).
        cells: number of rectangular cells along each side of the box, or along each axis.
        radius: of the particles [length].
        phi: packing fraction of the undeformed particles, at most 10; that of particles that touch
            if not given.

    Returns:
        The packing, row by row in the plane, cell by cell in three dimensions.

    Raises:
        ParameterError: a value is out of range, or there is no such lattice.
    """
    if not isinstance(lattice, str) or lattice not in _LATTICES:
        raise ParameterError(f"lattice must be {', '.join(_LATTICES)}, not {shown(lattice)}")
    sides, distance, basis = _LATTICES[lattice]
    dimension, given = len(sides), numbers("cells", cells)
    if given.shape not in ((), (dimension,)):
        raise ParameterError(
            f"cells must be one number, or {dimension} for {lattice}, not {shown(cells)}"
        )
    along = np.array([count("cells", n) for n in np.broadcast_to(given, dimension).tolist()])
    corners = np.stack(np.meshgrid(*map(np.arange, along), indexing="ij"), axis=-1)
    places = (corners.reshape(-1, 1, dimension) + np.array(basis)).reshape(-1, dimension)
    if dimension == 2:
        places = places[np.lexsort(places.T)]  # row by row
    unit = 2.0 * positive("radius", radius) / distance
    box = unit * (np.array(sides) * along)
    touching = Packing(unit * (sides * places), np.full(len(places), radius), box)
    return touching if phi is None else touching.at(phi)

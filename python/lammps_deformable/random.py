"""Disks, or spheres, of two or of any sizes at random places: where `jam` begins."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._checks import count, finite, numbers, positive, shown
from .box import cartesian, dimension_of
from .errors import ParameterError
from .laws import root, undeformed
from .packing import Packing, drawn_seed, fraction_of, generator

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
    seed: int | None = None,
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
            drawn if not given, and `Packing.seed` tells it. Each rank of an MPI run draws its own.

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
    positions = generator(seed).random((number, dimension_of(dimension)))
    small, large = (positive("sizes", radius) for radius in pair)
    species = (np.arange(number) >= number - round(fraction * number)).astype(np.int64)
    box = _box(np.where(species == 1, large, small), phi, aspect, tilt, dimension)
    places = cartesian(positions, box)
    return Packing._of_species(places, species, (small, large), box, seed=seed)


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
    seed: int | None = None,
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
    rng = generator(seed)
    positions = rng.random((number, dimension_of(dimension)))
    drawn: Any = radii
    if hasattr(radii, "rvs"):
        drawn = np.float32(radii.rvs(size=number, random_state=rng))
    elif callable(radii):
        drawn = radii(rng, number)
    own = numbers("radii", drawn)
    if own.shape != (number,):
        raise ParameterError(f"radii must be {number} numbers, shape ({number},), not {own.shape}")
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

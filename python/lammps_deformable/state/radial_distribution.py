"""Functions of the distance of two centers, by freud, between walls too."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.optional import optional
from ..core import unit_vectors
from ..model.distances import Distances
from ..model.lattice import lengths, widths
from ..model.packing import Packing
from ..model.room import bounds

Floats = NDArray[np.float64]

# Random places between walls, each with a random direction: g is right to 1/sqrt of this number.
_PLACES = 40_000


def radial_distribution(
    packing: Packing, freud_system: tuple[Any, Floats], r_max: float, bins: int
) -> tuple[Floats, Floats]:
    """See `State.radial_distribution`.

    Args:
        packing: the centers and walls.
        freud_system: box and points of `State.to_freud`.
        r_max: largest distance [length].
        bins: number of intervals of the distance.
    """
    density = optional("freud", "freud").density
    box, _ = freud_system
    found = _by_distance(density.RDF(bins, r_max), r_max, freud_system)
    r, g = np.array(found.bin_centers), np.array(found.rdf, dtype=np.float64)
    if packing.walls:
        area, inside = _room_around(packing, r)
        g *= area / (box.volume * inside)  # freud's density counts the empty part of its box
    return r, g


def correlation(
    freud_system: tuple[Any, Floats], values: NDArray[np.complex128], r_max: float, bins: int
) -> tuple[Floats, Floats]:
    """Distances r and the mean of conj(a_i) a_j over all pairs at r; nan where there are none.

    Args:
        freud_system: box and points of `State.to_freud`.
        values: a of each particle, shape (N,); pairs with a nan are left out.
        r_max: largest distance [length].
        bins: number of intervals of the distance.
    """
    density = optional("freud", "freud").density
    box, points = freud_system
    known = ~np.isnan(values)
    function = density.CorrelationFunction(bins, r_max)
    found = _by_distance(function, r_max, (box, points[known]), values=values[known])
    mean = np.array(found.correlation).real  # each pair counts in both orders
    return np.array(found.bin_centers), np.where(np.array(found.bin_counts) > 0, mean, np.nan)


def _by_distance(function: Any, r_max: float, system: tuple[Any, Floats], **values: Any) -> Any:
    box, _ = system
    if box.is2D:
        most = min(box.Lx / np.hypot(1.0, box.xy), box.Ly) / 2.0
    else:
        most = float(widths(np.asarray(box.to_matrix()).T).min()) / 2.0
    if r_max >= most:
        raise ParameterError(
            f"r_max = {r_max:g} is too large for the box: it must be below {most:.4g}, half the "
            "distance of opposite sides"
        )
    return function.compute(system, **values)


def _room_around(packing: Packing, r: Floats) -> tuple[float, Floats]:
    """Where centers may be: its area, and the part of circles of radius r about it that is within.

    In space these are a volume and spheres. It begins as far from the walls as the nearest center.
    """
    distances = Distances(packing.walls, packing.box)
    nearest = float(distances(packing.positions)[1].min())
    low, high = bounds(packing.walls, packing.box)
    rng = np.random.default_rng(0)
    tried = low + rng.random((_PLACES, packing.dimension)) * (high - low)

    def free(places: Floats) -> NDArray[np.bool_]:
        return distances(places)[1].min(axis=0) >= nearest

    places = tried[free(tried)]
    if packing.dimension == 2:
        out = unit_vectors(2.0 * np.pi * rng.random(len(places)))
    else:
        out = rng.normal(size=places.shape)
        out /= lengths(out)[:, None]
    inside = np.array([np.mean(free(places + distance * out)) for distance in r])
    return float(np.prod(high - low)) * len(places) / _PLACES, inside

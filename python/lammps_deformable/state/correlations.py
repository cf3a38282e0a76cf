"""Correlations of the centers of a packing: what the methods of a `State` compute.

By freud: functions of the distance of two centers, between walls too. By this module: density waves
and the structure factor.
"""

from __future__ import annotations

import math
from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..common.box import fractional, lengths, widths
from ..common.errors import ParameterError
from ..common.versions import optional
from ..core import unit_vectors
from ..particles.containers import Distances, bounds, closed
from ..particles.neighbors import forward

if TYPE_CHECKING:
    from ..particles.packing import Packing

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


# Farthest from a whole number of periods in the box that a wave may be.
_WHOLE = 1e-6

# Wave vectors whose amplitudes fit into memory.
_WAVES = 10**8

# Phases that are in memory at a time.
_PHASES = 2_000_000


def structure_factor(packing: Packing, k_max: float, bins: int) -> tuple[Floats, Floats]:
    """See `State.structure_factor`."""
    _refuse_container(packing)
    fractions, box = fractional(packing.positions, packing.box), packing.box
    # k = 2 pi (h, m, ..) B^-T, and h = k.a / 2 pi is below k_max |a| / 2 pi
    most = (k_max * lengths(box) / (2.0 * np.pi)).astype(int).tolist()
    # of k and -k, which are one wave, that with h >= 0
    waves = (most[0] + 1) * math.prod(2 * each + 1 for each in most[1:])
    if waves > _WAVES:
        raise ParameterError(
            f"k_max = {k_max:.4g} asks for {waves:.1e} wave vectors of the box: take a smaller one"
        )
    orders = [np.arange(most[0] + 1), *(np.arange(-each, each + 1) for each in most[1:])]
    total = np.zeros((waves // len(orders[-1]), len(orders[-1])), dtype=complex)
    block = max(_PHASES // len(total), 1)
    for first in range(0, len(packing), block):
        places = fractions[first : first + block].T
        phases = [
            np.exp(2.0j * np.pi * np.outer(h, x)) for h, x in zip(orders, places, strict=True)
        ]
        *some, last = phases
        before = reduce(lambda a, b: (a[:, None] * b).reshape(-1, b.shape[1]), some)
        total += before @ last.T
    power = np.abs(total).ravel() ** 2 / len(packing)
    grid = np.stack(np.meshgrid(*orders, indexing="ij"), axis=-1).reshape(-1, len(box))
    k = lengths(2.0 * np.pi * grid @ np.linalg.inv(box).T)
    kept = (k <= k_max) & forward(grid)
    edges = np.linspace(0.0, k_max, bins + 1)
    count, summed = (np.histogram(k[kept], edges, weights=each)[0] for each in (None, power[kept]))
    middle = 0.5 * (edges[1:] + edges[:-1])
    return middle, np.where(count > 0, summed / np.maximum(count, 1), np.nan)


def density_waves(packing: Packing, k: Floats) -> NDArray[np.complex128]:
    """See `State.density_waves`."""
    _refuse_container(packing)
    if k.ndim != 2 or k.shape[1] != packing.dimension:
        raise ParameterError(f"k must have shape (M, {packing.dimension}), not {k.shape}")
    periods = k @ packing.box.T / (2.0 * np.pi)
    off = np.abs(periods - np.rint(periods)).max(axis=1, initial=0.0)
    if off.max(initial=0.0) > _WHOLE:
        n = int(off.argmax())
        nearest = 2.0 * np.pi * np.linalg.solve(packing.box, np.rint(periods[n]))
        raise ParameterError(
            f"k = {k[n].tolist()} is no wave vector of the box: it has {periods[n].tolist()} "
            f"periods along its sides, not whole numbers; the nearest one is {nearest.tolist()}"
        )
    return np.array([np.exp(1.0j * (packing.positions @ wave)).mean() for wave in k])


def _refuse_container(packing: Packing) -> None:
    if any(closed(packing.walls, packing.dimension)):
        raise ParameterError(
            "the structure factor needs a periodic box: a container has no wave vectors of its own"
        )

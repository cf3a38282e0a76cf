"""What is measured of the places in a leg: order, its correlations, defects, and elasticity."""

import math

import freud
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay

from validation.melting.motion import crystal, spacing

BINS = 48  # of the distance, in correlations up to half of the box
SPARED = 5  # correlations are of each fifth sample
SHELLS = 3  # wave vectors of elasticity have up to this many waves in the box


def apart(box, between):
    """Vectors between the nearest images."""
    return between - box * np.rint(between / box)


def neighbors(places, box):
    """Pairs i < j that share a side of their Voronoi cells (Delaunay), with periodic images."""
    places, margin = places % box, 4.0 * math.sqrt(np.prod(box) / len(places))
    shifts = np.array([(x, y) for x in (0, -1, 1) for y in (0, -1, 1)]) * box  # itself first
    images = (places + shifts[:, None]).reshape(-1, 2)
    near = np.flatnonzero(((images > -margin) & (images < box + margin)).all(axis=1))
    corners = near[Delaunay(images[near]).simplices]
    i, j = np.concatenate([corners[:, (0, 1)], corners[:, (1, 2)], corners[:, (2, 0)]]).T
    inside = (i < len(places)) | (j < len(places))
    pairs = np.column_stack([i[inside], j[inside]]) % len(places)
    return np.unique(np.sort(pairs, axis=1), axis=0).T


def defects(pairs, number):
    """Particles without six neighbors, as clusters of neighbors; counts over N.

    A pair of 5 and 7 is a dislocation, two such pairs side by side are bound ones. A cluster whose
    charges, 6 minus the neighbors, do not sum to 0 is a disclination.
    """
    i, j = pairs
    charge = 6 - np.bincount(np.concatenate(pairs), minlength=number)
    wrong = charge[i].astype(bool) & charge[j].astype(bool)
    edges = coo_array((np.ones(wrong.sum()), (i[wrong], j[wrong])), shape=(number, number))
    _, cluster = connected_components(edges, directed=False)
    of = charge != 0
    size = np.bincount(cluster[of], minlength=cluster.max() + 1)
    total = np.bincount(cluster, charge)
    neutral = (total == 0) & (size > 0)
    counts = {
        "defects": of.sum(),
        "dislocations": (neutral & (size == 2)).sum(),
        "bound": (neutral & (size == 4)).sum(),
        "larger": size[neutral & (size != 2) & (size != 4)].sum(),
        "disclinations": (total != 0).sum(),
    }
    return {name: count / number for name, count in counts.items()}


def strongest_wave(places, box, length):
    """Wave vector of about this length with the largest density wave, and that, |rho|^2."""
    most = np.ceil(1.1 * length * box / (2.0 * np.pi)).astype(int)
    m, n = (np.arange(-count, count + 1) for count in most)
    x, y = (np.exp(2j * np.pi * np.outer(c, places[:, d] / box[d])) for d, c in ((0, m), (1, n)))
    waves = np.abs(x @ y.T / len(places)) ** 2
    kx, ky = np.meshgrid(2.0 * np.pi * m / box[0], 2.0 * np.pi * n / box[1], indexing="ij")
    waves[np.abs(np.hypot(kx, ky) / length - 1.0) > 0.1] = 0.0
    best = np.unravel_index(waves.argmax(), waves.shape)
    return np.array([kx[best], ky[best]]), waves[best]


def correlation(places, box, values):
    """Distances up to half of the box, sums of Re conj(a_i) a_j over pairs, numbers of pairs."""
    points = np.column_stack([places % box - 0.5 * box, np.zeros(len(places))])
    found = freud.density.CorrelationFunction(BINS, 0.495 * box.min())
    found.compute(
        (freud.box.Box(*box), points),
        values=values,
        neighbors={"r_max": 0.495 * box.min(), "exclude_ii": True},
    )
    counts = np.array(found.bin_counts)
    return np.array(found.bin_centers), np.array(found.correlation).real * counts, counts


def displacements(places, sites, a):
    """From the nearest sites of the lattice, which drifts with the particles.

    So a row that has slipped by a spacing is back in its lattice.
    """
    lattice = a * np.array([[1.0, 0.0], [0.5, math.sqrt(0.75)]])
    u = (places - sites) @ np.linalg.inv(lattice)  # in lattice vectors
    u -= np.angle(np.exp(2j * np.pi * u).mean(axis=0)) / (2.0 * np.pi)
    near = (u - np.rint(u))[:, None] + [(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)]
    near = near @ lattice
    nearest = np.sum(near**2, axis=2).argmin(axis=1)
    u = near[np.arange(len(u)), nearest]
    return u - u.mean(axis=0)


def waves(box):
    """Wave vectors with up to SHELLS waves in the box, without their opposites."""
    m, n = np.mgrid[-SHELLS : SHELLS + 1, -SHELLS : SHELLS + 1].reshape(2, -1)
    some = ((n > 0) | ((n == 0) & (m > 0))) & (m**2 + n**2 <= SHELLS**2)
    return 2.0 * np.pi * np.column_stack([m, n])[some] / box


def softness(displacements, sites, box):
    """A q^2 |u_q|^2 of transverse and longitudinal waves, with u_q = 1/N sum u exp(-i q r).

    Their means are T over the shear modulus, and T over the sum of bulk and shear modulus.
    """
    q = waves(box)
    u = np.exp(-1j * q @ sites.T) @ displacements / len(sites)
    squares = np.sum(q**2, axis=1)
    along = np.abs(np.sum(q * u, axis=1)) ** 2 / squares
    across = np.sum(np.abs(u) ** 2, axis=1) - along
    return np.prod(box) * np.mean(squares[:, None] * np.column_stack([across, along]), axis=0)


def measured(number, phi, places, order):
    """Means over the samples of a leg, and the series of its order."""
    packing = crystal(number, phi)
    box, sites, a = packing.box.diagonal(), packing.positions, spacing(packing)
    psi = order.mean(axis=1)
    peak = 4.0 * np.pi / (math.sqrt(3.0) * a)
    i, j = neighbors(places[0], box)
    first = apart(box, places[0][j] - places[0][i])
    moved = [apart(box, p[j] - p[i]) - first for p in places]
    rows, curves = [], []
    for n, (at, local) in enumerate(zip(places, order, strict=True)):
        wave, bragg = strongest_wave(at, box, peak)
        across, along = softness(displacements(at, sites, a), sites, box)
        rows.append(
            {"bragg": bragg, "across": across, "along": along} | defects(neighbors(at, box), number)
        )
        if n % SPARED == 0:
            r, six, pairs = correlation(at, box, local)
            curves.append((six, correlation(at, box, np.exp(1j * at @ wave))[1], pairs))
    g6, positional, pairs = np.sum(curves, axis=0)
    return {name: float(np.mean([row[name] for row in rows])) for name in rows[0]} | {
        "psi_x": rounded(psi.real),
        "psi_y": rounded(psi.imag),
        "r": rounded(r),
        "g6": quotient(g6, pairs),
        "positional": quotient(positional, pairs),
        "apart": rounded([np.mean(np.sum(d**2, axis=1)) / (2.0 * a**2) for d in moved]),
    }


def quotient(sums, counts):
    with np.errstate(invalid="ignore"):
        return rounded(sums / counts)


def rounded(values):
    """With five digits; null where there is none."""
    return [float(f"{value:.5g}") if math.isfinite(value) else None for value in values]

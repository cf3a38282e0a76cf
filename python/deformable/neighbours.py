"""Who touches whom: neighbours of each particle, gathered from LAMMPS' own neighbour list.

The list knows ghost atoms, so it is right for any box, small periodic ones included, where a
particle meets several images of another or of itself and minimum images fail.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from . import core

if TYPE_CHECKING:
    from lammps import lammps


@dataclass(frozen=True, eq=False)
class Neighbours:
    """Neighbours within range, each seen from both sides, sorted by (i, j, image).

    Attributes:
        i: particle, shape (M,).
        j: its neighbour, shape (M,).
        image: periodic image of j that is met, in lattice vectors, shape (M, 2).
        angle: direction from i to j, shape (M,) [rad].
        distance: distance of the centres, shape (M,) [length].
        indentation: of i by j, shape (M,) [length]; negative where the circle of i is not reached.
        first: the neighbours of particle i are first[i] to first[i + 1] - 1, shape (N + 1,).
        reverse: where the same pair stands as seen from j, shape (M,).
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64]
    image: NDArray[np.int64]
    angle: NDArray[np.float64]
    distance: NDArray[np.float64]
    indentation: NDArray[np.float64]
    first: NDArray[np.int64]
    reverse: NDArray[np.int64]


def gather_neighbours(
    lmp: lammps,
    comm: MPI.Comm,
    style: str,
    reach: float,
    radius: NDArray[np.float64],
    box: NDArray[np.float64],
) -> Neighbours:
    """Neighbours closer than `reach` (R_i + R_j), the same on every rank.

    Args:
        lmp: LAMMPS after a run or minimisation with the pair style.
        comm: its communicator.
        style: pair style that owns the neighbour list.
        reach: range in units of the sum of radii.
        radius: undeformed radius of each particle, shape (N,) [length].
        box: lattice vectors as rows, shape (2, 2) [length].
    """
    x = lmp.numpy.extract_atom("x")[:, :2]
    tag = lmp.numpy.extract_atom("id")
    listed = list(lmp.numpy.get_neighlist(lmp.find_pair_neighlist(style)))
    here = np.repeat([i for i, _ in listed], [len(others) for _, others in listed]).astype(np.int64)
    there = np.concatenate([others for _, others in listed] or [here]).astype(np.int64)
    # the list has a pair of this rank's particles once, and one with a ghost on either rank
    both = there < lmp.extract_setting("nlocal")
    here, there = np.append(here, there[both]), np.append(there, here[both])
    parts = comm.allgather((tag[here] - 1, tag[there] - 1, x[there] - x[here], x[here]))
    i, j, apart, origin = (np.concatenate(column) for column in zip(*parts, strict=True))
    i, j = i.astype(np.int64), j.astype(np.int64)

    # The image is an exact integer: both ends of a pair agree on it whatever their rounding.
    home = np.zeros((len(radius), 2))
    home[i] = origin
    image = np.rint((home[i] + apart - home[j]) @ np.linalg.inv(box)).astype(np.int64)
    # rounding may put a pair at the very end of the list's range into one end's list only
    seen = np.vstack([np.column_stack([i, j, image]), np.column_stack([j, i, -image])])
    _, which, times = np.unique(seen, axis=0, return_inverse=True, return_counts=True)
    paired = times[which.ravel()[: len(i)]] == 2
    i, j, image, apart = (a[paired] for a in (i, j, image, apart))

    order = np.lexsort((image[:, 1], image[:, 0], j, i))
    i, j, image, apart = (a[order] for a in (i, j, image, apart))
    backward = np.lexsort((-image[:, 1], -image[:, 0], i, j))
    reverse = np.empty_like(backward)
    reverse[backward] = np.arange(len(backward))

    distance = np.hypot(apart[:, 0], apart[:, 1])
    distance = np.minimum(distance, distance[reverse])  # or rounding lets only one end be close
    close = distance <= reach * (radius[i] + radius[j])
    reverse = (np.cumsum(close) - 1)[reverse[close]]
    i, j, image, apart, distance = (a[close] for a in (i, j, image, apart, distance))

    return Neighbours(
        i=i,
        j=j,
        image=image,
        angle=np.arctan2(apart[:, 1], apart[:, 0]),
        distance=distance,
        indentation=core.contact_line(distance, radius[i], radius[j]),
        first=np.searchsorted(i, np.arange(len(radius) + 1)),
        reverse=reverse,
    )

"""What particles did between two states: displacements, local strains and D^2_min.

Periodic images and boxes that changed are taken into account. Where particles come and go they are
followed by their labels, as long as they are there.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.box import cartesian, fractional, nearest_image
from ..common.checks import shown, whole
from ..common.errors import AbsentWarning, JumpWarning, ParameterError, warn
from ..particles.containers import closed
from ..particles.neighbors import pairs_within
from ..particles.packing import Packing

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .state import State

Floats = NDArray[np.float64]

# Steps of this part of the box, beside its strain, tell that others are beyond half of it, where
# the nearest image is another one.
_FAR = 0.4


def packing_of(name: str, given: Any) -> Packing:
    """The packing of a state, or the packing itself."""
    packing = given if isinstance(given, Packing) else getattr(given, "packing", None)
    if not isinstance(packing, Packing):
        raise ParameterError(f"{name} must be a state or a Packing, not {shown(given)}")
    return packing


def affine(before: State | Packing, now: State, points: Floats) -> Floats:
    """Points that follow the box from a state to a later one, shape (n, d) [length].

    Boxes whose tilts differ by their widths have the same images. Of the boxes that are equivalent
    to that of the later state it is the one that its `shear_strain` leads to or, if that is
    None, the one whose tilts are nearest.
    """
    old, new = packing_of("before", before).box, packing_of("now", now).box
    strain = getattr(now, "shear_strain", None)
    added = 0.0 if strain is None else strain - (getattr(before, "shear_strain", None) or 0.0)
    return cartesian(fractional(points, old), _unflipped(old, np.array(new), added))


def _unflipped(old: Floats, box: Floats, added: float) -> Floats:
    """The box that is equivalent to a later one and comes from this one by a shear, shape (d, d).

    Without flips a lattice vector keeps its tilts over its side, but for the shear, which moves it
    along x by the added strain times its part along y.
    """
    for row in range(1, len(box)):
        expected = old[row] * (box[row, row] / old[row, row])
        for axis in reversed(range(row)):
            if axis == 0:
                expected[0] += added * box[row, 1]
            box[row] += np.rint((expected[axis] - box[row, axis]) / box[axis, axis]) * box[axis]
    return box


def _labels(name: str, state: Any) -> NDArray[np.int64]:
    """Their numbers where no particle has come or gone, as in a packing."""
    number, labels = len(packing_of(name, state)), getattr(state, "labels", None)
    return np.arange(number) if labels is None else np.asarray(labels)


def followed(
    before: State | Packing, now: State | Packing
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Numbers before and now of the particles that are there both times.

    Raises:
        ParameterError: the numbers of particles differ, and there are no labels; or one is of the
            plane and the other one of space.

    Warns:
        AbsentWarning: not all are.
    """
    there, here = packing_of("before", before).dimension, packing_of("now", now).dimension
    if there != here:
        raise ParameterError(f"before has {there} dimensions, this state {here}")
    old, new = _labels("before", before), _labels("now", now)
    unknown = all(getattr(state, "labels", None) is None for state in (before, now))
    if unknown and len(old) != len(new):
        raise ParameterError(
            f"before has {len(old)} particles and this state {len(new)}: particles without labels "
            "can only be followed between states with the same ones"
        )
    if isinstance(before, Packing) and getattr(now, "labels", None) is not None:
        raise ParameterError(
            "particles have come or gone, and a Packing does not tell which it has: give the state "
            "before"
        )
    if np.array_equal(old, new):
        return np.arange(len(old)), np.arange(len(new))
    common, i, j = np.intersect1d(old, new, return_indices=True)
    if len(common) < max(len(old), len(new)):
        warn(
            f"{len(common)} particles are followed, which are in both states, of {len(old)} before "
            f"and {len(new)} now",
            AbsentWarning,
        )
    return i, j


def _of_now(number: int, rows: NDArray[np.int64], values: Floats) -> Floats:
    """Values of these particles among so many; nan of others."""
    found = np.full((number, *values.shape[1:]), np.nan)
    found[rows] = values
    return found


def nonaffine(before: State | Packing, now: State) -> Floats:
    """See `State.nonaffine`."""
    i, j = followed(before, now)
    return _of_now(len(packing_of("now", now)), j, _beside(before, now, i, j))


def _beside(
    before: State | Packing, now: State, i: NDArray[np.int64], j: NDArray[np.int64]
) -> Floats:
    """The nonaffine displacements of particles with the numbers i before and j now."""
    old, new = packing_of("before", before), packing_of("now", now)
    shut = closed(new.walls, new.dimension)
    if closed(old.walls, old.dimension) != shut:
        raise ParameterError(
            "before and this state are between other walls, which close other directions"
        )
    moved = new.positions[j] - affine(before, now, old.positions[i])
    return nearest_image(moved, new.box, shut)


def displacements(before: State | Packing, now: State) -> Floats:
    """See `State.displacements`."""
    i, j = followed(before, now)
    start = packing_of("before", before).positions[i]
    moved = affine(before, now, start) - start + _beside(before, now, i, j)
    return _of_now(len(packing_of("now", now)), j, moved)


def unwrapped(states: Iterable[State]) -> Floats:
    """See `Run.unwrapped`."""
    found: list[Floats] = []
    labels: list[NDArray[np.int64]] = []
    former: State | None = None
    farthest, last = 0.0, 0
    for number, state in enumerate(states):
        packing = packing_of("a state", state)
        labels.append(_labels("a state", state))
        known = getattr(state, "labels", None) is not None
        if found and not known and len(packing) != len(found[0]):
            raise ParameterError(
                f"the first state has {len(found[0])} particles and state {number} {len(packing)}: "
                "particles without labels can only be followed between states with the same ones"
            )
        images = getattr(state, "images", None)
        if images is not None:
            found.append(packing.positions + cartesian(images, packing.box))
        elif former is None:
            found.append(packing.positions)
        else:
            # states of soft disks: from one to the next the nearest images
            moved = nonaffine(former, state)
            found.append(affine(former, state, found[-1]) + moved)
            if (far := _part_of_box(moved, packing)) > farthest:
                farthest, last = far, number
        former = state
    if farthest >= _FAR:
        warn(
            f"a particle moves by {farthest:.2g} of the box from state {last - 1} to state {last}, "
            "and one that moves by more than half of it is followed to a wrong image: take states "
            "nearer to each other",
            JumpWarning,
        )
    if not found:
        raise ParameterError("unwrapped positions need at least one state")
    if all(np.array_equal(each, labels[0]) for each in labels):
        return np.array(found)
    every = np.unique(np.concatenate(labels))
    places = np.full((len(found), len(every), found[0].shape[1]), np.nan)
    for place, own, each in zip(places, labels, found, strict=True):
        place[np.searchsorted(every, own)] = each
    always = np.isfinite(places[:, :, 0]).all(axis=0).sum()
    warn(
        f"{always} of {len(every)} particles are in all states: others are nan where they are not",
        AbsentWarning,
    )
    return places


def mean_squared_displacement(
    run: Sequence[Any], lags: Sequence[int] | None
) -> tuple[Floats, Floats]:
    """See `Run.msd`."""
    places, number = unwrapped(run), len(run)
    if isinstance(lags, str) or not isinstance(lags, Iterable | None):
        raise ParameterError(f"lags must be several whole numbers, not {shown(lags)}")
    chosen = range(number // 2 + 1) if lags is None else [whole("a lag", lag) for lag in lags]
    for lag in chosen:
        if not 0 <= lag < number:
            raise ParameterError(
                f"lags must lie between 0 and {number - 1} in a run of {number} states, not {lag}"
            )
    times = np.array([float(getattr(state, "time", 0.0)) for state in run])
    steps = np.diff(times)
    if len(steps) and not np.allclose(steps, steps[0], rtol=1e-6, atol=0.0):
        raise ParameterError(
            "states are not equally far apart in time: take the part of the run where they are"
        )
    # a run that is turned round goes back in time
    step = abs(float(steps.mean())) if len(steps) and steps[0] else 1.0
    means = []
    for lag in chosen:
        squares = np.sum((places[lag:] - places[: number - lag]) ** 2, axis=2)
        there = np.isfinite(squares)
        means.append(np.mean(squares[there]) if there.any() else np.nan)
    return step * np.array(chosen, dtype=np.float64), np.array(means)


def _part_of_box(moved: Floats, packing: Packing) -> float:
    """The largest of these steps, in lengths of the box along x, y and z where it has images."""
    images = ~np.array(closed(packing.walls, packing.dimension))
    parts = np.abs(moved) / packing.box.diagonal()
    return float(parts[:, images].max(initial=0.0))


# Neighbors on a line, or in a plane, do not tell a strain: the determinant of sum v v^T over the
# power of its trace.
_ON_A_LINE = 1e-10


class LocalStrain(NamedTuple):
    """The strain around each particle.

    Attributes:
        gradient: of the displacement, du_a/dx_b, that fits the motion of the neighbors best, shape
            (N, d, d); nan where all neighbors are on one line, or in one plane, and of a particle
            that was not there before.
        d2min: D^2_min, the sum over neighbors of the squared distance from that fit, shape (N,)
            [length^2].
        neighbors: their number, shape (N,).
    """

    gradient: Floats
    d2min: Floats
    neighbors: NDArray[np.int64]

    @property
    def strain(self) -> Floats:
        """Symmetric part of the gradient, without rotation, shape (N, d, d)."""
        return 0.5 * (self.gradient + np.swapaxes(self.gradient, 1, 2))


def local_strain(before: State | Packing, now: State, r_max: float) -> LocalStrain:
    """See `State.local_strain`."""
    start, (old, new) = packing_of("before", before), followed(before, now)
    beside = _of_now(len(start), old, _beside(before, now, old, new))
    i, j, shift = pairs_within(start, r_max)
    both = np.isfinite(beside[i, 0] + beside[j, 0])
    i, j, shift = i[both], j[both], shift[both]
    v = start.positions[j] + shift - start.positions[i]
    w = affine(before, now, v) + beside[j] - beside[i]
    i, v, w = np.concatenate([i, j]), np.concatenate([v, -v]), np.concatenate([w, -w])
    dimension = start.dimension
    total = np.zeros((2, len(start), dimension, dimension))
    np.add.at(total[0], i, v[:, :, None] * v[:, None, :])
    np.add.at(total[1], i, (w - v)[:, :, None] * v[:, None, :])
    within, moved = total
    size = np.trace(within, axis1=1, axis2=2) ** dimension
    flat = np.linalg.det(within) <= _ON_A_LINE * size
    gradient = moved @ np.linalg.inv(np.where(flat[:, None, None], np.eye(dimension), within))
    gradient[flat] = np.nan
    left = w - v - np.einsum("mab,mb->ma", gradient[i], v)
    number = len(start)
    d2min = np.zeros(number)
    np.add.at(d2min, i, np.sum(left**2, axis=1))
    d2min[flat] = np.nan
    size = len(packing_of("now", now))
    neighbors = np.zeros(size, np.int64)
    neighbors[new] = np.bincount(i, minlength=number)[old]
    fit, rest = _of_now(size, new, gradient[old]), _of_now(size, new, d2min[old])
    return LocalStrain(fit, rest, neighbors)


def usual_distance(packing: Packing) -> float:
    """Distance up to which particles are neighbors, 3 times the mean radius [length]."""
    return 3.0 * float(packing.radii.mean())

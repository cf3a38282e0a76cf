"""Secondary contacts: outlines of the sector law that bulge into each other are pressed flat.

The law shapes each particle by its primary contacts, with neighbors whose undeformed circles
overlap its own. Between these contacts the outline bulges, and may overlap the outline of another
particle. Two such arcs then share a contact as two circles do, and the sector law shapes each arc
between its ends.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.checks import whole
from ..common.errors import ParameterError
from ..particles.laws import Sector

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..particles.packing import Packing
    from .state import State

_Array = NDArray[np.float64]
_Contact = tuple[float, float]  # direction and indentation

# The indentation of an arc of radius q and opening phi can be q phi^2/6 at most. Below this opening
# it is less than the rounding of q.
_NARROWEST = np.sqrt(6.0 * np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class SecondaryOutlines:
    """Outlines with the secondary contacts pressed into them.

    Attributes:
        outlines: of each particle, closed polygons of shape (m, 2) [length].
        arcs: of each particle, shape (m, 5): x, y of the arc's center from that of the particle,
            radius [length], directions of the first and the last normal [rad]. Straight contacts
            join them.
        residual: largest overlap of two outlines over the mean undeformed radius, at the start and
            after each iteration, shape (iterations + 1,).
        overlaps: number of places where two outlines overlap, likewise.
        beyond: number of arcs without a positive radius, beyond the model: they do not change, and
            their overlaps do not count above.
    """

    outlines: list[_Array]
    arcs: list[_Array]
    residual: _Array
    overlaps: NDArray[np.int64]
    beyond: int


def resolve_secondary(state: State, iterations: int) -> SecondaryOutlines:
    """See `State.resolve_secondary`."""
    if not (isinstance(state.law, Sector) and state.law._kernel == "sector"):
        raise ParameterError(
            "secondary contacts need the sector law at constant perimeter, Sector(kA=...), not "
            f"{state.law}"
        )
    if whole("iterations", iterations) < 0:
        raise ParameterError(f"iterations must not be negative, not {iterations}")
    radius = state.packing.radii
    contacts = [
        np.column_stack([rows["angle"], rows["indentation"]]) for rows in state._contacts_of_each
    ]
    arcs = [core.sector_arcs(r, *pressed.T) for r, pressed in zip(radius, contacts, strict=True)]
    outlines = list(state.outlines)
    residual, overlaps = np.zeros(iterations + 1), np.zeros(iterations + 1, dtype=np.int64)
    for iteration in range(iterations + 1):
        found, depths = _overlaps(state.packing, arcs)
        residual[iteration] = max(depths, default=0.0) / radius.mean()
        overlaps[iteration] = len(depths)
        if iteration == iterations or not found:
            residual[iteration:], overlaps[iteration:] = residual[iteration], overlaps[iteration]
            break
        for n in {n for n, _ in found}:
            if len(arcs[n]) == 1:  # a circle keeps its contact until it gets another
                contacts[n] = _accepted(radius[n], contacts[n], found[n, 0], closed=True)
                arcs[n] = core.sector_arcs(radius[n], *contacts[n].T)
            else:
                arcs[n] = np.concatenate(
                    [_divided(arc, found.get((n, k), [])) for k, arc in enumerate(arcs[n])]
                )
            if len(arcs[n]) > 1:
                outlines[n] = state.packing.positions[n] + core.arc_outline(arcs[n], same_area=True)
    beyond = sum(int(np.sum(rows[:, 2] <= 0.0)) for rows in arcs)
    return SecondaryOutlines(outlines, arcs, residual, overlaps, beyond)


def _divided(arc: _Array, new: list[_Contact]) -> _Array:
    """The arcs that new contacts make of one."""
    first = arc[3]
    ends = np.column_stack([arc[3:], np.zeros(2)])
    within = [(first + (angle - first) % (2.0 * np.pi), a) for angle, a in new]
    contacts = _accepted(arc[2], ends, within, closed=False)
    if len(contacts) == len(ends):
        return arc[np.newaxis]
    parts = core.sector_arcs(arc[2], contacts[:, 0], contacts[:, 1], closed=False)
    parts[:, :2] += arc[:2]
    return parts


def _accepted(radius: float, contacts: _Array, new: list[_Contact], closed: bool) -> _Array:
    """The contacts with those new ones, deepest first, that leave all arcs a positive radius."""
    for angle, indentation in sorted(new, key=lambda contact: -contact[1]):
        opening = np.remainder(contacts[:, 0] - angle + np.pi, 2.0 * np.pi) - np.pi
        # the line must cross the circle, in front of its center
        if not 0.0 < indentation < radius or (np.abs(opening) < _NARROWEST).any():
            continue
        trial = np.vstack([contacts, (angle, indentation)])
        if (core.sector_arcs(radius, trial[:, 0], trial[:, 1], closed)[:, 2] > 0.0).all():
            contacts = trial
    return contacts


def _overlaps(
    packing: Packing, arcs: list[_Array]
) -> tuple[dict[tuple[int, int], list[_Contact]], list[float]]:
    """The new contacts of each (particle, arc), and the depth of each overlap."""
    found: dict[tuple[int, int], list[_Contact]] = defaultdict(list)
    depths: list[float] = []
    # outlines that were pressed flat touch, up to the rounding of their centers' coordinates
    rounding = 16.0 * np.finfo(float).eps * np.abs(packing.box).sum()
    for i, j, vector in _pairs(packing, arcs):
        own, other = arcs[i][:, np.newaxis], arcs[j] + [*vector, 0.0, 0.0, 0.0]
        dx, dy = np.moveaxis(other[:, :2] - own[..., :2], -1, 0)
        angle, distance = np.arctan2(dy, dx), np.hypot(dx, dy)
        overlap = own[..., 2] + other[:, 2] - distance
        facing = _normal_to(own, angle) & _normal_to(other, angle + np.pi)
        for k, m in np.argwhere(facing & (overlap > rounding)):
            d, theta, q_i, q_j = distance[k, m], angle[k, m], arcs[i][k, 2], arcs[j][m, 2]
            found[i, int(k)].append((theta, core.contact_line(d, q_i, q_j)))
            found[j, int(m)].append((theta + np.pi, core.contact_line(d, q_j, q_i)))
            depths.append(overlap[k, m])
        over = _over_flats(arcs[i], -vector, arcs[j]), _over_flats(arcs[j], vector, arcs[i])
        depths += [depth for depth in np.concatenate(over) if depth > rounding]
    return found, depths


def _normal_to(arcs: _Array, angle: _Array) -> NDArray[np.bool_]:
    """Whether directions are normal to arcs, which must have a positive radius."""
    within = np.remainder(angle - arcs[..., 3], 2.0 * np.pi) < arcs[..., 4] - arcs[..., 3]
    return within & (arcs[..., 2] > 0.0)


def _over_flats(arcs: _Array, center: _Array, other: _Array) -> _Array:
    """How far arcs reach over straight contacts of another particle.

    This happens if only one side of a contact could be pressed flat. `center` is the vector from
    the other particle's center to that of the arcs.
    """
    theta, last = other[:, 4], np.roll(other[:, :2], -1, axis=0)
    normal = np.column_stack([np.cos(theta), np.sin(theta)])
    tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
    vector = arcs[:, np.newaxis, :2] + center - other[:, :2]
    along, height = np.sum(vector * tangent, axis=2), np.sum(vector * normal, axis=2)
    on_flat = (along > 0.0) & (along < np.sum((last - other[:, :2]) * tangent, axis=1))
    in_front = np.sum((center - other[:, :2]) * normal, axis=1) > other[:, 2]
    over = _normal_to(arcs[:, np.newaxis], theta + np.pi) & on_flat & in_front
    return (arcs[:, 2, np.newaxis] + other[:, 2] - height)[over]


def _pairs(packing: Packing, arcs: list[_Array]) -> Iterator[tuple[int, int, _Array]]:
    """Pairs whose circles do not overlap but whose outlines may, and the vector between them.

    Each pair comes once for every periodic image of the second particle that is close enough.
    """
    extent = np.array([np.max(np.hypot(*rows[:, :2].T) + np.abs(rows[:, 2])) for rows in arcs])
    to_fraction = np.linalg.inv(packing.box)
    margin = 2.0 * extent.max() * np.linalg.norm(to_fraction, axis=0)  # around the box, its units
    most = np.ceil(margin).astype(int)
    images = np.array(list(np.ndindex(*(2 * most + 1)))) - most
    inside = (packing.positions @ to_fraction)[:, np.newaxis] + images
    other, which = np.nonzero(((inside > -margin) & (inside < 1.0 + margin)).all(axis=2))
    ghost = packing.positions[other] + images[which] @ packing.box
    half = which > len(images) // 2  # of a particle's own images
    radius = packing.radii
    for i, origin in enumerate(packing.positions):
        vector = ghost - origin
        distance = np.hypot(*vector.T)
        close = (distance > radius[i] + radius[other]) & (distance < extent[i] + extent[other])
        for n in np.flatnonzero(close & ((other > i) | (half & (other == i)))):
            yield i, int(other[n]), vector[n]

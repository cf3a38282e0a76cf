"""What a horizontal plane cuts of a packing in space: a picture in the plane."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from .facets import Facets
from .room import bounds, closed
from .sections import section_between
from .walls import Wall

Floats = NDArray[np.float64]

# Corners of a circle.
_POINTS = 90

# Corners nearer to the line of a facet than this part of the radius are on it.
_ON = 1e-9


class Packing(Protocol):
    """What a section is of."""

    @property
    def positions(self) -> Floats: ...
    @property
    def radius(self) -> Floats: ...
    @property
    def box(self) -> Floats: ...
    @property
    def walls(self) -> tuple[Wall, ...]: ...


class Section(NamedTuple):
    """Particles that a plane cuts, each image of its own; a packing for pictures.

    Attributes:
        particle: number of each, shape (M,).
        positions: of the middles of their circles, shape (M, 2) [length].
        outlines: of each, shape (m, 2) [length].
        contacts: lines of facets of each, shape (2, 2) [length].
        box: lattice vectors in the plane, shape (2, 2) [length].
        walls: those that the plane cuts, as walls in the plane.
    """

    particle: NDArray[np.int64]
    positions: Floats
    outlines: list[Floats]
    contacts: list[list[Floats]]
    box: Floats
    walls: tuple[Wall, ...] = ()


def section_of(packing: Packing, facets: Facets, height: float) -> Section:
    """The section of all particles and their images with the plane z = height [length].

    Raises:
        ParameterError: the plane is outside of the walls.
    """
    x, radius, up = packing.positions, packing.radius, packing.box[2]
    walls = section_between(packing.walls, packing.box, height)
    if walls is None:
        low, high = bounds(packing.walls, packing.box)[:, 2]
        raise ParameterError(
            f"the slice at {height:g} is outside of the walls: take one from {low:g} to {high:g}"
        )
    shut = closed(packing.walls, 3)[2]
    first = np.ceil((height - radius - x[:, 2]) / up[2]).astype(int)
    last = np.floor((height + radius - x[:, 2]) / up[2]).astype(int)
    turn = np.linspace(0.0, 2.0 * np.pi, _POINTS, endpoint=False)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    particle, middles, outlines, contacts = [], [], [], []
    for n, own in enumerate(facets.of_each(len(radius))):
        for image in (0,) if shut else range(first[n], last[n] + 1):
            center = x[n] + image * up
            above, middle = height - center[2], center[:2]
            if abs(above) >= radius[n]:
                continue
            outline = np.sqrt(radius[n] ** 2 - above**2) * circle
            lines = list(facets.normal[own, :2])
            levels = (facets.height[own] - facets.normal[own, 2] * above).tolist()
            for normal, level in zip(lines, levels, strict=True):
                outline = _clipped(outline, normal, level)
            if len(outline) < 3:
                continue
            on = [
                np.abs(outline @ normal - level) < _ON * radius[n]
                for normal, level in zip(lines, levels, strict=True)
            ]
            particle.append(n)
            middles.append(middle)
            outlines.append(middle + outline)
            contacts.append([middle + outline[each] for each in on if each.sum() == 2])
    return Section(
        np.array(particle, np.int64),
        np.reshape(middles, (-1, 2)),
        outlines,
        contacts,
        packing.box[:2, :2],
        tuple(walls),
    )


def _clipped(polygon: Floats, normal: Floats, level: float) -> Floats:
    """The part of a convex polygon in n x <= level."""
    beyond = polygon @ normal - level
    if (beyond <= 0.0).all():
        return polygon
    after, then = np.roll(polygon, -1, axis=0), np.roll(beyond, -1)
    cut = (beyond > 0.0) != (then > 0.0)
    part = (beyond / np.where(cut, beyond - then, 1.0))[:, None]
    both = np.stack([polygon, polygon + part * (after - polygon)], axis=1)
    return both[np.column_stack([beyond <= 0.0, cut])]

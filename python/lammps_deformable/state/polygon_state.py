"""A state of bead polygons: a snapshot, which later steps do not change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core import angles
from ..model.filled import filled_area
from ..model.packing import Packing
from ..model.polygons import PolygonModel, Polygons
from .stressed import Stressed


@dataclass(frozen=True, eq=False, repr=False)
class PolygonContacts:
    """Pairs of polygons in contact, each pair once.

    Attributes:
        i: number of a polygon, shape (M,).
        j: number of the other polygon, larger than i, shape (M,).
        image: periodic image of j in the contact, in lattice vectors, shape (M, 2).
        force: on i, shape (M, 2) [energy/length].
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64]
    image: NDArray[np.int64]
    force: NDArray[np.float64]


def sum_contacts(
    beads: NDArray[np.float64],
    first: NDArray[np.int64],
    pairs: NDArray[np.int64],
    overlaps: NDArray[np.float64],
    box: NDArray[np.float64],
) -> PolygonContacts:
    """Sum the forces of touching beads, or of vertices and edges, by pairs of polygons.

    Args:
        beads: positions in all polygons, each polygon unwrapped, shape (number of beads, 2)
            [length].
        first: the beads of polygon m are first[m] to first[m + 1] - 1, shape (N + 1,).
        pairs: numbers, from 0, of two beads that overlap, or of a vertex and the first vertex of
            an edge, shape (K, 2).
        overlaps: vector from the second to the first bead and force on the first, shape (K, 4).
        box: lattice vectors as rows, shape (2, 2) [length].
    """
    a, b = pairs.T
    # an exact integer, equal for all beads of a contact in spite of rounding
    image = np.rint((beads[a] - overlaps[:, :2] - beads[b]) @ np.linalg.inv(box)).astype(np.int64)
    i, j = (np.searchsorted(first, bead, side="right") - 1 for bead in (a, b))
    sign = np.where(i > j, -1, 1)[:, None]  # each pair of polygons once, from its lower number
    sides = np.column_stack([np.minimum(i, j), np.maximum(i, j), sign * image])
    contacts, which = np.unique(sides, axis=0, return_inverse=True)
    force = np.zeros((len(contacts), 2))
    np.add.at(force, which.ravel(), sign * overlaps[:, 2:])
    return PolygonContacts(i=contacts[:, 0], j=contacts[:, 1], image=contacts[:, 2:], force=force)


def steiner_point(outline: NDArray[np.float64]) -> NDArray[np.float64]:
    """Steiner point of a polygon, 1/(2 pi) sum beta_k v_k, with beta_k the turn at the corner v_k.

    Args:
        outline: corners, counterclockwise, shape (m, 2) [length].
    """
    edge = np.roll(outline, -1, axis=0) - outline
    before = np.roll(edge, 1, axis=0)
    x, y = edge.T
    across = before[:, 0] * y - before[:, 1] * x
    turn = angles(np.column_stack([np.sum(before * edge, axis=1), across]))
    center: NDArray[np.float64] = np.sum(turn[:, None] * (outline - outline[0]), axis=0)
    return outline[0] + center / (2.0 * np.pi)


@dataclass(frozen=True, eq=False, repr=False)
class PolygonState(Stressed):
    """A snapshot, the same on every rank. Polygons are numbered from 0.

    Attributes:
        packing: centers, species, radii and box. The center of a bead polygon is the mean of its
            beads; that of a smooth one its Steiner point, which is the center in the ring laws.
        model: the settings.
        polygons: the undeformed polygons.
        outlines: beads of each polygon, unwrapped around its center, arrays (N_v, 2) [length].
        area: of the polygons through their vertices, shape (N,) [length^2].
        perimeter: of the polygons, shape (N,) [length].
        contact_table: pairs of polygons in contact, with their forces.
        energy: of all polygons [energy].
        stress: pressure tensor, compression positive, shape (2, 2) [energy/length^2].
        residual: largest force on a bead over the force on a bead in a contact, which is the mean
            of kA max(A0 - A, 0) L0 over the polygons; 0 if forces are only rounding.
        stalled: the relaxation stopped before the tolerance.
    """

    packing: Packing
    model: PolygonModel
    polygons: Polygons
    outlines: list[NDArray[np.float64]]
    area: NDArray[np.float64]
    perimeter: NDArray[np.float64]
    contact_table: PolygonContacts
    energy: float
    stress: NDArray[np.float64]
    residual: float
    stalled: bool

    def __repr__(self) -> str:
        return (
            f"<PolygonState: {len(self.packing)} polygons, phi = {self.phi:.4f}, "
            f"pressure = {self.pressure:.3g}, z = {self.coordination:.2f}>"
        )

    @property
    def phi(self) -> float:
        """Packing fraction, sum of `filled_area` over the area of the box, as that of a law."""
        return float(np.sum(self.filled_area) / np.prod(self.packing.box.diagonal()))

    @property
    def filled_area(self) -> NDArray[np.float64]:
        """Area of each polygon with the radius p of its vertices around it, shape (N,) [length^2].

        Beads of other polygons interlock with those of a bead polygon: it is filled up to its
        `effective_radius`, see `Polygons`.
        """
        skin = self.polygons.skin[self.packing.species]
        return filled_area(self.area, self.perimeter, skin)

    @property
    def area_deficit(self) -> NDArray[np.float64]:
        """S = A0 - A of each polygon, shape (N,) [length^2]."""
        return self.polygons.area[self.packing.species] - self.area

    @property
    def coordination(self) -> float:
        """Mean number of contacts of a polygon, rattlers included."""
        return 2.0 * len(self.contact_table.i) / len(self.packing)

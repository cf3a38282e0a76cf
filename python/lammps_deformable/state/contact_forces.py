"""Forces of all contacts of a state: the stress of each particle, and a graph of networkx."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.optional import optional
from ..core import unit_vectors
from ..model.lattice import lengths
from ..model.neighbors import forward
from ..model.packing import Packing
from .contact_table import ContactTable

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


# Columns of the table where contacts rub, which edges of the graph have too.
_OF_EDGES = ("friction", "sliding")


class ContactForces(NamedTuple):
    """All active contacts, each once.

    Attributes:
        i: a particle, shape (M,).
        j: the other one, not below i; -1 for a wall, shape (M,).
        vector: from the center of i to that of j, or to the point of the wall, shape (M, d)
            [length].
        part: of the vector that is within i: up to the contact line, 1 for a wall, shape (M,).
        force: on i, shape (M, d) [energy/length].
        rubbing: `friction` and `sliding` of each by name, see `rubbing.RUBBING`; of contacts that
            slip freely none.
    """

    i: Integers
    j: Integers
    vector: Floats
    part: Floats
    force: Floats
    rubbing: Mapping[str, NDArray[Any]] = {}

    @property
    def distance(self) -> Floats:
        """Of the centers, or of the center from the wall, shape (M,) [length]."""
        return lengths(self.vector)

    @property
    def push(self) -> Floats:
        """Force along the line of centers, positive where it pushes, (M,) [energy/length]."""
        return -np.sum(self.force * self.vector, axis=1) / self.distance


def forces_of_table(packing: Packing, table: ContactTable) -> ContactForces:
    """Those of a `State`."""
    image = table["image"]
    i, j = table["i"], table["j"]
    rows = table[(i < j) | (j < 0) | ((i == j) & forward(image))]
    i, j = rows["i"], rows["j"]
    within = (packing.radius[i] - rows["indentation"]) / np.cos(rows["tilt"])
    return ContactForces(
        i=i,
        j=j,
        vector=rows["distance"][:, None] * unit_vectors(rows["angle"] - rows["tilt"]),
        part=np.where(j < 0, 1.0, within / rows["distance"]),
        force=rows["force_vector"],
        rubbing={name: rows[name] for name in _OF_EDGES if name in (table.dtype.names or ())},
    )


def particle_stress(contacts: ContactForces, area: Floats) -> Floats:
    """See `Analysis.particle_stress`.

    Args:
        contacts: of the state.
        area: of each particle, or its volume, shape (N,) [length^d].
    """
    moment = -contacts.vector[:, :, None] * contacts.force[:, None, :]
    moment = 0.5 * (moment + np.swapaxes(moment, 1, 2))
    pair, part = contacts.j >= 0, contacts.part[:, None, None]
    total = np.zeros((len(area), *moment.shape[1:]))
    np.add.at(total, contacts.i, part * moment)
    np.add.at(total, contacts.j[pair], ((1.0 - part) * moment)[pair])
    return total / area[:, None, None]


def graph(packing: Packing, contacts: ContactForces, rattlers: NDArray[np.bool_]) -> Any:
    """See `Analysis.graph`."""
    networkx = optional("networkx", "networkx")
    found = networkx.MultiGraph()
    axes = "xyz"[: packing.dimension]
    names = (*axes, "radius", "species", "rattler")
    columns = (*packing.positions.T, packing.radius, packing.species, rattlers)
    for n, values in enumerate(zip(*(column.tolist() for column in columns), strict=True)):
        found.add_node(n, **dict(zip(names, values, strict=True)))
    steps = {f"d{axis}": step for axis, step in zip(axes, contacts.vector.T, strict=True)}
    of_edges = {"force": contacts.push, "distance": contacts.distance, **steps, **contacts.rubbing}
    ends = (contacts.i, contacts.j)
    for i, j, *edge in zip(*(row.tolist() for row in (*ends, *of_edges.values())), strict=True):
        found.add_edge(i, j, **dict(zip(of_edges, edge, strict=True)))
    return found

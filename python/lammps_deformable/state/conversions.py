"""A state as an object of another package: MDAnalysis, pandas, freud."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..common.box import in_space
from ..common.checks import shown
from ..common.errors import ParameterError
from ..common.versions import optional
from ..particles.containers import closed
from .recorded import particle_values

if TYPE_CHECKING:
    from MDAnalysis import Universe

    from ..particles.packing import Packing
    from .contacts import ContactForces
    from .state import State


def system(freud: Any, packing: Packing) -> tuple[Any, NDArray[np.float64]]:
    """See `State.to_freud`."""
    shut = closed(packing.walls, packing.dimension)
    sides = packing.box.diagonal() * np.where(shut, 2.0, 1.0)
    tilts = packing.box / packing.box.diagonal()[:, None]
    if packing.dimension == 2:
        box = freud.box.Box(*sides, xy=tilts[1, 0], is2D=True)
    else:
        box = freud.box.Box(*sides, tilts[1, 0], tilts[2, 0], tilts[2, 1])
    center = packing.origin + packing.box.sum(axis=0) / 2.0
    return box, box.wrap(in_space(packing.positions - center))


def neighbors(freud: Any, number: int, contacts: ContactForces) -> Any:
    """The contacts of so many particles as a NeighborList, from both sides."""
    pair = contacts.j >= 0
    i, j, vector, push = (
        each[pair] for each in (contacts.i, contacts.j, contacts.vector, contacts.push)
    )
    begin, end = np.append(i, j), np.append(j, i)
    order = np.lexsort((end, begin))
    both = in_space(np.concatenate([vector, -vector]))[order]
    weights = np.append(push, push)[order]
    return freud.locality.NeighborList.from_arrays(
        number, number, begin[order], end[order], both, weights
    )


# Columns of vectors in tables: those of the axes, or of the sides of the box.
_VECTORS = {"image": "image_{}", "position": "{}", "normal": "n{}", "force_vector": "f{}"}


def to_mdanalysis(state: State) -> Universe:
    """See `State.to_mdanalysis`."""
    universe = state.packing.to_mdanalysis()
    frame = universe.trajectory.ts
    frame.velocities = in_space(state.velocities)
    frame.data.update(particle_values(state))
    return universe


def to_pandas(state: State, table: str) -> Any:
    """See `State.to_pandas`."""
    if table not in ("particles", "contacts"):
        raise ParameterError(f"table must be particles or contacts, not {shown(table)}")
    pandas = optional("pandas", "pandas")
    axes = "xyz"[: state.packing.dimension]
    if table == "particles":
        places = dict(zip(axes, state.packing.positions.T, strict=True))
        index = pandas.RangeIndex(len(state.packing), name="particle")
        columns = places | {"species": state.packing.species} | values_of(state)
        return pandas.DataFrame(columns, index=index)
    columns, contacts = {}, state.contacts
    for name in contacts.dtype.names or ():
        column = contacts[name]
        each = _VECTORS.get(name, name + "_{}" * (column.ndim == 2))
        names = [each.format(word) for word in ("abc" if name == "image" else axes)]
        columns |= zip(names, np.atleast_2d(column.T), strict=False)
    return pandas.DataFrame(columns)


def values_of(state: State) -> dict[str, NDArray[Any]]:
    """Values of the particles by name: those of a trajectory, and what follows from them."""
    more = ("area_deficit", "shape_parameter") if state.packing.dimension == 2 else ()
    return particle_values(state) | {
        name: getattr(state, name) for name in more if hasattr(state, name)
    }

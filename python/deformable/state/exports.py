"""States for other programs: MDAnalysis, pandas, ParaView, OVITO."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.optional import optional
from ..common.validate import expect, shown
from ..formats.universes import in_space
from ..io.outlines import write_outlines
from ..model.packing import Packing
from .contact_table import ContactTable

if TYPE_CHECKING:
    from MDAnalysis import Universe


class _Snapshot(Protocol):
    """What a state has."""

    @property
    def packing(self) -> Packing: ...
    @property
    def velocities(self) -> NDArray[np.float64]: ...
    @property
    def contact_table(self) -> ContactTable: ...
    @property
    def root(self) -> bool: ...
    @property
    def outlines(self) -> list[NDArray[np.float64]]: ...
    @property
    def area_deficit(self) -> NDArray[np.float64]: ...
    @property
    def shape_parameter(self) -> NDArray[np.float64]: ...
    @property
    def phi(self) -> float: ...
    @property
    def pressure(self) -> float: ...
    def particle_values(self) -> dict[str, NDArray[Any]]: ...


class Exports:
    """What a state gives to other programs."""

    def to_mdanalysis(self: _Snapshot) -> Universe:
        """A Universe of MDAnalysis with one frame.

        Particles have `ids` and `types` (from 1, as in LAMMPS), `radii` and `masses`. The values of
        a trajectory (area, pressure, contacts, ...) are in `trajectory.ts.data`, by name.
        MDAnalysis has three dimensions: z is 0, and the box is as high as its longer side, so that
        searches for neighbors find none above. Positions are rounded to 32 bits there, and count
        from the lower left corner of the box, `Packing.origin`. Walls are left out.
        """
        universe = self.packing.to_mdanalysis()
        frame = universe.trajectory.ts
        frame.velocities = in_space(self.velocities)
        frame.data.update(self.particle_values())
        return universe

    def to_pandas(self: _Snapshot, table: str = "particles") -> Any:
        """A DataFrame of pandas.

        Args:
            table: `particles`, a row for each, with position, species and all its values; or
                `contacts`, the rows of `contact_table`. Particles are numbered from 0, and are the
                index of their table.

        Raises:
            ParameterError: there is no such table.
            ImportError: pandas is missing (`pip install 'lammps-deformable[pandas]'`).
        """
        if table not in ("particles", "contacts"):
            raise ParameterError(f"table must be particles or contacts, not {shown(table)}")
        pandas = optional("pandas", "pandas")
        if table == "particles":
            x, y = self.packing.positions.T
            index = pandas.RangeIndex(len(self.packing), name="particle")
            return pandas.DataFrame(
                {"x": x, "y": y, "species": self.packing.species} | _values(self), index=index
            )
        columns: dict[str, NDArray[Any]] = {}
        pairs = {"image": ("image_a", "image_b"), "position": "xy", "force_vector": ("fx", "fy")}
        for name in self.contact_table.dtype.names or ():
            column = self.contact_table[name]
            columns |= zip(pairs.get(name, [name]), np.atleast_2d(column.T), strict=True)
        return pandas.DataFrame(columns)

    def export(self: _Snapshot, path: str | Path) -> None:
        """Write the outlines as polygons, with the values of the particles.

        Args:
            path: `.vtp` for ParaView, OVITO and other programs that read VTK's files, with the
                values as cell data; `.geojson` for programs of plane geometry, with the values as
                properties. Particles have an `id` and a `type` from 1, as in LAMMPS. Outlines are
                whole: those of particles at the boundary reach beyond the box.

        Raises:
            ParameterError: the suffix is another.
        """
        expect("path", path, str, Path)
        packing = self.packing
        names = {"id": np.arange(1, len(packing) + 1), "type": packing.species + 1}
        numbers = {"box": packing.box, "phi": self.phi, "pressure": self.pressure}
        if self.root:
            write_outlines(path, self.outlines, names | _values(self), numbers)


def _values(state: _Snapshot) -> dict[str, NDArray[Any]]:
    """Values of the particles by name: those of a trajectory, and what follows from them."""
    return state.particle_values() | {
        "area_deficit": state.area_deficit,
        "shape_parameter": state.shape_parameter,
    }

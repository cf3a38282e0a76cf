"""States for other programs: MDAnalysis, pandas, ParaView, OVITO."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.files import refuse_present
from ..common.optional import optional
from ..common.validate import expect, shown
from ..formats.universes import in_space
from ..io.outlines import write_shapes
from ..io.vtk_files import Shapes
from ..model.packing import Packing
from .contact_forces import ContactForces

if TYPE_CHECKING:
    from MDAnalysis import Universe

# Columns of vectors in tables: those of the axes, or of the sides of the box.
_VECTORS = {"image": "image_{}", "position": "{}", "normal": "n{}", "force_vector": "f{}"}


class Exports(ABC):
    """What a state gives to other programs."""

    packing: Packing
    velocities: NDArray[np.float64]
    contact_table: NDArray[np.void]
    root: bool
    time: float

    @property
    @abstractmethod
    def phi(self) -> float:
        """Packing fraction."""

    @property
    @abstractmethod
    def pressure(self) -> float:
        """Pressure of the packing."""

    @abstractmethod
    def particle_values(self) -> dict[str, NDArray[Any]]:
        """Values of the particles by name."""

    @property
    @abstractmethod
    def _contact_forces(self) -> ContactForces:
        """All contacts, each once."""

    @abstractmethod
    def _bodies(self) -> tuple[Shapes, NDArray[np.int64], dict[str, NDArray[Any]]]:
        """Shapes of the particles, the particle of each, and further values of the shapes."""

    def _values(self) -> dict[str, NDArray[Any]]:
        """Values of the particles by name: those of a trajectory, and what follows from them."""
        return self.particle_values()

    def to_mdanalysis(self) -> Universe:
        """A Universe of MDAnalysis with one frame.

        Particles have `ids` and `types` (from 1, as in LAMMPS), `radii` and `masses`. The values of
        a trajectory (area, pressure, contacts, ...) are in `trajectory.ts.data`, by name.
        MDAnalysis has three dimensions: of a plane z is 0, and the box is as high as its longer
        side, so that searches for neighbors find none above. Positions are rounded to 32 bits
        there, and count from the lower left corner of the box, `Packing.origin`. Walls are left
        out.
        """
        universe = self.packing.to_mdanalysis()
        frame = universe.trajectory.ts
        frame.velocities = in_space(self.velocities)
        frame.data.update(self.particle_values())
        return universe

    def to_pandas(self, table: str = "particles") -> Any:
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
        axes = "xyz"[: self.packing.dimension]
        if table == "particles":
            places = dict(zip(axes, self.packing.positions.T, strict=True))
            index = pandas.RangeIndex(len(self.packing), name="particle")
            columns = places | {"species": self.packing.species} | self._values()
            return pandas.DataFrame(columns, index=index)
        columns = {}
        for name in self.contact_table.dtype.names or ():
            column, each = self.contact_table[name], _VECTORS.get(name, name)
            names = [each.format(word) for word in ("abc" if name == "image" else axes)]
            columns |= zip(names, np.atleast_2d(column.T), strict=False)
        return pandas.DataFrame(columns)

    def export(self, path: str | Path, forces: bool = False, overwrite: bool = False) -> None:
        """Write the shapes of the particles, with their values, or the network of forces.

            state.export("outlines.vtp")
            state.export("network.vtp", forces=True)

        Particles have an `id` and a `type` from 1, as in LAMMPS. In the plane shapes are the
        outlines, a polygon each. In three dimensions they are the spheres of `plot` that facets
        cut: a facet is a polygon with the `force` of the contact and the `neighbor`, which are 0 of
        the triangles between facets; a neighbor of -1 is a wall. Shapes are whole: those of
        particles at the boundary reach beyond the box.

        Args:
            path: `.vtp` for ParaView, OVITO and other programs that read VTK's files, with the
                values as cell data; in the plane also `.geojson` for programs of plane geometry,
                with the values as properties.
            forces: write lines between centers in the place of shapes: the contacts, with their
                `force` along the line, positive where it pushes, the `distance`, and the ids `i`
                and `j`, of which -1 is a wall.
            overwrite: replace a file that is there.

        Raises:
            ParameterError: the suffix is another.
            FileError: there is a file and `overwrite` is not given, or it cannot be written.
        """
        expect("path", path, str, Path)
        expect("forces", forces, bool)
        if not self.root:
            return
        refuse_present(Path(path), overwrite)
        packing = self.packing
        numbers = {"box": packing.box, "phi": self.phi, "pressure": self.pressure}
        if forces:
            shapes, values = _network(packing, self._contact_forces)
        else:
            names = {"id": np.arange(1, len(packing) + 1), "type": packing.species + 1}
            shapes, particle, further = self._bodies()
            every = names | self._values()
            values = {name: each[particle] for name, each in every.items()} | further
        write_shapes(path, shapes, values, numbers)


def _network(packing: Packing, contacts: ContactForces) -> tuple[Shapes, dict[str, NDArray[Any]]]:
    """Contacts as lines, and their values."""
    begin = packing.positions[contacts.i]
    points = np.stack([begin, begin + contacts.vector], axis=1).reshape(-1, packing.dimension)
    both = np.arange(len(points))
    ids = {name: np.where(n < 0, -1, n + 1) for name, n in zip("ij", contacts[:2], strict=True)}
    values = {**ids, "force": contacts.push, "distance": contacts.distance, **contacts.rubbing}
    return Shapes(points, both, both[1::2] + 1, lines=True), values

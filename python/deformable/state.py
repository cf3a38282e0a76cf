"""One state of a simulation: a snapshot that stays as it is while the simulation goes on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .backbone import Backbone
from .contact_table import ContactTable
from .models import Model
from .packing import Packing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False)
class State(Backbone):
    """A snapshot, the same on every rank. Particles are numbered from 0.

    Attributes:
        packing: centres, species, undeformed radii and box.
        model: contact law with its stiffness.
        area: of each particle, within its skin if it has one, shape (N,) [length^2].
        perimeter: of each particle, likewise, shape (N,) [length].
        contacts: number of contacts that bear force on each particle, shape (N,).
        particle_pressure: inside each particle, shape (N,) [energy/length^2].
        arc_radius: smallest radius of curvature of the free outline, shape (N,) [length].
        energy: of all particles [energy].
        stress: pressure tensor of the contacts, compression positive, shape (2, 2)
            [energy/length^2]; motion adds N T / box area to its diagonal.
        residual: largest force on a particle over the mean contact force; 0 without contacts.
        stalled: the relaxation stopped before its tolerance.
        beyond: number of particles that the model does not describe (negative radius of curvature).
        velocities: of the centres, zero after a relaxation, shape (N, 2) [length/time].
        contact_table: contacts with a length or a force, as either side sees them, sorted by
            (i, j, image): structured array with the fields i, j (-1 for a wall), image (2,), angle,
            distance, indentation, length, force, position (2,), see `contact_table.COLUMNS`.
        root: this process writes the files (rank 0 of the run).
        time: since `move` began, 0 without motion [time].
    """

    packing: Packing
    model: Model
    area: NDArray[np.float64]
    perimeter: NDArray[np.float64]
    contacts: NDArray[np.int64]
    particle_pressure: NDArray[np.float64]
    arc_radius: NDArray[np.float64]
    energy: float
    stress: NDArray[np.float64]
    residual: float
    stalled: bool
    beyond: int
    velocities: NDArray[np.float64]
    contact_table: ContactTable
    root: bool
    time: float = 0.0

    def __post_init__(self) -> None:
        for array in (value for value in vars(self).values() if isinstance(value, np.ndarray)):
            array.setflags(write=False)

    @property
    def phi(self) -> float:
        """Packing fraction, sum of the deformed areas, skins included, over the area of the box."""
        skin = self._skin
        filled = self.area + skin * self.perimeter + np.pi * skin**2
        return float(np.sum(filled) / np.prod(self.packing.box.diagonal()))

    @property
    def pressure(self) -> float:
        """Pressure of the packing, half the trace of `stress` [energy/length^2]."""
        return float(np.trace(self.stress) / 2.0)

    @property
    def area_deficit(self) -> NDArray[np.float64]:
        """S = A0 - A of each particle, shape (N,) [length^2]."""
        return np.pi * (self.packing.radius - self._skin) ** 2 - self.area

    @property
    def shape_parameter(self) -> NDArray[np.float64]:
        """P^2 / (4 pi A) of each particle, 1 for a circle, shape (N,)."""
        return self.perimeter**2 / (4.0 * np.pi * self.area)

    @property
    def kinetic_energy(self) -> float:
        """Sum of v^2/2, as masses are 1 [energy]."""
        return float(np.sum(self.velocities**2) / 2.0)

    @property
    def temperature(self) -> float:
        """Temperature of the motion, masses and k_B being 1 [energy].

        sum (v - mean v)^2 / (2 N - 2), as many degrees of freedom as the common motion leaves.
        """
        apart = self.velocities - self.velocities.mean(axis=0)
        return float(np.sum(apart**2) / (2.0 * max(len(apart) - 1, 1)))

    @property
    def _skin(self) -> NDArray[np.float64]:
        """Thickness of the rigid skin of each particle, shape (N,) [length]."""
        return self.model.skins(len(self.packing.radii))[self.packing.species]

    @property
    def _ends(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        return self.contact_table["i"], self.contact_table["j"]

    @cached_property
    def outlines(self) -> list[NDArray[np.float64]]:
        """Exact outline of each particle, closed polygons of shape (m, 2) [length]."""
        return [
            centre + outline
            for centre, outline in zip(self.packing.positions, self.parallels(), strict=True)
        ]

    def parallels(
        self, inset: NDArray[np.float64] | None = None, points: int = 180
    ) -> list[NDArray[np.float64]]:
        """Lines within the outlines, each about its particle's centre, arrays (m, 2) [length].

        Args:
            inset: distance from each outline, shape (N,) [length]; none gives the outlines.
            points: how finely a whole turn is divided.
        """
        inset = np.zeros(len(self.packing)) if inset is None else inset
        return [
            self.model.outline(kind, radius, seen["angle"], seen["indentation"], within, points)
            for kind, radius, within, seen in zip(
                self.packing.species, self.packing.radius, inset, self.contacts_seen, strict=True
            )
        ]

    @cached_property
    def contacts_seen(self) -> list[ContactTable]:
        """The rows of `contact_table` of each particle."""
        first = np.searchsorted(self.contact_table["i"], np.arange(1, len(self.packing)))
        return np.split(self.contact_table, first)

    def plot(
        self,
        ax: Axes | None = None,
        color_by: str = "particle_pressure",
        contacts: bool = False,
        forces: bool = False,
    ) -> Axes:
        """Draw the outlines, coloured by a value of each particle; returns the axes.

        Args:
            ax: axes to draw into; a new figure without.
            color_by: name of an attribute with one number a particle, e.g. `area_deficit`.
            contacts: draw the contacts, the straight parts of either outline, on top.
            forces: draw the force chains on top, lines from centre to centre as wide as the force
                on them is large.

        Raises:
            ParameterError: `color_by` is no such attribute.
            ImportError: matplotlib is missing (`pip install lammps-deformable[plot]`).
        """
        from .plots import draw

        return draw(self, ax, color_by, contacts, forces)

    def save(self, folder: str | Path, parameters: Mapping[str, Any] | None = None) -> None:
        """Write the state for `deformable.load`, and for LAMMPS with the script `in.lammps`.

        Args:
            folder: made if missing; an older state there is replaced.
            parameters: anything JSON that belongs into the summary, e.g. seed and protocol.
        """
        from .files import save

        save(self, folder, parameters)
